// SPDX-License-Identifier: GPL-3.0-or-later
#include "glb/glb.hpp"
#include "scanmill/plugin/format_modules.hpp"

SCANMILL_FORMAT() {
    using namespace scanmill;
    return {{"GLB", {"glb"}, {"glTF"}, {Kind::points, Kind::mesh}, false},
            {},
            {{Kind::points, glb::write_glb_points}, {Kind::mesh, glb::write_glb_mesh}}};
}
