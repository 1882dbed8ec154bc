// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/common/writing.hpp"

#include <algorithm>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/formats/common/reading.hpp"

namespace scanmill {

namespace {

/// What is lost when origin + position is rounded to double: exact (Knuth's two-sum).
double rounding_error(double origin, double position) {
    const double sum = origin + position;
    const double part = sum - origin;
    return (origin - (sum - part)) + (position - part);
}

}  // namespace

bool all_floats(const Frame& frame, std::span<const Vec3> positions) {
    for (const Vec3& position : positions) {
        const Vec3 p = world(frame, position);
        for (int axis = 0; axis < 3; ++axis)
            if (static_cast<double>(static_cast<float>(p[axis])) != p[axis] && !std::isnan(p[axis])) return false;
    }
    return true;
}

void warn_lost_precision(const Frame& frame, std::span<const Vec3> positions, bool as_float, std::string_view format,
                         const WriteOptions& options) {
    constexpr double bearable = 1e-6;
    double worst = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
        if (!positions[i].allFinite()) continue;
        const Vec3 p = world(frame, positions[i]);
        for (int axis = 0; axis < 3; ++axis) {
            const double written = as_float ? static_cast<double>(static_cast<float>(p[axis])) : p[axis];
            if (!std::isfinite(written))
                throw Error("point {} has the coordinate {}, beyond what {} can write", i, number_text(p[axis]), format)
                    .hint("write PLY, or change the unit");
            const double lost = std::abs((written - p[axis]) - rounding_error(frame.origin[axis], positions[i][axis]));
            worst = std::max(worst, lost);
        }
    }
    const double diagonal = bounding_box(positions).diagonal();
    if (worst <= bearable * diagonal) return;
    warn(options.on_warning, "coordinates moved by up to {:.2g}, {:.2g} of the diagonal: {} has {} precision; {}",
         worst, worst / diagonal, format, as_float ? "single" : "double",
         as_float ? "PLY keeps them" : "write it in a frame nearer to the scan");
}

void warn_left_out(const ColumnTable& columns, std::string_view element, std::string_view format,
                   const WriteOptions& options, std::span<const std::string_view> kept) {
    std::string names;
    std::size_t count = 0;
    for (const Column& column : columns) {
        if (std::ranges::find(kept, column.name()) != kept.end()) continue;
        names.append(count++ == 0 ? "" : ", ").append(column.name());
    }
    if (count > 0)
        warn(options.on_warning, "{} left out {} of the {} ({}); PLY keeps them", format,
             count_text(count, "column", "columns"), element, names);
}

TriangleMesh with_used_vertices(const TriangleMesh& mesh, std::string_view format, const WriteOptions& options) {
    std::vector<bool> is_used(mesh.positions.size(), false);
    for (const Triangle& triangle : mesh.triangles)
        for (const u32 vertex : triangle) is_used[vertex] = true;
    const auto unused = static_cast<std::size_t>(std::ranges::count(is_used, false));
    if (unused == 0) return mesh;  // shares its arrays
    warn(options.on_warning, "{} left out {} that no triangle uses; PLY keeps them", format,
         count_text(unused, "vertex", "vertices"));
    return without_unused_vertices(mesh);
}

void warn_bare_triangles(const TriangleMesh& mesh, std::string_view format, const WriteOptions& options,
                         std::span<const std::string_view> kept_of_vertices,
                         std::span<const std::string_view> kept_of_faces) {
    warn_left_out(mesh.vertex_columns, "vertices", format, options, kept_of_vertices);
    warn_left_out(mesh.face_columns, "faces", format, options, kept_of_faces);
    warn_left_out(mesh.edge_columns, "edges", format, options);
    if (!mesh.sharp_edges.empty())
        warn(options.on_warning, "{} left out that {} are sharp; PLY keeps it", format,
             count_text(mesh.sharp_edges.size(), "edge", "edges"));
}

std::string one_line(std::string_view name) {
    std::string line(name);
    for (char& c : line)
        if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = ' ';
    const std::size_t begin = line.find_first_not_of(' ');
    return begin == std::string::npos ? "" : line.substr(begin, line.find_last_not_of(' ') + 1 - begin);
}

std::string exponent_comment(const Column& column) {
    if (column.length_exponent() == 0) return {};
    return fmt::format("length-exponent {} {}", column.length_exponent(), column.name());
}

std::string comment_lines(const Frame& frame) {
    std::string lines;
    if (frame.unit != LengthUnit::unknown) lines.append("# unit ").append(symbol(frame.unit)).append("\n");
    if (const std::string name = one_line(frame.name); !name.empty())
        lines.append("# frame ").append(name).append("\n");
    return lines;
}

}  // namespace scanmill
