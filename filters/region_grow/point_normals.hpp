// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Where the surface faces at every place, before there is a surface.

#include "region_grow/neighbourhoods.hpp"

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

}  // namespace scanmill::growing
