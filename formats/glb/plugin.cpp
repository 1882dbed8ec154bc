// SPDX-License-Identifier: GPL-3.0-or-later
#include "glb/glb.hpp"
#include "scanmill/plugin/format_modules.hpp"

SCANMILL_FORMAT() {
    using namespace scanmill;
    return {{"GLB", {"glb"}, {"glTF"}, {kind_of<PointCloud>(), kind_of<TriangleMesh>()}, false},
            {},
            {{kind_of<PointCloud>(), glb::write_glb_points}, {kind_of<TriangleMesh>(), glb::write_glb_mesh}}};
}
