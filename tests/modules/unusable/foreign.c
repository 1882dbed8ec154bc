/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Right magic, right name, built for another program: its declaration must never be called. */
#include <stdlib.h>

struct descriptor {
    char magic[16];
    const char* abi;
    const char* name;
    void (*declare)(void* declaration);
};

static void declare(void* declaration) {
    (void)declaration;
    abort();
}

__attribute__((visibility("default")))
const struct descriptor scanmill_plugin = {"scanmill-filter", "scanmill 0.0.1, another compiler", "foreign", declare};
