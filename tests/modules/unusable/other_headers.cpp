// SPDX-License-Identifier: GPL-3.0-or-later
// Of this version and this compiler, but compiled when the headers were others: its declaration must never be called.

#undef SCANMILL_HEADERS
#define SCANMILL_HEADERS "0123456789abcdef"

#include <cstdlib>

#include "scanmill/plugin/plugin.hpp"

SCANMILL_FILTER() { std::abort(); }
