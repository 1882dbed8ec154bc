// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Triangulates points one after the other: each new point joins the clusters near it and continues their mesh.
///
/// Points come slice after slice (insertion_order.hpp) and form clusters on two levels (clusters.hpp). A new point
/// continues the mesh of its cluster at the nearest boundary edge, with edges up to two thirds of max_edge, splits the
/// triangle that it lies over, or waits (triangulation.hpp). Then the result is completed: points that wait and
/// boundaries that face each other are tried again with edges up to max_edge and relaxed limits, vertices keep one fan
/// of triangles, small and narrow loops are closed, and edges are flipped where that makes better triangles.
///
/// Source: Sangveraphunsiri, Srirakulchai 2006, made robust.

#include <array>
#include <optional>
#include <vector>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct ClusterMeshParams {
    enum class Axis { x, y, z };
    enum class InPlane {
        paper,   ///< by distance to the slicing plane
        nearest  ///< next comes the point nearest to an inserted one
    };
    /// Every edge of the mesh is shorter. Above 0; absent: 2.5 times the median distance of a point to the nearest
    /// other one, and at least 2.3 times the largest value of the column `bin-size`.
    std::optional<Length> max_edge;
    /// Slicing planes are perpendicular to it.
    Axis axis = Axis::x;
    /// Distance of the slicing planes; above 0. Absent: a quarter of max_edge, or as much as makes 1e9 slices.
    std::optional<Length> slice;
    InPlane in_plane = InPlane::nearest;
    /// Three numbers, not all 0. Components that are flat face to its side.
    std::vector<double> up{0, 0, 1};
    /// Up to this angle between the normals of a new triangle and of the triangle whose edge it continues, the new one
    /// is created; above, neighbours decide. Above 0, at most 180 degrees.
    Angle max_normal_angle = Angle::degrees(90);
    /// Beyond max_normal_angle the surface continues only if a neighbour of that triangle, and the triangle of the
    /// edge between the two and the new point, differ by less. Above 0, at most 180 degrees.
    Angle neighbour_angle = Angle::degrees(90);
    /// A point lies over a triangle, and splits it, if it is inside, seen along the normal, and not higher than the
    /// longest edge times the tangent of this. Above 0, below 90 degrees.
    Angle overlap_angle = Angle::degrees(10);
};

struct ClusterMeshResult {
    /// Over the used points, in input order with their columns, and the columns `cluster-1` and `cluster-2`, which
    /// replace older ones with a warning.
    TriangleMesh mesh;
    /// Per vertex its row in the cloud, ascending.
    Array<u32> rows;
    double max_edge = 0;
    /// How many distinct points were inserted by case 1 … 4.
    std::array<std::size_t, 4> cases{};
    /// Points that split a triangle, and points that waited because the surface is discontinuous at their nearest edge.
    std::size_t splits = 0, extra = 0;
    /// Clusters of level 1, also of unused points.
    std::size_t clusters = 0;
    std::size_t components = 0, loops = 0, boundary_edges = 0;
    /// Loops closed and triangles removed in the end, and edges flipped.
    std::size_t closed_holes = 0, removed_triangles = 0, flips = 0;
    /// Rows without a vertex: repeats of an earlier row, and distinct points in no triangle.
    std::size_t duplicates = 0, unused_points = 0;
};

/// Inserts every distinct point once, in the order of insertion_order.hpp, and completes the mesh.
///
/// The points should be thinned to even density, because one max_edge is used everywhere. If several rows have one
/// position, the first is used. The column `bin-size` counts only if max_edge is absent; a warning is given if its
/// values differ by more than a factor of two.
///
/// Throws Error with numbers and a way out: fewer than three distinct points, all on one line, a NaN or infinite
/// coordinate, a parameter out of range, a max_edge below the distance to the nearest point for most points, more than
/// 1,000 points within max_edge of a point, a slice that makes more than 1e9, and no triangle at all.
///
/// Post: an oriented manifold: every edge is in one triangle, or in two with opposite half-edges; the triangles of
/// every vertex form one fan. Every edge is shorter than max_edge. No two triangles intersect other than in common
/// corners and edges. Equal values of `cluster-1` are the connected components of the graph of points at a distance
/// below max_edge; the corners of a triangle have equal values of `cluster-2`. Closed components face outwards, as do
/// open ones that bulge; flat ones face to the side of `up`. The sharp edges of the mesh are empty. Ties: by position
/// along a space-filling curve, so the mesh depends neither on the order of the rows, up to numbering, nor on the
/// number of threads.
///
/// Cost: O(n log n) time for a max_edge of a few spacings, about 10 µs per point; about 650 bytes per point beside the
/// result. The insertion uses one thread.
///
/// Metrics: see plugin.cpp. Warns when more than half a percent of the points are unused. Doubts: more than 2 % unused,
/// and doubts_about_surface().
ClusterMeshResult cluster_mesh(const PointCloud& cloud, const ClusterMeshParams& params, Context& context);

}  // namespace scanmill
