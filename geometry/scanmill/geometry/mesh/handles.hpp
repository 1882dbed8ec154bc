// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Handles of a closed surface, and those that the scanned object hardly has.
///
/// A surface that is made from points gets handles where outliers or noise join two sheets, and loses tunnels where
/// they are filled. A real handle is wide beside the distance of the points that show it; a false one is a few edges
/// wide.
///
/// Source: Erickson and Whittlesey 2005, "Greedy optimal homotopy and homology generators".

#include <functional>
#include <string>
#include <vector>

#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// A closed walk along edges that does not separate the surface.
struct HandleLoop {
    double length = 0;
    /// Starts at the vertex nearest the component's lowest vertex; the last one is a neighbour of the first.
    std::vector<u32> vertices;
};

/// Two loops for each handle (2 × genus). Every loop consists of two shortest paths from a vertex and an edge that
/// joins their ends; together the loops are the shortest ones with this property for the lowest vertex of each
/// component.
///
/// Pre:  topology().closed; finite positions.
/// Ties: of equally long paths the one by the lower vertex, of equally long loops the one with the lower edge.
/// Cost: O(n log n) time, about 100 bytes per triangle.
std::vector<HandleLoop> handle_loops(const TriangleMesh& mesh);

/// A sentence if the surface has handles that the object hardly has; empty otherwise, and for a surface that is not
/// closed. A loop counts if it is shorter than 12 spacings (edge_spacing()). The surface is doubtful
/// - if more than one loop counts for each 10,000 vertices, and more than one at all, or
/// - if a loop that counts passes through an invented vertex.
///
/// `is_invented`: whether a vertex is on a surface that no point shows. Without it, a vertex is invented if one of its
/// triangles has a value other than 0 in the face column `filled`.
std::vector<std::string> doubts_about_handles(const TriangleMesh& mesh,
                                              const std::function<bool(u32 vertex)>& is_invented = {});

}  // namespace scanmill
