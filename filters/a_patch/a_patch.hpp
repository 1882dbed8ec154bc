// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A-patches: a smooth implicit surface through the vertices of a mesh, one cubic polynomial per tetrahedron.
///
/// Source: Bernardini, Bajaj, Chen, Schikore 1997, section 5, after Bajaj, Chen, Xu 1995, "Modeling with cubic
/// A-patches". The weights are derived anew through polar forms.

#include <optional>

#include "a_patch/repair.hpp"
#include "a_patch/weights.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct APatchParams {
    enum class Normals {
        /// given if the mesh has them, else points if there are any, else mesh; with points and `fit` turned so that
        /// the surface passes near them, see normal_fit.hpp
        automatic,
        given,  ///< the mesh's face column `corner-normals`; of several without a sharp edge between them the mean
        points,  ///< normal of a quadric through the vertex, fitted to the 25 nearest points on its side of sharp edges
        mesh  ///< the mean of the triangles' normals, exact for a mesh inscribed in a sphere
    };
    Normals normals = Normals::automatic;
    a_patches::Split split = a_patches::Split::always;
    /// Whether normals (`automatic`) and the slopes of edges are fitted to the points, if there are any.
    bool fit = true;
    /// Weight of the fairness against that of the fit, at least 0: see fit.hpp.
    double fairing = 0;
    /// Least weight of the changes of the slopes, 1e-6 to 1.
    double regularisation = 1e-3;
    a_patches::Curvature curvature = a_patches::Curvature::distance;
    /// Height of an apex over its triangle, as a multiple of the least one; 0.15 inradii are added. 1.05 to 3.
    double apex_factor = 1.5;
};

struct APatchResult {
    /// Its triangles are rows of `mesh`.
    PatchComplex patches;
    /// The input's triangles in their rows, some of them cut: the second parts follow, and the new vertices follow the
    /// input's. Its sharp edges, given and made; face column `corner-normals` as used, no other columns.
    TriangleMesh mesh;
    a_patches::Repairs repairs;
    std::size_t divided = 0;  ///< triangles with three tetrahedra per side
    std::vector<bool> pointed;  ///< by vertex of `mesh`, of those beyond its end false: whether it has a tip
    std::size_t raised = 0;  ///< see Weights::raised
    std::size_t inverted = 0;  ///< tetrahedra inside out; always 0
    /// The largest difference between the gradients on the two sides of a shared triangle, as a share of the larger
    /// one, at three points each.
    double c1_jump = 0;
    /// Edges, and weights over triangles, that allow a second sheet; 0: every line to an apex meets the surface once.
    std::size_t sign_violations = 0;
    std::size_t left_out = 0;  ///< points in no tetrahedron
    struct Distances {
        double rms = 0, p95 = 0, max = 0;
        double rms_to_mesh = 0;  ///< distance of the same points from `mesh`
    };
    std::optional<Distances> fit;  ///< distances of the points in tetrahedra; empty without points
    std::optional<double> regularisation;  ///< the median of the weights used, if the surface is fitted or made fair
    double crease_max = 0;  ///< the largest distance of a crease from its sharp edge
    double unfairness_before = 0, unfairness_after = 0;  ///< unfairness by default, and of the result; see fit.hpp
};

/// The surface F = 0 through the mesh's vertices, with a gradient of length 1 there, along the normal. F is negative
/// inside, positive outside, cubic in every tetrahedron, and has equal gradients where tetrahedra meet, except at sharp
/// edges: there the functions of the two triangles meet in a crease, a curve through the edge's ends. At a vertex every
/// fan of triangles between sharp edges has a normal of its own. Where `corner-normals` is zero, and one direction
/// suits all triangles, the surface has a singular point, as the apex of a cone.
///
/// A normal more than 84 degrees from that of one of its triangles is replaced by that of the mesh, or by the direction
/// nearest to all its triangles' normals. Where no direction suits, the most acute edges become sharp. Where tetrahedra
/// are inside out, or apexes do not fit below 0.45 of the distance to the next sheet, normals get that direction, too;
/// then the longest edges of the triangles are bisected, by a cubic through their ends and tangent planes, up to 7
/// times, while that repairs at least half of these triangles. Where a crease leaves the tetrahedra beside its edge,
/// the edge is bisected, in two rounds, unless less than half of these edges are repaired so; then the normals at its
/// ends are turned along the edges; then sharp edges become smooth that are below 30 degrees or between normals that
/// differ by less. Vertices where that does not help get a gradient of 0: the surface has a tip there. A crease that
/// leaves the tetrahedra between a tip and another vertex is made straight from the tip to the middle of its edge,
/// which is bisected. Where tips do not help, the surface follows the mesh: edges between such vertices become sharp
/// and straight. The same is done where a tessellation with tips intersects itself. Where a fit causes an intersection,
/// it is undone.
///
/// Pre:  a manifold, closed or open, of any number of components, consistently oriented, finite, with area in every
///       triangle, not cut along edges at one position. The surface ends at a boundary, with a warning. `points`, if
///       not null, are in the mesh's frame. Throws Error with numbers and a hint otherwise.
/// Post: `inverted` is 0. Every vertex of `mesh` is on the surface. A doubt if `sign_violations` is not 0, if the
///       points are farther from the surface than from the mesh (rms), if more than half of them are left out, if
///       parts of the surface intersect, as the mesh does, and if more than a tenth of the vertices are pointed.
/// Ties: of equally long edges the one with the lower vertices is bisected first; of equally acute edges it becomes
/// sharp. Bytes depend neither on the number of threads nor on the processor.
/// Cost: linear. One thread: 15 to 35 us and 4 kB per triangle; with points 5 us per point to locate and measure them,
/// and a fit's 3 us per point and 120 us and 6 kB per triangle, with noise and few points per triangle 540 us. Where
/// vertices get tips, tessellations to find intersections add up to 1 ms per triangle. Metrics and warnings: see
/// plugin.cpp.
APatchResult a_patch(const TriangleMesh& mesh, const PointCloud* points, const APatchParams& params, Context& context);

}  // namespace scanmill
