// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/common/rounding.hpp"

#include <cmath>

#include "scanmill/data/topology.hpp"
#include "scanmill/formats/common/position_merger.hpp"
#include "scanmill/formats/common/writing.hpp"

namespace scanmill {

namespace {

/// A shift to the middle of the box along the axes with distant coordinates. Its components are multiples of the
/// largest power of ten that is at most `diagonals` diagonals. Zero for a box outside the supported range.
Vec3 round_shift(const BoundingBox& world, double diagonals) {
    Vec3 shift = Vec3::Zero();
    const double diagonal = world.diagonal();
    if (!(diagonal >= least_side && diagonal <= 2 * largest_side)) return shift;
    // The step is a power of ten. Below 1 it is stored as its reciprocal `parts`, so that all numbers are exact and the
    // results below are correctly rounded.
    double step = 1, parts = 1;
    while (10 * step <= diagonals * diagonal) step *= 10;
    while (1 / parts > diagonals * diagonal) parts *= 10;
    for (int axis = 0; axis < 3; ++axis) {
        const double middle = 0.5 * world.low[axis] + 0.5 * world.high[axis];
        if (!(std::abs(middle) > distant_diagonals * diagonal)) continue;
        shift[axis] = parts > 1 ? std::round(middle * parts) / parts : std::round(middle / step) * step;
    }
    return shift;
}

bool floats_hold(const TriangleMesh& mesh) {
    if (all_floats(mesh.frame, mesh.positions.span())) return true;
    constexpr double bearable = 0.01;
    const auto written = [&](std::size_t vertex) -> Vec3 {
        return rounded_to_float(world(mesh.frame, mesh.positions[vertex]));
    };
    Array<double> moved(mesh.positions.size());
    for (std::size_t vertex = 0; vertex < moved.size(); ++vertex)
        moved[vertex] = (written(vertex) - mesh.frame.origin - mesh.positions[vertex]).norm();
    for (const Triangle& triangle : mesh.triangles)
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const u32 a = triangle[corner], b = triangle[(corner + 1) % 3];
            const double length = (mesh.positions[b] - mesh.positions[a]).norm();
            if (length > 0 && moved[a] + moved[b] > bearable * length) return false;
        }
    return joined_vertices(mesh, written).rounded == 0;
}

bool collapses(const TriangleMesh& mesh, const JoinedVertices& joined, const Triangle& triangle) {
    const auto join = [&](u32 a, u32 b) {
        return joined.numbers[a] == joined.numbers[b] && mesh.positions[a] != mesh.positions[b];
    };
    const auto& [a, b, c] = triangle;
    return join(a, b) || join(b, c) || join(c, a);
}

/// Warns if the mesh is closed, but `triangles` with joined vertices are not.
void warn_opened(const TriangleMesh& mesh, const Buffer<Triangle>& triangles, const JoinedVertices& joined,
                 std::string_view format, const WriteOptions& options) {
    if (!topology(mesh).closed) return;
    TriangleMesh in_file;
    in_file.positions = Array<Vec3>(joined.positions);
    Array<Triangle> numbered(triangles.begin(), triangles.end());
    for (Triangle& triangle : numbered)
        for (u32& vertex : triangle) vertex = joined.numbers[vertex];
    in_file.triangles = std::move(numbered);
    const MeshTopology found = topology(in_file);
    if (found.closed) return;
    std::string sentence = fmt::format(
        "the mesh is closed, but the {0} file is not: {0} joins {1} at equal positions, and the file then has {2}; PLY "
        "keeps the mesh closed",
        format, count_text(joined.rounded + joined.equal, "vertex", "vertices"),
        found.triangles == 0 ? std::string("no triangles") : defects_text(found));
    options.on_opened ? options.on_opened(std::move(sentence)) : warn(options.on_warning, "{}", sentence);
}

}  // namespace

double rounded_to_float(double number) {
    const volatile float rounded = static_cast<float>(number);
    return rounded;
}

