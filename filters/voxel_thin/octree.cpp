// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel_thin/octree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "scanmill/base/error.hpp"

namespace scanmill::voxel {

namespace {

constexpr int most_levels = 21;

/// A point's cell at the deepest level: three bits per level, those of the first division highest.
struct Located {
    u64 code;
    u32 row;
    bool operator<(const Located& other) const { return code != other.code ? code < other.code : row < other.row; }
};

u64 code_of(const Vec3& p, const Vec3& origin, double finest) {
    constexpr double last = (1 << most_levels) - 1;
    std::array<u64, 3> cell;
    for (int axis = 0; axis < 3; ++axis)
        cell[static_cast<std::size_t>(axis)] =
            static_cast<u64>(std::clamp(std::floor((p[axis] - origin[axis]) / finest), 0.0, last));
    u64 code = 0;
    for (int bit = most_levels - 1; bit >= 0; --bit)
        for (const u64 coordinate : cell) code = code << 1 | (coordinate >> bit & 1);
    return code;
}

/// Returns the low corner of the code's cell at this level, counted in cells of this level.
Vec3 cell_of(u64 code, int level) {
    Vec3 cell = Vec3::Zero();
    for (int i = 0; i < level; ++i)
        for (int axis = 0; axis < 3; ++axis)
            cell[axis] = 2 * cell[axis] + static_cast<double>(code >> (3 * (most_levels - i) - 1 - axis) & 1);
    return cell;
}

class Octree {
public:
    Octree(std::span<const Vec3> positions, std::span<const u32> size_of_row, std::span<const double> sizes,
           const Vec3& origin, double edge)
        : positions_(positions),
          size_of_row_(size_of_row),
          sizes_(sizes),
          origin_(origin),
          edge_(edge) {}

    /// `points` are all points of one cell of this level, sorted by code.
    void thin(std::span<const Located> points, int level) {
        if (points.size() > 1 && level < most_levels && std::ldexp(edge_, -level) > least_size(points)) {
            const int shift = 3 * (most_levels - 1 - level);
            while (!points.empty()) {
                const u64 child = points.front().code >> shift;
                const auto end = std::ranges::partition_point(
                    points, [&](const Located& point) { return point.code >> shift == child; });
                const auto count = static_cast<std::size_t>(end - points.begin());
                thin(points.first(count), level + 1);
                points = points.subspan(count);
            }
            return;
        }
        require_fine_enough(points, level);
        keep_one(points, level);
    }

    OctreeChoice choice;

private:
    double least_size(std::span<const Located> points) const {
        double least = std::numeric_limits<double>::infinity();
        for (const Located& point : points) least = std::min(least, sizes_[size_of_row_[point.row]]);
        return least;
    }

    /// Only at the deepest level can a leaf be larger than its points allow. Duplicates are never divided.
    void require_fine_enough(std::span<const Located> points, int level) const {
        const double edge = std::ldexp(edge_, -level), least = least_size(points);
        const auto differs = [&](const Located& point) {
            return positions_[point.row] != positions_[points.front().row];
        };
        if (level < most_levels || edge <= least || std::ranges::none_of(points, differs)) return;
        throw Error("the octree's smallest leaves have edges of {:.3g} u, 1/{} of its root, but a point needs {:.3g} u",
                    edge, u64(1) << most_levels, least)
            .hint("remove points far away from the object, or give a larger tolerance");
    }

    void keep_one(std::span<const Located> points, int level) {
        const double edge = std::ldexp(edge_, -level);
        const Vec3 centre = origin_ + (cell_of(points.front().code, level) + Vec3::Constant(0.5)) * edge;
        u32 best = ~u32(0);
        double best_squared = std::numeric_limits<double>::infinity();
        for (const Located& point : points) {
            const double squared = (positions_[point.row] - centre).squaredNorm();
            if (squared > best_squared || (squared == best_squared && point.row > best)) continue;
            best = point.row;
            best_squared = squared;
        }
        choice.rows.kept.push_back(best);
        choice.rows.members.push_back(static_cast<u32>(points.size()));
        choice.rows.edges.push_back(edge);
        if (points.size() == 1) return;
        choice.smallest = choice.smallest > 0 ? std::min(choice.smallest, edge) : edge;
        choice.largest = std::max(choice.largest, edge);
    }

