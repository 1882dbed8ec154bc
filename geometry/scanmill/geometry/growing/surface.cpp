// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/growing/surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "scanmill/data/points.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::growing {

namespace {

Triangle lowest_first(Triangle triangle) {
    std::ranges::rotate(triangle, std::ranges::min_element(triangle));
    return triangle;
}

double power_of_two_above_extent(std::span<const Vec3> positions) {
    const BoundingBox box = bounding_box(positions);
    int exponent = 0;
    std::frexp((box.high - box.low).maxCoeff(), &exponent);
    return std::ldexp(1.0, exponent);
}

using Fan = std::vector<Fans::LinkEdge>;

u32 lowest(const Fan& fan) {
    u32 least = invalid_index;
    for (const auto& [first, last] : fan) least = std::min({least, first, last});
    return least;
}

std::vector<Fan> fans_at(const Surface& surface, u32 vertex) {
    Fan left;
    surface.fans.any(vertex, [&](const Fans::LinkEdge& edge) {
        left.push_back(edge);
        return false;
    });
    std::vector<Fan> fans;
    while (!left.empty()) {
        Fan fan{left.back()};
        left.pop_back();
        for (std::size_t i = 0; i < fan.size(); ++i)
            for (std::size_t j = 0; j < left.size();) {
                if (left[j].first != fan[i].last && left[j].last != fan[i].first) {
                    ++j;
                    continue;
                }
                fan.push_back(left[j]);
                left[j] = left.back();
                left.pop_back();
            }
        fans.push_back(std::move(fan));
    }
    return fans;
}

}  // namespace

Surface::Surface(const DistinctPoints& from, const Neighbourhoods& near, PointNormals point_normals,
                 Array<double> search_radii, Array<double> density_radii, bool signs_count)
    : points(from),
      neighbourhoods(near),
      positions(from.positions),
      normals(std::move(point_normals.directions)),
      variation(std::move(point_normals.variation)),
      search_radius(std::move(search_radii)),
      density_radius(std::move(density_radii)),
      oriented(signs_count),
      axis_length(power_of_two_above_extent(from.positions)),
      fans(from.size()),
      states(from.size()) {
    std::ranges::fill(states, PointState::unused);
    triangles.reserve(2 * from.size());
    passes.reserve(2 * from.size());
}

u32 Surface::next_on_boundary(u32 vertex) const {
    u32 next = invalid_index;
    fans.any(vertex, [&](const Fans::LinkEdge& edge) {
        return fans.right_of(vertex, edge.first) == invalid_index && (next = edge.first, true);
    });
    return next;
}

Vec3 Surface::facet_normal(u32 a, u32 b, u32 c) const { return area_vector(positions, {a, b, c}).normalized(); }

void Surface::add(const Triangle& triangle, Pass pass) {
    const auto& [a, b, c] = triangle;
    assert(fans.left_of(a, b) == invalid_index && fans.left_of(b, c) == invalid_index &&
           fans.left_of(c, a) == invalid_index);
    const Vec3 normal = facet_normal(a, b, c);
    fans.add(triangle);
    triangles.push_back(triangle);
    passes.push_back(pass);
    for (u32 corner : triangle) {
        if (states[corner] == PointState::unused && !oriented && normals[corner].dot(normal) < 0)
            normals[corner] = -normals[corner];
        states[corner] = fans.closed(corner) ? PointState::interior : PointState::front;
    }
}

void Surface::drop(std::vector<Triangle> removed) {
    if (removed.empty()) return;
    for (Triangle& triangle : removed) triangle = lowest_first(triangle);
    std::ranges::sort(removed);
    std::vector<bool> gone(removed.size(), false);
    std::size_t kept = 0;
    for (std::size_t row = 0; row < triangles.size(); ++row) {
        const Triangle triangle = lowest_first(triangles[row]);
        auto at = static_cast<std::size_t>(std::ranges::lower_bound(removed, triangle) - removed.begin());
        while (at < removed.size() && removed[at] == triangle && gone[at]) ++at;
        if (at < removed.size() && removed[at] == triangle) {
            gone[at] = true;
            continue;
        }
        triangles[kept] = triangles[row];
        passes[kept++] = passes[row];
    }
    assert(kept + removed.size() == triangles.size());
    triangles.resize(kept);
    passes.resize(kept);
}

bool has_angles_of(const Surface& surface, const Triangle& triangle, double least_sine) {
    const auto& p = surface.positions;
    const auto& [from, point, to] = triangle;
    const double a = (p[point] - p[to]).norm(), b = (p[point] - p[from]).norm(), c = (p[to] - p[from]).norm();
    // The smallest angle is opposite the shortest side. Its sine is the length of this side over the diameter of the
    // circumcircle.
    const double twice_area = area_vector(p, triangle).norm();
    return std::min({a, b, c}) * twice_area >= least_sine * a * b * c;
}

bool agrees_with_points(const Surface& surface, const Triangle& triangle, const Vec3& normal, double point_cosine,
                        double sharp_cosine) {
    return std::ranges::all_of(triangle, [&](u32 corner) {
        const double cosine = surface.normals[corner].dot(normal);
        const bool sign_counts = surface.oriented || surface.is_used(corner);
        const float variation = surface.variation[corner];
        if (variation > tip_variation) return true;
        const double least = variation > sharp_variation ? sharp_cosine : point_cosine;
        return (sign_counts ? cosine : std::abs(cosine)) >= least;
    });
}

std::size_t remove_extra_fans(Surface& surface) {
    std::vector<u32> candidates;
    for (u32 vertex = 0; vertex < surface.states.size(); ++vertex)
        if (surface.states[vertex] == PointState::front) candidates.push_back(vertex);
    std::vector<Triangle> removed;
    for (std::size_t i = 0; i < candidates.size(); ++i) {  // grows in the loop
        const u32 vertex = candidates[i];
        std::vector<Fan> fans = fans_at(surface, vertex);
        if (fans.size() < 2) continue;
        const auto stays = std::ranges::max_element(fans, [](const Fan& a, const Fan& b) {
            return a.size() != b.size() ? a.size() < b.size() : lowest(a) > lowest(b);
        });
        for (auto fan = fans.begin(); fan != fans.end(); ++fan) {
            if (fan == stays) continue;
            for (const auto& [first, last] : *fan) {
                const Triangle triangle{vertex, first, last};
                surface.fans.remove(triangle);
                removed.push_back(triangle);
                for (u32 corner : triangle) {
                    surface.states[corner] = surface.fans.empty(corner)    ? PointState::unused
                                             : surface.fans.closed(corner) ? PointState::interior
                                                                           : PointState::front;
                    candidates.push_back(corner);
                }
            }
        }
    }
    const std::size_t count = removed.size();
    surface.drop(std::move(removed));
    return count;
}

}  // namespace scanmill::growing
