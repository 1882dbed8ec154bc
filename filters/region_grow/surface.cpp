// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "scanmill/data/points.hpp"

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

}  // namespace

Surface::Surface(const Samples& from, const Neighbourhoods& near, PointNormals facing, Array<double> search_radii,
                 Array<double> usual_radii, bool are_oriented)
    : samples(from),
      neighbourhoods(near),
      positions(from.positions),
      normals(std::move(facing.directions)),
      roughness(std::move(facing.roughness)),
      search_radius(std::move(search_radii)),
      usual_radius(std::move(usual_radii)),
      oriented(are_oriented),
      axis_length(power_of_two_above_extent(from.positions)),
      fans(from.size()),
      states(from.size()) {
    std::ranges::fill(states, PlaceState::unused);
    triangles.reserve(2 * from.size());
    passes.reserve(2 * from.size());
}

u32 Surface::next_on_border(u32 vertex) const {
    u32 next = nobody;
    fans.any(vertex, [&](const Fans::Pair& pair) {
        return fans.right_of(vertex, pair.first) == nobody && (next = pair.first, true);
    });
    return next;
}

Vec3 Surface::facet_normal(u32 a, u32 b, u32 c) const {
    return (positions[b] - positions[a]).cross(positions[c] - positions[a]).normalized();
}

void Surface::add(const Triangle& triangle, Pass pass) {
    const auto& [a, b, c] = triangle;
    assert(fans.left_of(a, b) == nobody && fans.left_of(b, c) == nobody && fans.left_of(c, a) == nobody);
    const Vec3 normal = facet_normal(a, b, c);
    fans.add(triangle);
    triangles.push_back(triangle);
    passes.push_back(pass);
    for (u32 corner : triangle) {
        if (states[corner] == PlaceState::unused && !oriented && normals[corner].dot(normal) < 0)
            normals[corner] = -normals[corner];
        states[corner] = fans.closed(corner) ? PlaceState::interior : PlaceState::front;
    }
}

void Surface::drop(std::vector<Triangle> taken_off) {
    if (taken_off.empty()) return;
    for (Triangle& triangle : taken_off) triangle = lowest_first(triangle);
    std::ranges::sort(taken_off);
    std::vector<bool> gone(taken_off.size(), false);
    std::size_t kept = 0;
    for (std::size_t row = 0; row < triangles.size(); ++row) {
        const Triangle triangle = lowest_first(triangles[row]);
        auto at = static_cast<std::size_t>(std::ranges::lower_bound(taken_off, triangle) - taken_off.begin());
        while (at < taken_off.size() && taken_off[at] == triangle && gone[at]) ++at;
        if (at < taken_off.size() && taken_off[at] == triangle) {
            gone[at] = true;
            continue;
        }
        triangles[kept] = triangles[row];
        passes[kept++] = passes[row];
    }
    assert(kept + taken_off.size() == triangles.size());
    triangles.resize(kept);
    passes.resize(kept);
}

}  // namespace scanmill::growing
