// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Fits the slopes of a hull's edges to data points, and makes them fair. This step keeps the vertices and their
/// gradients (normal_fit.hpp turns those before), and the equal gradients where tetrahedra meet, since these hold for
/// any slopes.
///
/// Source: Bernardini, Bajaj, Chen, Schikore 1997, section 5; the distance is that of Taubin 1991, "Estimation of
/// planar curves, surfaces, and nonplanar space curves defined by implicit equations".

#include <functional>
#include <optional>
#include <vector>

#include "a_patch/weights.hpp"
#include "scanmill/geometry/patches/a_patch.hpp"

namespace scanmill::a_patches {

/// Points with the tetrahedra they are in, ordered by tetrahedron, then as given.
struct LocatedPoints {
    struct Point {
        u32 row;  ///< row among the given points
        u32 tet;  ///< if two functions exist, the one that is F there
        Barycentric at;
    };
    std::vector<Point> points;
    std::size_t left_out = 0;  ///< in no tetrahedron
};

/// Cost: O(log n) per point, 2 to 4 us.
LocatedPoints locate(const PatchComplex& patches, std::span<const Vec3> points, Execution& execution);

struct FitParams {
    /// Whether the slopes follow the points; else they are only made fair.
    bool to_points = true;
    double fairing = 0;  ///< at least 0
    double regularisation = 1e-3;  ///< the least weight, above 0
};

struct FitResult {
    Weights weights;
    std::optional<double> regularisation;  ///< the median of the weights used, if one was
};

/// Minimises, over the components of the slopes that the vertices leave free,
///     sum of (F / |grad F|)² over the points + s · (regularisation · |change|² + fairing · unfairness),
/// where s is the mean diagonal element of the first sum's matrix; 1 without points. Points whose distance is above 3
/// times the median near their triangle count less (Huber). Derivatives are those at the foot points. Gradients, foot
/// points and the points' weights follow the solution, 3 times. Every function f(a, b, .) of an edge keeps at least a
/// tenth of its value at each apex; where more weights of a tetrahedron than by default get a wrong sign, the changes
/// of the edges around are reduced.
///
/// Each edge chooses its `regularisation`: the given value times a power of 10, below 200, with which each half of the
/// points best predicts the distances of the other half near the edge. Few or noisy points change the slopes less.
///
/// Sets the slopes of `hull` and returns its weights. `weights` are those of the hull as it is. Slopes without points
/// near them and without fairing keep their bits. Bytes do not depend on the number of threads.
/// Cost: about 1 us per point and 100 us per triangle.
///
/// `violating_edges`: the sharp edges at which a surface is not sound; none with the slopes of `hull` as it is.
FitResult fit(Hull& hull, Weights weights, const LocatedPoints& points, Curvature curvature, const FitParams& params,
              const std::function<std::vector<u32>(const PatchComplex&)>& violating_edges, Execution& execution);

/// Sum over the smooth inner edges of the squared difference between the edge's slope and the mean of the gradients of
/// its two triangles' quadrics at the middle of the edge, without the component along the edge; gradients have
/// length 1.
double unfairness(const Hull& hull, Curvature curvature);

/// Distances without sign.
struct PointDistances {
    /// To the foot point that is found from the nearest point of the mesh, or |F| / |grad F| where the way leads over
    /// the boundary of an open surface.
    std::vector<double> to_surface;
    std::vector<double> to_mesh;
};
/// Distances of the located points, in their order.
PointDistances distances(const Hull& hull, const PatchComplex& patches, std::span<const Vec3> points,
                         const LocatedPoints& located, Execution& execution);

}  // namespace scanmill::a_patches
