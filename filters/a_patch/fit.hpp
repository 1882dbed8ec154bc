// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Fits the slopes of a hull's edges to data points. The vertices and their gradients stay as they are; normal_fit.hpp
/// fits the gradients before. The gradients of neighbouring tetrahedra stay equal, because they are
/// equal for any slopes.
///
/// Source: Bernardini, Bajaj, Chen, Schikore 1997, section 5; the distance is that of Taubin 1991, "Estimation of
/// planar curves, surfaces, and nonplanar space curves defined by implicit equations".

#include <functional>
#include <optional>
#include <vector>

#include "a_patch/weights.hpp"
#include "scanmill/geometry/patches/a_patch.hpp"

namespace scanmill::a_patches {

/// Points with the tetrahedra that contain them; ordered by tetrahedron, then by row.
struct LocatedPoints {
    struct Point {
        u32 row;  ///< row among the given points
        u32 tet;  ///< if two rows share the tetrahedron, the row whose function is F at the point
        Barycentric at;
    };
    std::vector<Point> points;
    std::size_t left_out = 0;  ///< number of points in no tetrahedron
};

/// Cost: O(log n) per point, 2 to 4 us.
LocatedPoints locate(const PatchComplex& patches, std::span<const Vec3> points, Execution& execution);

struct FitParams {
    double regularisation = 1e-3;  ///< the smallest weight that an edge can choose, above 0
};

struct FitResult {
    Weights weights;
    /// The median over the edges of the weights used; empty if nothing was fitted.
    std::optional<double> regularisation;
};

/// Minimises, over the components of the slopes that the vertices leave free,
///     sum of (F / |grad F|)² over the points + s · regularisation · |change|².
/// s is the mean diagonal element of the first sum's matrix. Points whose distance is above 3
/// times the median near their triangle count less (Huber). Derivatives are taken at the foot points. The minimisation
/// is done 3 times; each time, gradients, foot points and the points' weights follow from the last solution.
///
/// At each apex, the function f(a, b, .) of an edge keeps at least a tenth of its default value. If a tetrahedron gets
/// more weights of a wrong sign than with the default slopes, the changes of the edges around it are reduced.
///
/// Each edge chooses its `regularisation`: the given value times a power of 10, below 200. It chooses the one with
/// which each half of the points best predicts the distances of the other half near the edge. Therefore few or noisy
/// points change the slopes less.
///
/// Sets the slopes of `hull` and returns its new weights. Pre: `weights` are those of `hull` before. Slopes
/// without points near them keep their bits. Bytes do not depend on the number of threads.
/// Cost: about 1 us per point and 100 us per triangle.
///
/// `violating_triangles` returns triangles beside which a surface is not sound: the changes of their edges are reduced.
FitResult fit(Hull& hull, Weights weights, const LocatedPoints& points, Curvature curvature, const FitParams& params,
              const std::function<std::vector<u32>(const PatchComplex&)>& violating_triangles, Execution& execution);

/// Unsigned distances of the located points, in their order.
struct PointDistances {
    /// Distance from the foot point, which is sought from the nearest point of the mesh. It is |F| / |grad F| where
    /// that search crosses the boundary of an open surface.
    std::vector<double> to_surface;
    std::vector<double> to_mesh;
};
/// Measures the distances of the located points from the surface and from the mesh.
PointDistances distances(const Hull& hull, const PatchComplex& patches, std::span<const Vec3> points,
                         const LocatedPoints& located, Execution& execution);

}  // namespace scanmill::a_patches
