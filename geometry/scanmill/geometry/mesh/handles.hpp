// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Handles of a closed surface, and those that the scanned object hardly has.
///
/// A surface that is made from points gets handles where outliers or noise join two sheets, and loses tunnels where
/// they are filled. A real handle is wide beside the distance of the points that show it; a false one is a few edges
/// wide.
///
/// Source: Eppstein 2003, "Dynamic generators of topologically embedded graphs", for the trees of edges and of
/// triangles whose left-over edges are the generators.

#include <functional>
#include <string>
#include <vector>

#include "scanmill/base/execution.hpp"
#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// A closed walk along edges that does not separate the surface.
struct HandleLoop {
    double length = 0;
    /// The last one is a neighbour of the first.
    std::vector<u32> vertices;
};

/// Finds loops that do not separate the surface: for each vertex the shortest one through it, if it is shorter than
/// `longest`. Keeps the shortest loop of each homology class and sorts the result by length. The search ends at `most`
/// loops. A handle is missed if each vertex on its loops also has a shorter loop of another handle.
///
/// Pre:  topology().closed; finite positions.
/// Ties: of equally long loops of a class, that from the lower vertex.
/// Cost: O(n log n) time, and with 12 edges of equal length as `longest` about 50 µs for each edge of a cut that opens
/// all handles.
std::vector<HandleLoop> handle_loops(const TriangleMesh& mesh, double longest, std::size_t most, Execution& execution);

/// A sentence if the surface has handles that the object hardly has; empty otherwise, and for a surface that is not
/// closed. A loop counts if it is shorter than 12 spacings (edge_spacing()). The surface is doubtful
/// - if more than one loop counts for each 10,000 vertices, and more than two at all: a coarse mesh may have few edges
///   round its handles; or
/// - if a loop that counts passes through an invented vertex.
///
/// `is_invented`: whether a vertex is on a surface that no point shows. Without it, a vertex is invented if one of its
/// triangles has a value other than 0 in the face column `filled`.
std::vector<std::string> doubts_about_handles(const TriangleMesh& mesh, Execution& execution,
                                              const std::function<bool(u32 vertex)>& is_invented = {});
inline constexpr const char* sign_of_doubtful_handles =
    "the closed surface has small handles that the object hardly has (shorter than 12 spacings around)";

}  // namespace scanmill
