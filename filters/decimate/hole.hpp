// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The polygon that the removal of a vertex leaves, on one side of a feature line or all around, and its best
/// triangulation.

#include <array>
#include <functional>
#include <vector>

#include "decimate/surface.hpp"

namespace scanmill::decimating {

class Hole {
public:
    static constexpr u32 most_corners = 64;

    /// Corners are ring positions, counter-clockwise seen from `up`.
    struct Corner {
        u32 ring_position, vertex;
        Vec3 position;
    };
    std::vector<Corner> corners;
    /// Unit mean normal of the triangles that the triangulation replaces.
    Vec3 up = Vec3::Zero();
    /// Whether the edge from the last corner to the first is new (a feature edge), and not one of the ring.
    bool is_closed_by_new_edge = false;
    /// Sine of the least angle allowed.
    double angle_sine = 0;
    /// Numbers of the points to be assigned to its triangles.
    std::vector<u32> points;

    /// Finds the triangulation of least cost; false if none is within the limits.
    bool triangulate(const Surface& surface, const Limits& limits);

    /// Results: positions in `corners`, ascending.
    std::vector<std::array<u32, 3>> triangles;
    std::vector<SignedErrors> errors;  ///< by triangle, of its points and of the paths at its new edges
    std::vector<u32> owners;  ///< by point: the triangle

private:
    struct Chord {
        SignedErrors path;
        bool is_known = false, is_possible = false;
    };
    bool is_possible(const Surface& surface, const Limits& limits, u32 i, u32 j);
    void find_sides(const Surface& surface);
    /// Cost of a triangle, infinite beyond the limits.
    double cost(const Limits& limits, u32 i, u32 k, u32 j, SignedErrors& errors) const;
    void collect(const Limits& limits, u32 i, u32 j);

    std::size_t index(u32 i, u32 j) const { return i * corners.size() + j; }
    std::vector<Chord> chords_;
    std::vector<double> least_;
    std::vector<u32> middles_;
    std::size_t words_ = 0;
    std::vector<u64> left_;  ///< by chord, one bit per point: whether it is on the left
    std::vector<Vec3> positions_;  ///< of the points
};

}  // namespace scanmill::decimating