    std::span<const Vec3> positions_;
    std::span<const u32> size_of_row_;
    std::span<const double> sizes_;
    Vec3 origin_;
    double edge_;
};

struct Root {
    Vec3 low;
    double edge;
    int levels;  ///< between the root and the basic voxels
};

/// Returns the smallest cell that holds the box. The cells are those of grids from `origin` with edges `base` times a
/// power of two. The cell need not contain `origin`, so a distant origin costs no levels. If the box begins below the
/// origin, because of stray points, the origin moves down by an edge. This edge is a multiple of all smaller ones, so
/// smaller cells stay the same.
Root root_over(const BoundingBox& box, Vec3 origin, double base) {
    if ((box.low.array() < origin.array()).any()) {
        double edge = base;
        while (edge < (box.high - box.low).maxCoeff()) edge *= 2;
        origin.array() -= edge;
    }
    int levels = 0;
    for (double edge = base;; edge *= 2, ++levels) {
        const Vec3 low = origin.array() + ((box.low - origin).array() / edge).floor() * edge;
        if ((box.high.array() < low.array() + edge).all()) return {low, edge, levels};
    }
}

/// Removes the points of basic voxels with fewer than `min_points` points. Counts these points and all basic voxels.
/// Pre: sorted by code.
void remove_noise(Array<Located>& points, int levels, u32 min_points, KeptRows& rows) {
    // If the root is more than 21 levels above the basic voxels, the deepest cells are larger than these, and count
    // instead.
    const int shift = 3 * (most_levels - std::min(levels, most_levels));
    std::size_t kept = 0;
    for (std::size_t begin = 0, end = 0; begin < points.size(); begin = end) {
        while (end < points.size() && points[end].code >> shift == points[begin].code >> shift) ++end;
        ++rows.voxels;
        if (end - begin < min_points)
            rows.noise += end - begin;
        else
            for (std::size_t i = begin; i < end; ++i) points[kept++] = points[i];
    }
    points.resize(kept);
}

void sort_by_row(KeptRows& rows) {
    Array<std::tuple<u32, u32, double>> leaves(rows.kept.size());
    for (std::size_t i = 0; i < leaves.size(); ++i) leaves[i] = {rows.kept[i], rows.members[i], rows.edges[i]};
    std::ranges::sort(leaves);
    for (std::size_t i = 0; i < leaves.size(); ++i) std::tie(rows.kept[i], rows.members[i], rows.edges[i]) = leaves[i];
}

}  // namespace

OctreeChoice choose_in_octree(std::span<const Vec3> positions, std::span<const u32> size_of_row,
                              std::span<const double> sizes, const Vec3& origin, double base, u32 min_points,
                              Context& context) {
    const Root root = root_over(bounding_box(positions), origin, base);
    const double finest = std::ldexp(root.edge, -most_levels);
    Array<Located> points(positions.size());
    for (u32 row = 0; row < points.size(); ++row) points[row] = {code_of(positions[row], root.low, finest), row};
    std::ranges::sort(points, std::less());
    context.check_cancelled();

    Octree octree(positions, size_of_row, sizes, root.low, root.edge);
    remove_noise(points, root.levels, min_points, octree.choice.rows);
    if (!points.empty()) octree.thin(points, 0);
    OctreeChoice choice = std::move(octree.choice);
    if (choice.largest == 0) choice.smallest = choice.largest = base;
    sort_by_row(choice.rows);
    return choice;
}

}  // namespace scanmill::voxel
