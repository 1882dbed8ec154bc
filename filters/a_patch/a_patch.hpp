// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A-patches: a smooth implicit surface through the vertices of a mesh, one cubic polynomial per tetrahedron.
///
/// Source: Bernardini, Bajaj, Chen, Schikore 1997, section 5, after Bajaj, Chen, Xu 1995, "Modeling with cubic
/// A-patches". The formulas of the weights are not taken from these papers: they are derived through polar forms.

#include <optional>

#include "a_patch/certificate.hpp"
#include "a_patch/joint_fit.hpp"
#include "a_patch/repair.hpp"
#include "a_patch/weights.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct APatchParams {
    enum class Normals {
        /// `given` if the mesh has the column `corner-normals`, else `points` if there are points, else `mesh`. With
        /// points and `fit`, fit_normals() then turns the normals so that the surface passes near the points.
        automatic,
        /// The mesh's face column `corner-normals`, averaged over corners that no sharp edge separates.
        given,
        /// The normal of a quadric through the vertex, fitted to the 25 nearest points on the same side of sharp edges.
        points,
        mesh  ///< the weighted mean of the triangles' normals, exact for a mesh inscribed in a sphere
    };
    Normals normals = Normals::automatic;
    a_patches::Split split = a_patches::Split::always;
    /// Whether the surface is fitted to the points.
    bool fit = true;
    enum class Interpolate {
        automatic,  ///< `no` if there are points and `normals` is `automatic`
        yes,  ///< the surface passes through the given vertices; see fit_normals() and fit()
        no  ///< vertices, normals and edge slopes are fitted together; see fit_jointly()
    };
    Interpolate interpolate = Interpolate::automatic;
    /// A factor on the weight of the bending that the fit finds, at least 0.
    double fairing = 1;
    /// The largest distance between the surface and the points that is not doubtful, above 0. A fit that does not
    /// interpolate also bisects triangles until the points are within it. If absent, it is not checked.
    std::optional<Length> max_error;
    /// If the fit interpolates: the smallest weight of the penalty on changes of the slopes, 1e-6 to 1.
    double regularisation = 1e-3;
    a_patches::Curvature curvature = a_patches::Curvature::distance;
    /// Height of an apex over its triangle, as a multiple of the smallest possible height; 1.05 to 3. A further 0.15
    /// inradii are added.
    double apex_factor = 1.5;
};

struct APatchResult {
    /// `patches.triangles` contains rows of `mesh`.
    PatchComplex patches;
    /// The mesh after fit and refinement. Each input triangle keeps its row, unless an edge was flipped; if it was cut,
    /// its first part is there, and the other parts are appended. New vertices follow the input's. The sharp edges are
    /// those of the surface. The only column is the face column `corner-normals`, with the normals that were used.
    TriangleMesh mesh;
    a_patches::Repairs repairs;
    std::size_t divided = 0;  ///< number of triangles with three tetrahedra per side
    /// By triangle of `mesh`: whether the surface is the triangle, because no smooth surface fits there.
    std::vector<bool> flat;
    /// Number of vertices of flat triangles, and of ends of open edges that were not sharp.
    std::size_t loosened = 0;
    std::size_t raised = 0;  ///< see Weights::raised
    std::size_t inverted = 0;  ///< number of tetrahedra that are inside out; always 0
    /// The largest difference between the gradients on the two sides of a shared triangle, relative to the longer
    /// gradient. It is measured at three points per triangle.
    double c1_jump = 0;
    /// Number of edges, and of weights over triangles, that allow a second sheet. If 0, every line from the mesh to an
    /// apex meets the surface once.
    std::size_t sign_violations = 0;
    std::size_t left_out = 0;  ///< number of points in no tetrahedron
    struct Distances {
        double rms = 0, p95 = 0, max = 0;
        double rms_to_mesh = 0;  ///< distance of the same points from `mesh`
    };
    std::optional<Distances> fit;  ///< distances of the points in tetrahedra; empty without points
    std::optional<a_patches::Certificate> certificate;  ///< with `max_error`
    double crease_max = 0;  ///< the largest distance of a crease from its sharp edge
    /// If the fit interpolates: the median over the edges of the weights used.
    std::optional<double> regularisation;
    std::optional<a_patches::JointFit> joint_fit;  ///< empty if nothing was fitted, or if the fit interpolates
};

/// Builds an implicit surface F = 0 through the vertices of a mesh. F is cubic in every tetrahedron, negative inside
/// the object and positive outside. At a vertex the gradient of F is the normal, which has length 1. With points, the
/// mesh is first fitted to them, or the normals and slopes are if the surface interpolates; see APatchParams.
///
/// The gradients agree where tetrahedra meet, except at sharp edges. There the functions of the two triangles meet in a
/// crease: a curve through the edge's ends. At a vertex, every fan of triangles between sharp edges has a normal of its
/// own. If `corner-normals` is zero at a vertex, and one direction suits all its triangles, the surface has a singular
/// point there, such as the apex of a cone.
///
/// Sharp edges whose sides agree become smooth: the normals on both sides differ by less than 30 degrees, and the edge
/// is not within a line of other sharp edges. A normal more than 73 degrees from that of one of its triangles is turned
/// towards it; if no direction is within 84 degrees of all of them, the most acute edges become sharp. Then two rules
/// repair places where no surface fits; see Construction.
///
/// Pre:  a consistently oriented manifold, closed or open, of any number of components. Coordinates are finite, every
///       triangle has an area, and no two boundary edges are at one position. `points`, if not null, are finite and in
///       the mesh's frame. Otherwise throws Error with numbers and a hint.
/// Post: `inverted` is 0. Every vertex of `mesh` is on the surface. The surface ends at a boundary of the mesh, with a
///       warning. The result is doubtful in these cases:
///       - `sign_violations` is not 0.
///       - The points are farther from the surface than from the mesh (rms), or more than half of them are left out.
///       - More than a tenth of the vertices have no point in their triangles, in a fit that moves vertices.
///       - A point is farther from the surface than `max_error`, or a position on the surface is farther from the
///         nearest point than `max_error` plus the spacing there.
///       - The surface intersects itself, because the mesh does.
///       - The surface follows the mesh at more than a tenth of the vertices.
///       - The mesh is closed and inside out.
/// Ties: among equally long edges, the one with the lower vertices is bisected first. Among equally acute edges, the
/// one with the lower vertices becomes sharp. Bytes depend neither on the number of threads nor on the processor.
/// Cost: linear without a fit. One thread takes 15 to 35 us and 4 kB per triangle; with creases that do not fit, up to
/// 400 us per triangle. To locate and measure the points takes 5 us per point. A fit adds 15 us per point and 500 us
/// per triangle; if it interpolates, 3 us per point and 120 to 540 us per triangle. With `max_error`, measuring adds 7
/// us per point, and up to six more fits follow. Metrics: see plugin.cpp.
APatchResult a_patch(const TriangleMesh& mesh, const PointCloud* points, const APatchParams& params, Context& context);

}  // namespace scanmill
