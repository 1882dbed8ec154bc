// SPDX-License-Identifier: GPL-3.0-or-later
#include "tessellate/grid.hpp"

#include <algorithm>
#include <cmath>

namespace scanmill::tessellation {

namespace {

constexpr unsigned length_steps = 8;

class GridBuilder {
public:
    GridBuilder(const PatchComplex& patches, const TriangleTets& triangle, const std::array<Row, 3>& edges,
                std::span<const SurfacePoint> points, double zero)
        : patches_(patches),
          triangle_(triangle),
          edges_(edges),
          points_(points),
          zero_(zero) {
        for (const std::size_t side : {1, 0})
            for (u32 third = 0; third < triangle.count; ++third)
                cells_.emplace_back(patches, triangle.rows[side][third]);
    }

    void build(Grid& grid, const Fineness& fineness) const {
        const bool is_straight = std::ranges::all_of(edges_, [](const Row& edge) { return edge.vertices.size() == 2; });
        // A grid of a single triangle is possible only between three segments.
        grid.is_triangular = triangle_.count == 1 && (!fineness.max_error || is_straight);
        if (grid.is_triangular && !is_straight) grid.segments = std::max(grid.segments, 2u);
        grid.rows = fineness.max_error ? 1 : grid.segments;
        const std::vector<double> lengths = fineness.max_error ? lengths_to_corners() : std::vector<double>();
        for (;;) {
            set_shares(grid, lengths);
            lift(grid);
            if (!fineness.max_error) return;
            const Errors errors = errors_of(grid);
            grid.worst = errors.worst();
            if (grid.is_triangular) {
                if (grid.worst <= *fineness.max_error) return;
                grid.is_triangular = false;
            } else if (!refine(grid.segments, grid.rows, errors, *fineness.max_error, fineness.most, fineness.most)) {
                return;
            }
        }
    }

private:
    /// Cumulative lengths on the surface above the lines from the base point to the corners, at equal steps along the
    /// lines. Each step counts with the longest of the three. Towards the corners, lines to the apex make a small angle
    /// with the surface, so the steps grow.
    std::vector<double> lengths_to_corners() const {
        std::vector<double> lengths{0};
        std::array<Vec3, 3> before;
        for (unsigned step = 0; step <= length_steps; ++step) {
            double longest = 0;
            for (u32 third = 0; third < 3; ++third) {
                const double share = static_cast<double>(step) / length_steps;
                const Vec3 here = step < length_steps ? above(third, share, 0).position
                                                      : patches_.positions[triangle_.corners[third]];
                if (step > 0) longest = std::max(longest, (here - before[third]).norm());
                before[third] = here;
            }
            if (step > 0) lengths.push_back(lengths.back() + longest);
        }
        return lengths;
    }

    /// Spaces the rows: equal steps of length, or equal steps in the triangle if no lengths are given.
    static void set_shares(Grid& grid, const std::vector<double>& lengths) {
        grid.shares.clear();
        for (unsigned r = 0, step = 0; r <= grid.rows; ++r) {
            const double share = static_cast<double>(r) / grid.rows;
            grid.shares.push_back(share);
            if (lengths.empty() || r == grid.rows || !(lengths.back() > 0)) continue;
            const double wanted = share * lengths.back();
            while (step + 2 < lengths.size() && lengths[step + 1] < wanted) ++step;
            const double part = (wanted - lengths[step]) / (lengths[step + 1] - lengths[step]);
            grid.shares.back() = (step + part) / static_cast<double>(lengths.size() - 1);
        }
    }

