// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Filling CGAL's Delaunay triangulation with the points of a scan, on several threads.

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Spatial_lock_grid_3.h>

#include <span>

#include "delaunay/cell_containers.hpp"
#include "delaunay/insertion_order.hpp"
#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

using VertexBase = RowVertexBase<Kernel, CGAL::Triangulation_vertex_base_3<Kernel>>;
using CellBase = NumberedCellBase<Kernel, CGAL::Delaunay_triangulation_cell_base_3<Kernel>>;
template <class Concurrency>
using DataStructure = CGAL::Triangulation_data_structure_3<VertexBase, CellBase, Concurrency>;
/// A grid over space: threads lock its boxes before they change cells there. Whoever finds a lock taken gives up at
/// once; CGAL's default would wait for it by spinning, for a whole time slice when its owner waits for a core.
using Locks = CGAL::Spatial_lock_grid_3<CGAL::Tag_non_blocking>;
using SharedTriangulation =
    CGAL::Delaunay_triangulation_3<Kernel, DataStructure<CGAL::Parallel_tag>, CGAL::Default, Locks>;
/// For one thread: what makes insertions safe among threads costs time.
using LoneTriangulation = CGAL::Delaunay_triangulation_3<Kernel, DataStructure<CGAL::Sequential_tag>>;

// CGAL's own containers would serve too, and keep their memory: see cell_containers.hpp.
static_assert(std::is_base_of_v<SharedContainer<SharedTriangulation::Cell>,
                                SharedTriangulation::Triangulation_data_structure::Cell_range>);
static_assert(std::is_base_of_v<SharedContainer<SharedTriangulation::Vertex>,
                                SharedTriangulation::Triangulation_data_structure::Vertex_range>);
static_assert(std::is_base_of_v<LoneContainer<LoneTriangulation::Cell>,
                                LoneTriangulation::Triangulation_data_structure::Cell_range>);
static_assert(std::is_base_of_v<LoneContainer<LoneTriangulation::Vertex>,
                                LoneTriangulation::Triangulation_data_structure::Vertex_range>);

/// Several threads are worth what they cost.
bool is_worth_sharing(std::size_t points, unsigned threads);

/// Inserts all points into an empty triangulation and returns the rows that lie exactly on an earlier one, ascending.
/// Cells' infos are left alone. Throws Cancelled between insertions.
Array<u32> insert_all(SharedTriangulation& triangulation, std::span<const Vec3> positions, Context& context);
Array<u32> insert_all(LoneTriangulation& triangulation, std::span<const Vec3> positions, Context& context);

}  // namespace scanmill
