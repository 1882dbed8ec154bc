// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/surface_box.hpp"

namespace scanmill {

BoundingBox surface_box(const TriangleMesh& mesh) {
    BoundingBox box;
    for (const Triangle& triangle : mesh.triangles)
        for (const u32 vertex : triangle) {
            const Vec3& position = mesh.positions[vertex];
            if (!position.allFinite()) continue;
            box.low = box.low.cwiseMin(position);
            box.high = box.high.cwiseMax(position);
        }
    return box;
}

}  // namespace scanmill
