// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The surface while it grows: its triangles, what every place is to it, and which way it faces there.

#include <vector>

#include "region_grow/fans.hpp"
#include "region_grow/neighbourhoods.hpp"
#include "region_grow/point_normals.hpp"

namespace scanmill::growing {

enum class PlaceState : u8 { unused, front, interior };

/// Which limits a triangle was formed under: 0 the given ones, 1 to 3 relaxed ones, 4 none (it closed a
/// small hole).
using Pass = u8;

/// Of 150 degrees: a triangle that bends back by more lies on its neighbour.
inline constexpr double least_bend_cosine = -0.8660254037844387;

struct Surface {
    Surface(const Samples& from, const Neighbourhoods& near, PointNormals facing, Array<double> search_radius,
            Array<double> usual_radius, bool oriented);

    const Samples& samples;
    const Neighbourhoods& neighbourhoods;
    const Array<Vec3>& positions;
    /// Of places on the surface they point to its upside; of others so when `oriented`.
    Array<Vec3> normals;
    Array<float> roughness;
    /// Per place.
    Array<double> search_radius;
    /// What it would be by the density alone: triangles that are small beside it are as the points lie there.
    Array<double> usual_radius;
    /// Normals came with the cloud: a triangle must agree with their sign.
    bool oriented;
    /// The power of two above the longest side of the box. Exact predicates take the point that lies this far along a
    /// unit normal: a shorter one would lose digits in the sum of point and normal.
    double axis_length;

    Fans fans;
    Array<PlaceState> states;
    Array<Triangle> triangles;
    Array<Pass> passes;

    bool is_used(u32 place) const { return states[place] != PlaceState::unused; }
    /// By given normals: they are of two sides of something.
    bool face_apart(u32 a, u32 b) const { return oriented && normals[a].dot(normals[b]) <= 0; }
    /// Whether from → to bounds the surface: a triangle on its left and none on its right.
    bool is_border(u32 from, u32 to) const {
        return fans.left_of(from, to) != nobody && fans.right_of(from, to) == nobody;
    }
    /// Where the border goes on from the vertex, surface on its left. Pre: it is on the border, with one fan.
    u32 next_on_border(u32 vertex) const;
    /// The unit normal of the triangle left of a → b whose third corner is c.
    Vec3 facet_normal(u32 a, u32 b, u32 c) const;

    /// Adds a → b → c. Pre: none of its three directed edges has a triangle.
    void add(const Triangle& triangle, Pass pass);
    /// Forgets triangles that the fans have no more, one for each. Of equal ones the oldest goes.
    void drop(std::vector<Triangle> taken_off);
};

}  // namespace scanmill::growing
