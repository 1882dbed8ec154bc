// SPDX-License-Identifier: GPL-3.0-or-later
// Its declaration throws.

#include "scanmill/base/error.hpp"
#include "scanmill/plugin/plugin.hpp"

SCANMILL_FILTER() { throw scanmill::Error("the table of {} magic numbers is missing", 7); }
