// SPDX-License-Identifier: GPL-3.0-or-later
// A static object ends the program while the loader is still at work.

#include <cstdlib>

#include "scanmill/plugin/plugin.hpp"

namespace {

struct Quitter {
    Quitter() { std::exit(3); }
};
const Quitter quitter;

}  // namespace

SCANMILL_FILTER() { return {}; }
