// SPDX-License-Identifier: GPL-3.0-or-later
// A declaration without .run(…).

#include "scanmill/plugin/plugin.hpp"

struct Nothing {};

SCANMILL_FILTER() { return scanmill::Declare<Nothing>("nothing-to-run", 1); }
