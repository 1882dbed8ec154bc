// SPDX-License-Identifier: GPL-3.0-or-later
// Its declaration throws what is no std::exception.

#include "scanmill/plugin/plugin.hpp"

SCANMILL_FILTER() { throw 7; }