    Errors errors_of(const Grid& grid) const {
        const auto position = [&](u32 vertex) -> const Vec3& {
            return vertex < points_.size() ? points_[vertex].position : grid.points[vertex - points_.size()].position;
        };
        Errors errors;
        connect(grid, static_cast<u32>(points_.size()), edges_, [&](u32 third, u32 a, u32 b, u32 c) {
            if (a == b || b == c || c == a) return;
            const Vec3 &p = position(a), &q = position(b), &r = position(c);
            // The corners may be on both sides of the mesh.
            const u32 part = triangle_.count == 3 ? third : 0;
            const auto at = [&](const Vec3& x) {
                const bool is_outer = cells_[part].own().coordinates(x)[3] >= 0;
                return std::abs(cells_[is_outer ? part : triangle_.count + part].own().first_order_distance(x));
            };
            errors.along = std::max(errors.along, distance_on_segment(p, q, at));
            errors.inside = std::max(
                {errors.inside, distance_on_segment(q, r, at), distance_on_segment(r, p, at), at((p + q + r) / 3)});
        });
        return errors;
    }

    /// The surface point above a point of a triangle. `base` are the coordinates of that point: in a third, those of
    /// the base point and of corners i and j; otherwise those in the undivided triangle.
    SurfacePoint above(u32 third, const Vec3& base) const {
        const Barycentric from(base[0], base[1], base[2], 0);
        const u8 side = cells_[third].side_at(from, zero_);
        return cells_[side == 1 ? third : cells_.size() / 2 + third]
            .hit(side, from, Barycentric(0, 0, 0, 1), zero_)
            .point;
    }

    /// The surface point above the point at `share` of the way from the base point, or the centre of an undivided
    /// triangle, to the point at `along` of the edge of this third.
    SurfacePoint above(u32 third, double share, double along) const {
        const double i = share * (1 - along), j = share * along;
        if (triangle_.count == 3) return above(third, {1 - share, i, j});
        Vec3 base = Vec3::Constant((1 - share) / 3);
        base[third] += i;
        base[(third + 1) % 3] += j;
        return above(0, base);
    }

    /// Returns how far the crease reaches into a triangle at this share of the edge, as a share of the way to the base
    /// point.
    static double inset_at(const Row& edge, double along) {
        const auto next =
            std::max<std::ptrdiff_t>(1, std::ranges::lower_bound(edge.shares, along) - edge.shares.begin());
        const auto j = static_cast<std::size_t>(next), i = j - 1;
        const double part = (along - edge.shares[i]) / (edge.shares[j] - edge.shares[i]);
        return (1 - part) * edge.insets[i] + part * edge.insets[j];
    }

    void lift(Grid& grid) const {
        const u32 n = grid.segments;
        if (!grid.is_triangular) {
            const ThirdsNumbers numbers(grid);
            grid.points.resize(numbers.count());
            for (u32 third = 0; third < 3; ++third)
                for (u32 r = third == 0 ? 0 : 1; r < grid.rows; ++r) {
                    const u32 count = std::max(grid.segments_of(r), 1u);
                    for (u32 k = 0; k < count; ++k) {
                        const double along = static_cast<double>(k) / count;
                        grid.points[numbers(third, r, k)] =
                            above(third, grid.shares[r] * (1 - inset_at(edges_[third], along)), along);
                    }
                }
        } else if (n == 2) {
            grid.points = {above(0, Vec3::Constant(1. / 3))};
        } else {
            grid.points.resize(n == 1 ? 0 : (n - 1) * (n - 2) / 2);
            for (u32 i = 1; i < n; ++i)
                for (u32 j = 1; i + j < n; ++j) grid.points[grid_vertex(i, j)] = above(0, Vec3(n - i - j, i, j) / n);
        }
    }

    const PatchComplex& patches_;
    const TriangleTets& triangle_;
    const std::array<Row, 3>& edges_;
    std::span<const SurfacePoint> points_;
    double zero_;
    std::vector<TetFunctions> cells_;  ///< by side, the outer one first, and third
};

}  // namespace

void build(Grid& grid, const PatchComplex& patches, const TriangleTets& triangle, const std::array<Row, 3>& edges,
           std::span<const SurfacePoint> points, double zero, const Fineness& fineness) {
    GridBuilder(patches, triangle, edges, points, zero).build(grid, fineness);
}

}  // namespace scanmill::tessellation
