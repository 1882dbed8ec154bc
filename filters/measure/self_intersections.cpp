// SPDX-License-Identifier: GPL-3.0-or-later
#include "measure/self_intersections.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <numeric>

#include "scanmill/base/parallel.hpp"

namespace scanmill {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// For every vertex the smallest row among those at its position.
Array<u32> merged_vertices(std::span<const Vec3> positions) {
    Array<u32> order(positions.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::sort(order, [&](u32 a, u32 b) {
        for (int axis = 0; axis < 3; ++axis)
            if (positions[a][axis] != positions[b][axis]) return positions[a][axis] < positions[b][axis];
        return a < b;
    });
    Array<u32> merged(positions.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        merged[order[i]] = i > 0 && positions[order[i]] == positions[order[i - 1]] ? merged[order[i - 1]] : order[i];
    return merged;
}

class PairTest {
public:
    explicit PairTest(const TriangleMesh& mesh) : mesh_(mesh), vertices_(merged_vertices(mesh.positions.span())) {}

    bool is_collinear(u32 row) const {
        const Triangle corners = merged(row);
        return CGAL::collinear(point(corners[0]), point(corners[1]), point(corners[2]));
    }

    /// Pre: neither is collinear.
    bool meet(u32 row, u32 other_row) const {
        Triangle one = merged(row), other = merged(other_row);
        switch (bring_common_first(one, other)) {
            case 0: return CGAL::do_intersect(triangle(one), triangle(other));
            case 1:
                // Whatever else they share reaches one's opposite edge.
                return CGAL::do_intersect(triangle(one), segment(other[1], other[2])) ||
                       CGAL::do_intersect(triangle(other), segment(one[1], one[2]));
            case 2: return folded(one, other);
            default: return true;  // the same triangle twice
        }
    }

private:
    Triangle merged(u32 row) const {
        const Triangle& corners = mesh_.triangles[row];
        return {vertices_[corners[0]], vertices_[corners[1]], vertices_[corners[2]]};
    }

    /// Reorders both so that their common vertices lead, in the same order; returns how many there are.
    static std::size_t bring_common_first(Triangle& one, Triangle& other) {
        std::size_t common = 0;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = common; j < 3; ++j)
                if (one[i] == other[j]) {
                    std::swap(one[common], one[i]);
                    std::swap(other[common], other[j]);
                    ++common;
                    break;
                }
        return common;
    }

    /// Triangles that share the edge of their first two vertices overlap when one is folded flat onto the other.
    bool folded(const Triangle& one, const Triangle& other) const {
        const Kernel::Point_3 a = point(one[0]), b = point(one[1]), c = point(one[2]), d = point(other[2]);
        return CGAL::coplanar(a, b, c, d) && CGAL::coplanar_orientation(a, b, c, d) == CGAL::POSITIVE;
    }

    Kernel::Point_3 point(u32 vertex) const {
        const Vec3& p = mesh_.positions[vertex];
        return {p.x(), p.y(), p.z()};
    }
    Kernel::Triangle_3 triangle(const Triangle& t) const { return {point(t[0]), point(t[1]), point(t[2])}; }
    Kernel::Segment_3 segment(u32 a, u32 b) const { return {point(a), point(b)}; }

    const TriangleMesh& mesh_;
    Array<u32> vertices_;
};

}  // namespace

std::size_t count_self_intersections(const TriangleMesh& mesh, const TriangleTree& tree, Context& context) {
    const PairTest test(mesh);
    const std::size_t count = mesh.triangles.size();
    Array<u8> collinear(count);
    constexpr std::size_t chunk = 1 << 10;
    for_each_chunk(context.threads(), count, chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) collinear[row] = test.is_collinear(static_cast<u32>(row));
    });
    Array<u64> pairs((count + chunk - 1) / chunk, 0);
    for_each_chunk(context.threads(), count, chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        Array<u32> near;
        for (std::size_t row = begin; row < end; ++row) {
            if (collinear[row]) continue;
            BoundingBox box;
            for (u32 vertex : mesh.triangles[row]) {
                box.low = box.low.cwiseMin(mesh.positions[vertex]);
                box.high = box.high.cwiseMax(mesh.positions[vertex]);
            }
            near.clear();
            tree.meeting(box, near);
            for (u32 other : near)
                if (other > row && !collinear[other]) pairs[begin / chunk] += test.meet(static_cast<u32>(row), other);
        }
    });
    return std::accumulate(pairs.begin(), pairs.end(), std::size_t(0));
}

}  // namespace scanmill
