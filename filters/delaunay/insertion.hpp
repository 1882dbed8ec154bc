// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Filling CGAL's Delaunay triangulation with the points of a scan, on several threads.

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Spatial_lock_grid_3.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <span>

#include "delaunay/insertion_order.hpp"
#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

/// Of the input rows at a vertex's place the smallest.
struct FirstRow {
    static constexpr u32 none = 0xffff'ffff;
    u32 row = none;
};

using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<FirstRow, Kernel>;
using CellBase =
    CGAL::Triangulation_cell_base_with_info_3<u32, Kernel, CGAL::Delaunay_triangulation_cell_base_3<Kernel>>;
template <class Concurrency>
using DataStructure = CGAL::Triangulation_data_structure_3<VertexBase, CellBase, Concurrency>;
/// A grid over space: threads lock its boxes before they change cells there. Whoever finds a lock taken gives up at
/// once; CGAL's default would wait for it by spinning, for a whole time slice when its owner waits for a core.
using Locks = CGAL::Spatial_lock_grid_3<CGAL::Tag_non_blocking>;
using SharedTriangulation =
    CGAL::Delaunay_triangulation_3<Kernel, DataStructure<CGAL::Parallel_tag>, CGAL::Default, Locks>;
/// For one thread: what makes insertions safe among threads costs time, and memory that is kept for the next one.
using LoneTriangulation = CGAL::Delaunay_triangulation_3<Kernel, DataStructure<CGAL::Sequential_tag>>;

/// Several threads are worth what they cost.
bool is_worth_sharing(std::size_t points, unsigned threads);

/// Inserts all points into an empty triangulation and returns the rows that lie exactly on an earlier one, ascending.
/// Cells' infos are left alone. Throws Cancelled between insertions.
Array<u32> insert_all(SharedTriangulation& triangulation, std::span<const Vec3> positions, Context& context);
Array<u32> insert_all(LoneTriangulation& triangulation, std::span<const Vec3> positions, Context& context);

}  // namespace scanmill
