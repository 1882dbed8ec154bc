// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/common/text_output.hpp"
#include "scanmill/formats/common/writing.hpp"
#include "scanmill/formats/off/off.hpp"
#include "scanmill/io/output_buffer.hpp"

namespace scanmill {

namespace {

void put_vertices(const TriangleMesh& mesh, const TextColumns& columns, OutputBuffer& out) {
    for (std::size_t row = 0; row < mesh.positions.size(); ++row) {
        const Vec3 p = world(mesh.frame, mesh.positions[row]);
        for (int axis = 0; axis < 3; ++axis) {
            if (axis > 0) out.text(" ");
            out.number(p[axis]);
        }
        for (const Column* column : {columns.normal, columns.colour, columns.texture})
            if (column) put_row(*column, row, out);
        out.text("\n");
    }
}

void put_faces(const TriangleMesh& mesh, const Column* colour, OutputBuffer& out) {
    for (std::size_t row = 0; row < mesh.triangles.size(); ++row) {
        out.text("3");
        for (u32 vertex : mesh.triangles[row]) {
            out.text(" ");
            out.number(vertex);
        }
        if (colour) put_row(*colour, row, out);
        out.text("\n");
    }
}

}  // namespace

void write_off(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const TriangleMesh& mesh = *value.get<TriangleMesh>();
    const TextColumns of_vertices(mesh.vertex_columns);
    const Column* const face_colour = TextColumns(mesh.face_columns).colour;
    warn_lost_precision(mesh.frame, mesh.positions.span(), false, "OFF", options);
    std::vector<std::string_view> of_faces;
    if (face_colour) of_faces.push_back(face_colour->name());
    warn_bare_triangles(mesh, "OFF", options, of_vertices.names(), of_faces);

    if (of_vertices.texture) out.text("ST");
    if (of_vertices.colour) out.text("C");
    if (of_vertices.normal) out.text("N");
    out.text("OFF\n");
    out.text(comment_lines(mesh.frame));
    out.number(mesh.positions.size());
    out.text(" ");
    out.number(mesh.triangles.size());
    out.text(" 0\n");
    put_vertices(mesh, of_vertices, out);
    put_faces(mesh, face_colour, out);
}

}  // namespace scanmill
