// SPDX-License-Identifier: GPL-3.0-or-later
// Its declaration throws a type that is not a std::exception.

#include "scanmill/plugin/plugin.hpp"

SCANMILL_FILTER() { throw 7; }
