// SPDX-License-Identifier: GPL-3.0-or-later
// A module for this version and this compiler, compiled with other headers: its declaration must never be called.

#undef SCANMILL_HEADERS
#define SCANMILL_HEADERS "0123456789abcdef"

#include <cstdlib>

#include "scanmill/plugin/plugin.hpp"

SCANMILL_FILTER() { std::abort(); }
