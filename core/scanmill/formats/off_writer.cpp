// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/off.hpp"
#include "scanmill/formats/output_buffer.hpp"
#include "scanmill/formats/writing.hpp"

namespace scanmill {

void write_off(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const TriangleMesh& mesh = *std::get<std::shared_ptr<const TriangleMesh>>(value);
    tell_lost_precision(mesh.frame, mesh.positions.span(), false, "OFF", options);
    tell_bare_triangles(mesh, "OFF", options);

    out.text("OFF\n");
    out.text(comment_lines(mesh.frame));
    out.number(mesh.positions.size());
    out.text(" ");
    out.number(mesh.triangles.size());
    out.text(" 0\n");
    for (const Vec3& position : mesh.positions) {
        const Vec3 p = world(mesh.frame, position);
        for (int axis = 0; axis < 3; ++axis) {
            out.number(p[axis]);
            out.text(axis < 2 ? " " : "\n");
        }
    }
    for (const Triangle& triangle : mesh.triangles) {
        out.text("3");
        for (u32 vertex : triangle) {
            out.text(" ");
            out.number(vertex);
        }
        out.text("\n");
    }
}

}  // namespace scanmill