Vec3 shift_for_floats(const TriangleMesh& mesh) {
    BoundingBox box = bounding_box(mesh.positions.span());
    box.low += mesh.frame.origin;
    box.high += mesh.frame.origin;
    const Vec3 shift = round_shift(box, 1);
    if (shift == Vec3::Zero() || floats_hold(mesh)) return Vec3::Zero();
    for (const double diagonals : {1000, 100, 10}) {
        TriangleMesh shifted = mesh;  // shares the arrays
        const Vec3 rounder = round_shift(box, diagonals);
        shifted.frame.origin -= rounder;
        if (floats_hold(shifted)) return rounder;
    }
    return shift;
}

std::string shift_text(const Vec3& shift) { return fmt::format("{} {} {}", shift.x(), shift.y(), shift.z()); }

JoinedVertices joined_vertices(const TriangleMesh& mesh, const std::function<Vec3(std::size_t)>& written) {
    const std::size_t vertices = mesh.positions.size();
    PositionMerger merger(vertices);
    JoinedVertices joined;
    joined.numbers.resize(vertices);
    Array<u32> firsts;  // the first vertex with each number
    for (std::size_t vertex = 0; vertex < vertices; ++vertex) {
        const u32 number = merger.add(written(vertex));
        joined.numbers[vertex] = number;
        if (number == firsts.size())
            firsts.push_back(static_cast<u32>(vertex));
        else
            ++(mesh.positions[vertex] == mesh.positions[firsts[number]] ? joined.equal : joined.rounded);
    }
    joined.positions = std::move(merger.positions);
    return joined;
}

u64 collapsed_triangles(const TriangleMesh& mesh, const JoinedVertices& joined) {
    if (joined.rounded == 0) return 0;
    return static_cast<u64>(std::ranges::count_if(
        mesh.triangles, [&](const Triangle& triangle) { return collapses(mesh, joined, triangle); }));
}

Buffer<Triangle> triangles_of_positions(const TriangleMesh& mesh, const JoinedVertices& joined, std::string_view format,
                                        const WriteOptions& options) {
    const auto has_equal_corners = [&](const Triangle& triangle) {
        const auto& [a, b, c] = triangle;
        const auto& numbers = joined.numbers;
        return numbers[a] == numbers[b] || numbers[b] == numbers[c] || numbers[c] == numbers[a];
    };
    if (std::ranges::all_of(mesh.triangles, has_equal_corners))
        throw Error("nothing is left of the mesh: in {}'s single precision {} equal corners", format,
                    mesh.triangles.size() == 1 ? "its only triangle has"
                                               : fmt::format("all of its {} triangles have", mesh.triangles.size()))
            .hint("write PLY, which keeps double precision");
    if (joined.rounded + joined.equal == 0) return mesh.triangles;
    const u64 collapsed = collapsed_triangles(mesh, joined);
    if (joined.rounded > 0)
        warn(options.on_warning,
             "{} became equal to others in {}'s single precision, and {} collapsed and {} left out; PLY keeps "
             "them apart",
             count_text(joined.rounded, "vertex", "vertices"), format, count_text(collapsed, "triangle", "triangles"),
             by_count(collapsed, "was", "were"));
    Buffer<Triangle> triangles = mesh.triangles;
    if (collapsed > 0) {
        Array<Triangle> kept;
        kept.reserve(mesh.triangles.size() - collapsed);
        for (const Triangle& triangle : mesh.triangles)
            if (!collapses(mesh, joined, triangle)) kept.push_back(triangle);
        triangles = std::move(kept);
    }
    warn_opened(mesh, triangles, joined, format, options);
    return triangles;
}

void warn_collapsed(const TriangleMesh& mesh, const JoinedVertices& joined, std::string_view format,
                    const WriteOptions& options) {
    if (joined.rounded == 0) return;
    warn(options.on_warning,
         "{} became equal to others in {}'s single precision, and {} lost {} area; PLY keeps them apart",
         count_text(joined.rounded, "vertex", "vertices"), format,
         count_text(collapsed_triangles(mesh, joined), "triangle", "triangles"),
         by_count(collapsed_triangles(mesh, joined), "its", "their"));
}

}  // namespace scanmill
