// SPDX-License-Identifier: GPL-3.0-or-later
#include "pcd/pcd.hpp"
#include "scanmill/plugin/format_modules.hpp"

SCANMILL_FORMAT() {
    using namespace scanmill;
    return {{"PCD", {"pcd"}, {"# .PCD v", "VERSION 0.", "VERSION ."}, {kind_of<PointCloud>()}},
            pcd::read_pcd,
            {{kind_of<PointCloud>(), pcd::write_pcd}}};
}
