// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Solids to sculpt, and a slow independent check of which cells may be removed.

#include <numbers>

#include "filters/sculpt/cases.hpp"

namespace scanmill::test {

inline SculptParams weighted(SculptWeight weight, bool lookahead = true) {
    SculptParams params;
    params.weight = weight;
    params.lookahead = lookahead;
    return params;
}

struct SculptCase {
    const char* name;
    TetMesh tets;
    SculptParams params;
};

inline std::vector<SculptCase> sculpt_cases() {
    const auto filled = [](std::uint64_t seed) { return hull_of(random_cube(60, seed)); };
    return {{"points that fill a cube", filled(1), {}},
            {"the same weighted", filled(1), weighted(SculptWeight::length)},
            {"others without look-ahead", filled(2), weighted(SculptWeight::none, false)},
            {"a lattice, full of ties", hull_of(lattice_cube(4)), {}},
            {"the hull of a torus", hull_of(poisson_torus(0.35)), {}},
            {"a block whose points are nearly in rows", hull_of(l_block_surface(2, 2, 4, 1e-5)), {}},
            {"a webbed block", solid_of(tets_of(l_block_surface(2, 2, 4, 2e-3))).tets, {}},
            {"two spheres",
             solid_of(tets_of(joined(fibonacci_sphere(80, 0.05), moved(fibonacci_sphere(80, 0.05), 1, Vec3(4, 0, 0)))),
                      many())
                 .tets,
             {}},
            {"a ball with bumps, smooth in places", solid_of(tets_of(fibonacci_sphere(400, 0.07))).tets, {}}};
}

/// A solid that loses cells, with the criteria of sculpt computed from its whole boundary every time.
class Carving {
public:
    Carving(const TetMesh& tets, SculptWeight weight)
        : tets_(tets),
          weight_(weight),
          inside_(tets.inside.begin(), tets.inside.end()),
          near_(tets.cells.size()),
          euler_(topology(mesh()).euler),
          largest_(largest_circumradius(mesh())) {
        std::ranges::fill(near_, u8(0));
    }

    TriangleMesh mesh() const { return mesh_of(tets_, inside_); }
    const Array<u8>& inside() const { return inside_; }
    bool has(u32 cell) const { return cell != TetMesh::outside_hull && inside_[cell] != 0; }
    double bending() const { return bending_of(mesh(), weight_); }

    /// Facets of the cell that bound the solid.
    std::vector<int> open_facets(u32 cell) const {
        std::vector<int> open;
        for (int i = 0; i < 4; ++i)
            if (!has(tets_.neighbours[cell][i])) open.push_back(i);
        return open;
    }
    /// Without the cell the boundary is closed and has the genus of the original solid.
    bool is_admissible(u32 cell) {
        inside_[cell] = 0;
        const MeshTopology found = topology(mesh());
        inside_[cell] = 1;
        return found.closed && found.euler == euler_;
    }
    /// Removing the cell uncovers a triangle with a larger circumradius than the original solid has.
    bool uncovers_too_large(u32 cell) const { return uncovers_larger(tets_, cell, open_facets(cell), largest_); }
    bool uncovers_thin(u32 cell) const {
        const std::vector<int> open = open_facets(cell);
        for (int facet = 0; facet < 4; ++facet)
            if (std::ranges::find(open, facet) == open.end() && smallest_angle(cell, facet) < thin) return true;
        return false;
    }
    bool may_flip(u32 cell) {
        return has(cell) && open_facets(cell).size() == 2 && !uncovers_too_large(cell) && !uncovers_thin(cell) &&
               is_admissible(cell);
    }
    /// Within two cells of an exposed point, or at an edge with a bending above 45°.
    bool may_smooth(u32 cell) const {
        const std::vector<int> open = open_facets(cell);
        return near_[cell] == 1 || unit_normal(cell, open[0]).dot(unit_normal(cell, open[1])) < std::cos(sharp);
    }

    void remove(u32 cell) {
        const bool exposes = open_facets(cell).size() == 1;
        inside_[cell] = 0;
        if (exposes) mark_near(cell);
    }
    /// Undoes remove() after a query.
    void put_back(u32 cell) { inside_[cell] = 1; }

private:
    static constexpr double thin = 0.1 * std::numbers::pi / 180 - 1e-9, sharp = std::numbers::pi / 4;

    /// All solid cells within two steps of the cell, through solid cells.
    void mark_near(u32 cell) {
        for (u32 first : tets_.neighbours[cell]) {
            if (!has(first)) continue;
            near_[first] = 1;
            for (u32 second : tets_.neighbours[first])
                if (has(second)) near_[second] = 1;
        }
    }
    std::array<Vec3, 3> corners(u32 cell, int facet) const {
        std::array<Vec3, 3> positions;
        for (std::size_t i = 0; i < 3; ++i) positions[i] = tets_.positions[tets_.cells[cell][outward_facet[facet][i]]];
        return positions;
    }
    Vec3 unit_normal(u32 cell, int facet) const {
        const auto [a, b, c] = corners(cell, facet);
        return (b - a).cross(c - a).normalized();
    }
    double smallest_angle(u32 cell, int facet) const {
        double least = std::numbers::pi;
        const std::array<Vec3, 3> p = corners(cell, facet);
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3 u = p[(i + 1) % 3] - p[i], v = p[(i + 2) % 3] - p[i];
            least = std::min(least, std::atan2(u.cross(v).norm(), u.dot(v)));
        }
        return least;
    }

    const TetMesh& tets_;
    SculptWeight weight_;
    Array<u8> inside_, near_;
    long euler_;
    double largest_;
};

}  // namespace scanmill::test
