// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Where the surface faces at every place, before there is a surface.

#include <vector>

#include "region_grow/distinct_points.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::growing {

/// Of the neighbours' variance, across their plane: above this a place lies at an edge or a tip. At an edge of 90
/// degrees it is a tenth; noise of 0.3 spacings makes 0.03.
inline constexpr float rough = 0.04f;

struct PointNormals {
    /// Unit length. Of principal components the sign is arbitrary.
    Array<Vec3> directions;
    /// How far the neighbours are from one plane: their variance across it over their whole variance, 0 to 1/3.
    Array<float> roughness;
};

/// The direction in which a place and its 12 nearest neighbours vary least, as scatter_of() has it. Cost: linear.
PointNormals principal_normals(const Samples& samples, const Neighbourhoods& neighbourhoods, unsigned threads);

// Normals that came with the points.

struct GivenNormals {
    /// They tell the sides: a triangle must agree with their sign.
    bool signs_count = false;
    /// Where the signs do not count: per place the given normal, zero where there is none. Else empty.
    Array<Vec3> doubtful;
};

/// Replaces the principal normals by those of the column `normal`, where there is one. Of rows in one place the normal
/// first by x, y, z counts. A place without one that is finite and not zero keeps its principal one, turned to the
/// given ones near it; how many such places there were is warned of. Signs do not count where more than half of the
/// places have none, and when they are mixed as opposed_normals() tells; a warning says so. Throws Error when the
/// column is not three numbers per row, and when more than three quarters of the normals are more than 60 degrees from
/// the principal ones, along directions in which their neighbours lie; of more than a quarter it warns. Cost: linear.
GivenNormals take_given_normals(const PointCloud& cloud, const Samples& samples, const Neighbourhoods& neighbourhoods,
                                PointNormals& normals, Context& context);

/// By more than 154 degrees.
bool are_opposed(const Vec3& one, const Vec3& other);

/// Places whose normal and that of their nearest neighbour are opposed: by more than 154 degrees, which neither ridges
/// nor grooves down to 26 degrees make of it.
struct OpposedNormals {
    std::size_t count = 0;
    /// Of these, such whose neighbour lies behind them, as on the other side of a sheet; in front, as across a slit;
    /// and nearly in their plane (within 17 degrees), as of one surface.
    std::size_t behind = 0, in_front = 0, beside = 0;

    /// Nearly all on the same side: they are the other side of a thin sheet or slit.
    bool are_on_one_side() const { return 4 * (behind > in_front ? behind : in_front) > 3 * count; }
    /// More than one place in a hundred is opposed to one beside it, and not for being thin.
    bool are_mixed(std::size_t places) const { return 100 * beside > places && !are_on_one_side(); }

    /// Pre: the place's normal and the other's are opposed.
    void add(const Vec3& normal, const Vec3& offset_of_other);
};

/// `given`: which places have one. Neighbours without are passed over. Cost: linear.
OpposedNormals opposed_normals(const Samples& samples, const Neighbourhoods& neighbourhoods,
                               const Array<Vec3>& directions, const std::vector<bool>& given);

}  // namespace scanmill::growing
