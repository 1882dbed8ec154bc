// SPDX-License-Identifier: GPL-3.0-or-later
#include "pcd/pcd.hpp"
#include "scanmill/plugin/format_modules.hpp"

SCANMILL_FORMAT() {
    using namespace scanmill;
    return {{"PCD", {"pcd"}, {"# .PCD v", "VERSION 0.", "VERSION ."}, {Kind::points}},
            pcd::read_pcd,
            {{Kind::points, pcd::write_pcd}}};
}
