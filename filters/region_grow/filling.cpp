// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/filling.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "region_grow/triangle_circle.hpp"

namespace scanmill::growing {

namespace {

constexpr double impossible = std::numeric_limits<double>::infinity();

/// A hole's corners, counter-clockwise as its triangles will be. The part between corners i and j is filled by a
/// triangle over the chord from i to j, and by the parts beyond its other sides.
class Filling {
public:
    Filling(const Surface& surface, const NearTriangles& near, const std::vector<u32>& corners,
            const FillLimits& limits)
        : surface_(surface),
          near_(near),
          corners_(corners),
          limits_(limits),
          parts_(corners_.size() * corners_.size()) {}

    std::vector<Triangle> find() {
        const std::size_t count = corners_.size();
        for (std::size_t span = 2; span < count; ++span)
            for (std::size_t i = 0; i + span < count; ++i) solve(i, i + span);
        std::vector<Triangle> triangles;
        if (part(0, count - 1).cost < impossible) collect(0, count - 1, triangles);
        return triangles;
    }

private:
    struct Part {
        double cost = 0;
        std::size_t apex = 0;
        /// Of the triangle over the chord.
        Vec3 normal = Vec3::Zero();
    };
    Part& part(std::size_t i, std::size_t j) { return parts_[i * corners_.size() + j]; }

    bool is_free(u32 a, u32 b) const {
        return surface_.fans.left_of(a, b) == nobody && surface_.fans.left_of(b, a) == nobody;
    }

    void solve(std::size_t i, std::size_t j) {
        Part best{impossible, 0, Vec3::Zero()};
        const bool is_side = i == 0 && j + 1 == corners_.size();
        if (is_side || is_free(corners_[i], corners_[j]))
            for (std::size_t k = i + 1; k < j; ++k) {
                const double others = part(i, k).cost + part(k, j).cost;
                if (others < best.cost) try_apex(i, k, j, others, best);
            }
        part(i, j) = best;
    }

    void try_apex(std::size_t i, std::size_t k, std::size_t j, double others, Part& best) {
        const auto& p = surface_.positions;
        const Triangle triangle{corners_[i], corners_[k], corners_[j]};
        const Vec3 u = p[triangle[1]] - p[triangle[0]], w = p[triangle[2]] - p[triangle[0]];
        const Vec3 across = u.cross(w);
        const double twice_area = across.norm();
        if (!(twice_area > 0) || !(others + twice_area < best.cost)) return;
        const double squared = squared_circle(u.squaredNorm(), w.squaredNorm(), (w - u).squaredNorm(), twice_area);
        if (squared > limits_.largest_circle * limits_.largest_circle) return;
        const Vec3 normal = across / twice_area;
        if (folds(i, k, normal) || folds(k, j, normal) || (i == 0 && j + 1 == corners_.size() && folds(j, i, normal)))
            return;
        if (near_.meet(surface_, triangle)) return;
        best = {others + twice_area, k, normal};
    }

    /// Back on what lies beyond the chord: the surface, or the part filled before.
    bool folds(std::size_t i, std::size_t j, const Vec3& normal) {
        const u32 from = corners_[j], to = corners_[i], third = surface_.fans.left_of(from, to);
        if (third != nobody) return surface_.facet_normal(from, to, third).dot(normal) < limits_.bend_cosine;
        return part(i, j).normal.dot(normal) < limits_.bend_cosine;
    }

    void collect(std::size_t i, std::size_t j, std::vector<Triangle>& triangles) {
        if (j - i < 2) return;
        const std::size_t k = part(i, j).apex;
        collect(i, k, triangles);
        collect(k, j, triangles);
        triangles.push_back({corners_[i], corners_[k], corners_[j]});
    }

    const Surface& surface_;
    const NearTriangles& near_;
    const std::vector<u32>& corners_;
    FillLimits limits_;
    std::vector<Part> parts_;
};

}  // namespace

bool can_be_filled(const Surface& surface, const std::vector<u32>& corners, const FillLimits& limits) {
    const NearTriangles nothing;
    return !Filling(surface, nothing, corners, limits).find().empty();
}

std::vector<Triangle> cheapest_filling(const Surface& surface, NearTriangles& near, const std::vector<u32>& corners,
                                       const FillLimits& limits) {
    // Seldom is anything in the way, and when there is no filling at all there is none past it either.
    const NearTriangles nothing;
    std::vector<Triangle> triangles = Filling(surface, nothing, corners, limits).find();
    if (triangles.empty()) return {};
    near.gather_round(surface, corners);
    if (std::ranges::any_of(triangles, [&](const Triangle& t) { return near.meet(surface, t); }))
        triangles = Filling(surface, near, corners, limits).find();
    for (std::size_t i = 0; i < triangles.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (meet(surface.positions, triangles[i], triangles[j])) return {};
    return triangles;
}

}  // namespace scanmill::growing
