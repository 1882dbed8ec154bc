// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Triangulates points one after the other: each new point joins the clusters near it and continues their mesh.
///
/// Points are inserted slice after slice (insertion_order.hpp) and form clusters on two levels (clusters.hpp). A new
/// point does one of three things (triangulation.hpp):
/// - It continues the mesh of its cluster at the nearest boundary edge, with edges up to two thirds of max_edge.
/// - It splits the triangle that it lies over.
/// - It waits.
///
/// Then the mesh is completed:
/// - Waiting points, and boundaries that face each other, are tried again with edges up to max_edge and relaxed limits.
/// - Vertices keep one fan of triangles.
/// - Small and narrow loops are closed.
/// - Edges are flipped where that makes better triangles.
/// - Triangles that intersect others are removed.
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
        paper,  ///< by distance to the slicing plane
        nearest  ///< the point nearest to an inserted point comes next
    };
    /// Every edge of the mesh is shorter than this; above 0. If absent, it is 2.5 times the median distance of a point
    /// to its nearest other point, and at least 2.3 times the largest value of the column `bin-size`.
    std::optional<Length> max_edge;
    /// The slicing planes are perpendicular to this axis.
    Axis axis = Axis::x;
    /// Distance between the slicing planes; above 0. If absent, it is a quarter of max_edge, or more if that makes more
    /// than 1e9 slices.
    std::optional<Length> slice;
    InPlane in_plane = InPlane::nearest;
    /// Three numbers, not all 0: the direction that flat components face.
    std::vector<double> up{0, 0, 1};
    /// A new triangle is created if the angle between its normal and that of the triangle whose edge it continues is at
    /// most this. Otherwise neighbour_angle decides. Above 0, at most 180 degrees.
    Angle max_normal_angle = Angle::degrees(90);
    /// Beyond max_normal_angle, the surface continues only if a neighbour of the continued triangle agrees. The check
    /// triangle consists of the new point and the edge between these two triangles. The neighbour agrees if the angle
    /// between its normal and that of the check triangle is below this. Above 0, at most 180 degrees.
    Angle neighbour_angle = Angle::degrees(90);
    /// A point splits a triangle if it is inside the triangle, seen along the normal, and not too high above it. The
    /// limit is the longest edge times the tangent of this angle. Above 0, below 90 degrees.
    Angle overlap_angle = Angle::degrees(10);
};

struct ClusterMeshResult {
    /// The vertices are the used points, in input order and with their columns. The columns `cluster-1` and `cluster-2`
    /// replace older columns of these names, with a warning.
    TriangleMesh mesh;
    /// Per vertex: its row in the cloud, ascending.
    Array<u32> rows;
    double max_edge = 0;
    /// Number of distinct points inserted by cases 1 to 4 of clusters.hpp.
    std::array<std::size_t, 4> cases{};
    /// Number of points that split a triangle, and of points that waited because the surface is discontinuous at the
    /// nearest edge.
    std::size_t splits = 0, extra = 0;
    /// Number of clusters of level 1, including those of unused points.
    std::size_t clusters = 0;
    std::size_t components = 0, loops = 0, boundary_edges = 0;
    /// Number of loops closed, triangles removed and edges flipped during the completion.
    std::size_t closed_holes = 0, removed_triangles = 0, flips = 0;
    /// Number of rows without a vertex: repeats of an earlier row, and distinct points in no triangle.
    std::size_t duplicates = 0, unused_points = 0;
};

/// Inserts every distinct point once, in the order of insertion_order.hpp, and completes the mesh.
///
/// The points should be thinned to even density, because one max_edge is used everywhere. If several rows have one
/// position, the first is used. The column `bin-size` counts only if max_edge is absent. If its values differ by more
/// than a factor of two, a warning is given.
///
/// Throws Error with numbers in these cases:
/// - There are fewer than three distinct points, or all are on one line.
/// - A coordinate is NaN or infinite, or a parameter is out of range.
/// - max_edge is at most the distance to the nearest other point for most points.
/// - More than 1,000 other points are within max_edge of a point.
/// - `slice` makes more than 1e9 slices.
/// - There is no triangle at all.
///
/// Post: an oriented manifold. Every edge is in one triangle, or in two with opposite half-edges; the triangles of
/// every vertex form one fan. Every edge is shorter than max_edge. No two triangles intersect other than in common
/// corners and edges. Equal values of `cluster-1` are the connected components of the graph of points at a distance
/// below max_edge. The corners of a triangle have equal values of `cluster-2`. Closed components
/// face outwards, or inwards round a cavity. Open ones that bulge face outwards. Flat components face to the side of
/// `up`. `mesh.sharp_edges` is empty.
///
/// Ties are decided by the position along a space-filling curve. Therefore the mesh does not depend on the number of
/// threads. The order of the rows affects only the numbering.
///
/// Cost: O(n log n) time for a max_edge of a few spacings, about 10 µs per point; about 650 bytes per point beside the
/// result. The insertion uses one thread.
///
/// Metrics: see plugin.cpp. Warns if more than half a percent of the points are unused. Doubts: more than 2 % of the
/// points are unused, and doubts_about_surface().
ClusterMeshResult cluster_mesh(const PointCloud& cloud, const ClusterMeshParams& params, Context& context);

}  // namespace scanmill
