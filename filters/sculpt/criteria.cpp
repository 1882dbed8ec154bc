// SPDX-License-Identifier: GPL-3.0-or-later
#include "sculpt/criteria.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "scanmill/base/parallel.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/geometry/spatial/angle.hpp"

namespace scanmill::sculpting {

namespace {

constexpr double cosine_of_sharp = std::numbers::sqrt2 / 2;  // cosine of 45°
constexpr double sine_of_thin = 0.0017453283658983088;  // sine of 0.1°

std::array<int, 4> sorted_corners(const TetMesh& tets, u32 cell) {
    const Tetrahedron& corners = tets.cells[cell];
    std::array<int, 4> order{0, 1, 2, 3};
    const auto put_in_order = [&](int i, int j) {
        if (is_lower(tets.positions[corners[order[j]]], tets.positions[corners[order[i]]]))
            std::swap(order[i], order[j]);
    };
    put_in_order(0, 1);
    put_in_order(2, 3);
    put_in_order(0, 2);
    put_in_order(1, 3);
    put_in_order(1, 2);
    return order;
}

/// Normal whose length is twice the triangle's area. Except for the sign, its bits do not depend on the order of the
/// corners.
Vec3 normal_of(const Vec3& a, const Vec3& b, const Vec3& c) {
    // The lowest corner is the origin. It is chosen without a branch, which could not be predicted.
    const std::array<const Vec3*, 5> corners{&a, &b, &c, &a, &b};
    std::size_t low = is_lower(b, a) ? 1 : 0;
    low = is_lower(c, *corners[low]) ? 2 : low;
    const Vec3& lowest = *corners[low];
    return (*corners[low + 1] - lowest).cross(*corners[low + 2] - lowest);
}

/// The largest squared circumradius of the boundary's triangles.
double largest_squared_radius(const CarvedSolid& solid, const Gains& gains, unsigned threads) {
    constexpr std::size_t chunk = 1 << 14;
    const std::size_t cells = solid.tets().cells.size();
    Array<double> largest((cells + chunk - 1) / chunk);
    for_each_chunk(threads, cells, chunk, [&](std::size_t begin, std::size_t end) {
        double most = 0;
        for (u32 cell = static_cast<u32>(begin); cell < end; ++cell) {
            if (!solid.has(cell)) continue;
            const unsigned open = solid.open_facets(cell);
            for (int facet = 0; facet < 4; ++facet)
                if ((open >> facet & 1u) != 0) most = std::max(most, gains.squared_radius(cell, facet));
        }
        largest[begin / chunk] = most;
    });
    return *std::ranges::max_element(largest);
}

}  // namespace

double total_bending(BoundaryLinks& links, std::span<const Vec3> positions, unsigned threads) {
    constexpr std::size_t chunk = 1 << 13;
    Array<double> sums((links.vertices() + chunk - 1) / chunk);
    for_each_chunk(threads, links.vertices(), chunk, [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        std::vector<Vec3> normals;
        for (std::size_t vertex = begin; vertex < end; ++vertex) {
            const std::span<LinkEdge> link = links.of(vertex);
            std::ranges::sort(link, {}, &LinkEdge::from);
            const auto normal = [&](const LinkEdge& edge) {
                return normal_of(positions[vertex], positions[edge.from], positions[edge.to]);
            };
            normals.resize(link.size());
            std::ranges::transform(link, normals.begin(), normal);
            // Beyond the edge from `vertex` to `to` is the triangle whose `from` is that `to`.
            for (std::size_t i = 0; i < link.size(); ++i) {
                if (link[i].to < vertex) continue;
                const auto beyond = std::ranges::lower_bound(link, link[i].to, {}, &LinkEdge::from) - link.begin();
                sum += angle_between(normals[i], normals[static_cast<std::size_t>(beyond)]);
            }
        }
        sums[begin / chunk] = sum;
    });
    double total = 0;
    for (double sum : sums) total += sum;
    return total;
}

Vec3 Gains::normal(u32 cell, int facet) const {
    const Tetrahedron& corners = tets_.cells[cell];
    const auto& [a, b, c] = outward_facet[static_cast<std::size_t>(facet)];
    return normal_of(tets_.positions[corners[a]], tets_.positions[corners[b]], tets_.positions[corners[c]]);
}

Vec3 Gains::outer_normal(u32 cell, int across, int kept, Without without) const {
    EdgeWalk walk(tets_, cell, across, kept);
    while (solid_.has(walk.next(), without)) walk.step();
    return normal(walk.cell(), walk.across());
}

double Gains::of(u32 cell, unsigned open, Without without) const {
    const std::array<int, 4> sorted = sorted_corners(tets_, cell);
    std::array<Vec3, 4> normals;
    for (int facet = 0; facet < 4; ++facet) normals[facet] = normal(cell, facet);
    const auto is_open = [&](int facet) { return (open >> facet & 1u) != 0; };

    double gain = 0;
    for (const CellEdge& edge : cell_edges) {
        const int c = sorted[edge.c], d = sorted[edge.d];
        double change;
        if (is_open(c) && is_open(d)) {
            change = angle_between(normals[c], normals[d]);
        } else if (is_open(c) || is_open(d)) {
            const int before = is_open(c) ? c : d, after = is_open(c) ? d : c;
            const Vec3 outer = outer_normal(cell, after, before, without);
            const auto [angle_before, angle_after] = angles_between(normals[before], outer, -normals[after], outer);
            change = angle_before - angle_after;
        } else {
            change = -angle_between(normals[c], normals[d]);
        }
        if (weight_ == SculptWeight::length) {
            const Tetrahedron& corners = tets_.cells[cell];
            change *= (tets_.positions[corners[sorted[edge.a]]] - tets_.positions[corners[sorted[edge.b]]]).norm();
        }
        gain += change;
    }
    return gain;
}

bool Gains::is_sharp(u32 cell, unsigned open) const {
    const auto [a, b] = both_corners(open);
    const Vec3 m = normal(cell, a), n = normal(cell, b);
    return m.dot(n) < cosine_of_sharp * std::sqrt(m.squaredNorm() * n.squaredNorm());
}

double Gains::weight_of_flip(u32 cell, unsigned open) const {
    if (weight_ == SculptWeight::none) return 1;
    const auto [c, d] = both_corners(~open & 15u);
    return (tets_.positions[tets_.cells[cell][c]] - tets_.positions[tets_.cells[cell][d]]).norm();
}

bool Gains::uncovers_thin_facet(u32 cell, unsigned open) const {
    for (int facet : both_corners(~open & 15u)) {
        const auto& [i, j, k] = outward_facet[static_cast<std::size_t>(facet)];
        const Tetrahedron& corners = tets_.cells[cell];
        const Vec3 a = tets_.positions[corners[i]], b = tets_.positions[corners[j]], c = tets_.positions[corners[k]];
        std::array<double, 3> edges{(b - a).norm(), (c - b).norm(), (a - c).norm()};
        std::ranges::sort(edges);
        // The smallest angle is between the two longest edges.
        if (normal(cell, facet).norm() < sine_of_thin * edges[1] * edges[2]) return true;
    }
    return false;
}

bool Gains::uncovers_larger_facet(u32 cell, unsigned open, double most) const {
    for (int facet = 0; facet < 4; ++facet)
        if ((open >> facet & 1u) == 0 && squared_radius(cell, facet) > most) return true;
    return false;
}

double Gains::squared_radius(u32 cell, int facet) const {
    const auto& [i, j, k] = outward_facet[static_cast<std::size_t>(facet)];
    const Tetrahedron& corners = tets_.cells[cell];
    const Vec3 a = tets_.positions[corners[i]], b = tets_.positions[corners[j]], c = tets_.positions[corners[k]];
    std::array<double, 3> edges{(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()};
    std::ranges::sort(edges);
    const double squared_area = 4 * normal(cell, facet).squaredNorm();
    return squared_area > 0 ? edges[0] * edges[1] * edges[2] / squared_area : std::numeric_limits<double>::infinity();
}

double Gains::volume(u32 cell) const {
    const Tetrahedron& corners = tets_.cells[cell];
    const Vec3& a = tets_.positions[corners[0]];
    const Vec3 u = tets_.positions[corners[1]] - a, v = tets_.positions[corners[2]] - a;
    return u.cross(v).dot(tets_.positions[corners[3]] - a) / 6;
}

bool is_lower_cell(const TetMesh& tets, u32 a, u32 b) {
    const std::array<int, 4> first = sorted_corners(tets, a), second = sorted_corners(tets, b);
    for (std::size_t i = 0; i < 4; ++i) {
        const u32 u = tets.cells[a][first[i]], v = tets.cells[b][second[i]];
        if (u != v) return is_lower(tets.positions[u], tets.positions[v]);
    }
    return false;
}

StepCriteria::StepCriteria(const CarvedSolid& solid, const SculptParams& params, unsigned threads)
    : solid_(solid),
      gains_(solid, params.weight),
      min_gain_(params.min_gain.in_radians()),
      largest_(largest_squared_radius(solid, gains_, threads)),
      lookahead_(params.lookahead),
      is_near_exposed_(solid.tets().cells.size()) {
    std::ranges::fill(is_near_exposed_, u8(0));
}

std::optional<double> StepCriteria::flip(u32 cell, unsigned open, Without without) const {
    if (!solid_.flips(cell, open, without)) return std::nullopt;
    const double gain = gains_.of(cell, open, without);
    if (!(gain > least_gain(cell, open))) return std::nullopt;
    if (gains_.uncovers_thin_facet(cell, open) || uncovers_too_large(cell, open)) return std::nullopt;
    return gain;
}

double StepCriteria::exposing(u32 cell, unsigned open) const {
    const double alone = gains_.of(cell, open);
    if (!lookahead_) return alone;
    const Without removed(&cell, 1);
    double best = 0;
    for (u32 across : solid_.tets().neighbours[cell])
        if (solid_.has(across))
            best = std::max(best, flip(across, solid_.open_facets(across, removed), removed).value_or(0));
    return alone + best;
}

}  // namespace scanmill::sculpting
