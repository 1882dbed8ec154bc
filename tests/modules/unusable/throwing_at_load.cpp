// SPDX-License-Identifier: GPL-3.0-or-later
// A static object throws while the loader is still at work, where no handler can catch it.

#include <stdexcept>

#include "scanmill/plugin/plugin.hpp"

namespace {

struct Licence {
    Licence() { throw std::runtime_error("the licence has run out"); }
};
const Licence licence;

}  // namespace

SCANMILL_FILTER() { return {}; }
