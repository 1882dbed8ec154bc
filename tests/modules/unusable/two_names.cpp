// SPDX-License-Identifier: GPL-3.0-or-later
// Descriptor and declaration have different names.

#include "scanmill/plugin/plugin.hpp"

struct Nothing {};

SCANMILL_FILTER() {
    return scanmill::Declare<Nothing>("another-name", 1)
        .run([](const scanmill::Inputs&, const Nothing&, scanmill::Context&) { return scanmill::Outputs(); });
}
