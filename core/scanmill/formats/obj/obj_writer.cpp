// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "scanmill/formats/common/colours.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/text_output.hpp"
#include "scanmill/formats/common/writing.hpp"
#include "scanmill/formats/obj/obj.hpp"
#include "scanmill/io/output_buffer.hpp"

namespace scanmill {

namespace {

/// A fourth channel would keep many programs from reading the vertex at all.
void warn_lost_opacity(const Column& colour, const WriteOptions& options) {
    if (colour.components() != 4) return;
    const auto channels = colour.values<u8>();
    std::size_t see_through = 0;
    for (std::size_t row = 0; row < colour.rows(); ++row) see_through += channels[4 * row + 3] != 255;
    if (see_through > 0)
        warn(options.on_warning, "OBJ left out the opacity (the fourth channel of 'colour') of {}; PLY keeps it",
             count_text(see_through, "vertex", "vertices"));
}

/// Colours that are no bytes, as they were read: red, green and blue; empty when they are not all there.
std::vector<const Column*> plain_colours(const ColumnTable& columns) {
    std::vector<const Column*> channels;
    for (const char* name : {"red", "green", "blue"}) {
        const Column* column = columns.find(name);
        if (!column || !is_plain_number(*column)) return {};
        channels.push_back(column);
    }
    return channels;
}

void put_vertices(const TriangleMesh& mesh, const Column* colour, std::span<const Column* const> channels,
                  OutputBuffer& out) {
    const auto fractions = colour_fractions();
    for (std::size_t row = 0; row < mesh.positions.size(); ++row) {
        const Vec3 p = world(mesh.frame, mesh.positions[row]);
        out.text("v");
        for (int axis = 0; axis < 3; ++axis) {
            out.text(" ");
            out.number(p[axis]);
        }
        for (std::size_t channel = 0; channel < 3 && colour; ++channel) {
            out.text(" ");
            out.text(fractions[colour->values<u8>()[row * colour->components() + channel]]);
        }
        for (const Column* channel : channels) put_row(*channel, row, out);
        out.text("\n");
    }
}

void put_list(std::string_view keyword, const Column* column, OutputBuffer& out) {
    for (std::size_t row = 0; column && row < column->rows(); ++row) {
        out.text(keyword);
        put_row(*column, row, out);
        out.text("\n");
    }
}

}  // namespace

void write_obj(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const TriangleMesh& mesh = *value.get<TriangleMesh>();
    const TextColumns columns(mesh.vertex_columns);
    warn_lost_precision(mesh.frame, mesh.positions.span(), false, "OBJ", options);
    std::vector<std::string_view> kept = columns.names();
    const std::vector<const Column*> channels =
        columns.colour ? std::vector<const Column*>() : plain_colours(mesh.vertex_columns);
    for (const Column* channel : channels) kept.push_back(channel->name());
    warn_bare_triangles(mesh, "OBJ", options, kept);
    if (columns.colour) warn_lost_opacity(*columns.colour, options);

    out.text(comment_lines(mesh.frame));
    put_vertices(mesh, columns.colour, channels, out);
    put_list("vt", columns.texture, out);
    put_list("vn", columns.normal, out);
    for (const Triangle& triangle : mesh.triangles) {
        out.text("f");
        for (u32 vertex : triangle) {
            const u64 number = u64(vertex) + 1;
            out.text(" ");
            out.number(number);
            if (columns.texture || columns.normal) out.text("/");
            if (columns.texture) out.number(number);
            if (columns.normal) {
                out.text("/");
                out.number(number);
            }
        }
        out.text("\n");
    }
}

}  // namespace scanmill
