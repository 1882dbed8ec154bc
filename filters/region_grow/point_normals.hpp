// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Where the surface faces at every place, before there is a surface.

#include "region_grow/neighbourhoods.hpp"

namespace scanmill::growing {

struct PointNormals {
    /// Unit length. Of principal components the sign is arbitrary.
    Array<Vec3> directions;
    /// How far the neighbours are from one plane: their variance across it over their whole variance, 0 to 1/3.
    Array<float> roughness;
};

/// The direction across which a place and its neighbours vary least. Neighbours on one line leave it undetermined; any
/// direction across the line is returned then. Only sums, products, quotients and roots: the same bytes everywhere.
/// Cost: linear.
PointNormals principal_normals(const Samples& samples, const Neighbourhoods& neighbourhoods, unsigned threads);

}  // namespace scanmill::growing
