// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/feature_net.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <tuple>

#include "scanmill/geometry/mesh/boundary_loops.hpp"
#include "scanmill/geometry/mesh/half_edges.hpp"
#include "scanmill/geometry/spatial/angle.hpp"

namespace scanmill {

namespace {

constexpr u32 none = ~u32(0);

}  // namespace

FeatureNet::FeatureNet(const TriangleMesh& mesh, std::span<const u32> opposite, const std::vector<bool>& sharp,
                       double corner_angle)
    : mesh_(mesh),
      opposite_(opposite),
      loops_(boundary_loops(mesh, opposite)) {
    number_vertices(sharp);
    find_creases(sharp);
    find_corners(corner_angle);
    for (Array<u32>& loop : loops_) begin_at_the_lowest(loop);
}

u32 FeatureNet::number_at_start(u32 half_edge) const { return number_[half_edges::start(mesh_, half_edge)]; }
u32 FeatureNet::number_at_end(u32 half_edge) const { return number_[half_edges::end(mesh_, half_edge)]; }

void FeatureNet::number_vertices(const std::vector<bool>& sharp) {
    number_.assign(mesh_.positions.size(), none);
    for (u32 half_edge = 0; half_edge < opposite_.size(); ++half_edge) {
        if (opposite_[half_edge] != half_edges::boundary && !sharp[half_edge]) continue;
        for (const u32 vertex : {half_edges::start(mesh_, half_edge), half_edges::end(mesh_, half_edge)}) {
            if (number_[vertex] == none) vertices_.push_back(vertex);
            number_[vertex] = 0;
        }
    }
    const auto place = [&](u32 vertex) {
        const Vec3& p = mesh_.positions[vertex];
        return std::tuple(p.x(), p.y(), p.z(), vertex);
    };
    std::ranges::sort(vertices_, {}, place);
    for (u32 number = 0; number < vertices_.size(); ++number) number_[vertices_[number]] = number;
}

void FeatureNet::find_creases(const std::vector<bool>& sharp) {
    // An edge leaves both its ends: once with each of its two sides.
    begin_.assign(vertices_.size() + 1, 0);
    for (u32 half_edge = 0; half_edge < opposite_.size(); ++half_edge)
        if (sharp[half_edge]) ++begin_[number_at_start(half_edge)];
    std::exclusive_scan(begin_.begin(), begin_.end(), begin_.begin(), u32(0));
    creases_.resize(begin_.back());
    Array<u32> next(begin_.begin(), begin_.end() - 1);
    for (u32 half_edge = 0; half_edge < opposite_.size(); ++half_edge)
        if (sharp[half_edge]) creases_[next[number_at_start(half_edge)]++] = {number_at_end(half_edge), half_edge};
    for (std::size_t number = 0; number < vertices_.size(); ++number)
        std::sort(creases_.begin() + begin_[number], creases_.begin() + begin_[number + 1],
                  [](const Crease& a, const Crease& b) { return a.end < b.end; });
}

std::span<const FeatureNet::Crease> FeatureNet::creases_at(u32 number) const {
    return std::span(creases_).subspan(begin_[number], begin_[number + 1] - begin_[number]);
}

bool FeatureNet::turns(u32 before, u32 at, u32 after, double corner_angle) const {
    const Vec3& here = mesh_.positions[vertices_[at]];
    const Vec3 arriving = here - mesh_.positions[vertices_[before]], leaving = mesh_.positions[vertices_[after]] - here;
    return angle_between(arriving, leaving) > corner_angle;
}

void FeatureNet::find_corners(double corner_angle) {
    is_corner_.assign(vertices_.size(), false);
    boundary_edges_.assign(vertices_.size(), 0);
    for (const Array<u32>& loop : loops_)
        for (const u32 half_edge : loop) {
            ++boundary_edges_[number_at_start(half_edge)];
            ++boundary_edges_[number_at_end(half_edge)];
        }
    for (u32 number = 0; number < vertices_.size(); ++number) {
        const std::span<const Crease> creases = creases_at(number);
        if (creases.size() + boundary_edges_[number] != 2)
            is_corner_[number] = true;
        else if (creases.size() == 2)
            is_corner_[number] = turns(creases[0].end, number, creases[1].end, corner_angle);
    }
    for (const Array<u32>& loop : loops_)
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const u32 arriving = loop[i], leaving = loop[i + 1 == loop.size() ? 0 : i + 1];
            const u32 here = number_at_start(leaving);
            if (turns(number_at_start(arriving), here, number_at_end(leaving), corner_angle)) is_corner_[here] = true;
        }
}

void FeatureNet::begin_at_the_lowest(Array<u32>& loop) const {
    const auto rank = [&](u32 half_edge) {
        const u32 start = number_at_start(half_edge);
        return std::tuple(!is_corner_[start], start, number_at_end(half_edge));
    };
    std::ranges::rotate(loop, std::ranges::min_element(loop, {}, rank));
}

FeatureLine FeatureNet::crease_from(const Crease& first, std::vector<bool>& seen) const {
    FeatureLine line{FeatureType::crease, false, {}};
    const u32 begin = number_at_start(first.half_edge);
    for (Crease crease = first;;) {
        assert(!seen[crease.half_edge]);
        seen[crease.half_edge] = seen[opposite_[crease.half_edge]] = true;
        line.half_edges.push_back(crease.half_edge);
        line.closed = crease.end == begin;
        if (line.closed || is_corner_[crease.end]) return line;
        const std::span<const Crease> two = creases_at(crease.end);
        crease = two[0].half_edge == opposite_[crease.half_edge] ? two[1] : two[0];
    }
}

std::vector<FeatureLine> FeatureNet::lines() const {
    std::vector<FeatureLine> lines;
    for (const Array<u32>& loop : loops_) lines.push_back({FeatureType::outer_boundary, true, loop});
    std::vector<bool> seen(opposite_.size(), false);
    for (const bool at_corners : {true, false})  // what is left between corners are rings: from their lowest vertex
        for (u32 number = 0; number < vertices_.size(); ++number) {
            if (is_corner_[number] != at_corners) continue;
            for (const Crease& crease : creases_at(number))
                if (!seen[crease.half_edge]) lines.push_back(crease_from(crease, seen));
        }
    std::ranges::sort(lines, {}, [&](const FeatureLine& line) {
        return std::tuple(line.type, number_at_start(line.half_edges[0]), number_at_end(line.half_edges[0]));
    });
    return lines;
}

}  // namespace scanmill
