/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A symbol of the right name that is something else. Nothing behind its magic may be read. */
__attribute__((visibility("default"))) const char scanmill_plugin[16] = "another-product";
