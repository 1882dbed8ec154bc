// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Makes CGAL allocate the vertices and cells of our triangulations from slabs. CGAL's data structure fixes the type of
/// its containers, so this file specialises those types for our elements: the same containers with another allocator.
///
/// Include it before any triangulation type is used.

#include <CGAL/Compact_container.h>
#include <CGAL/Concurrent_compact_container.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>
#include <tbb/scalable_allocator.h>

#include "delaunay/slab_allocator.hpp"

namespace scanmill {

/// The number of a finite cell, or TetMesh::outside_hull.
struct CellNumber {
    u32 number;
};

/// The smallest of the input rows at a vertex's position.
struct FirstRow {
    static constexpr u32 none = 0xffff'ffff;
    u32 row = none;
};

template <class Kernel, class Base>
using NumberedCellBase = CGAL::Triangulation_cell_base_with_info_3<CellNumber, Kernel, Base>;
template <class Kernel, class Base>
using RowVertexBase = CGAL::Triangulation_vertex_base_with_info_3<FirstRow, Kernel, Base>;

template <class Element>
using LoneContainer = CGAL::Compact_container<Element, SlabAllocator<Element>>;
template <class Element>
using SharedContainer = CGAL::Concurrent_compact_container<Element, SlabAllocator<Element>>;

}  // namespace scanmill

namespace CGAL {

template <class Kernel, class Base>
class Compact_container<scanmill::NumberedCellBase<Kernel, Base>, Default, Default, Default>
    : public scanmill::LoneContainer<scanmill::NumberedCellBase<Kernel, Base>> {};
template <class Kernel, class Base>
class Compact_container<scanmill::RowVertexBase<Kernel, Base>, Default, Default, Default>
    : public scanmill::LoneContainer<scanmill::RowVertexBase<Kernel, Base>> {};

// It allocates memory under its own lock.
template <class Kernel, class Base>
class Concurrent_compact_container<scanmill::NumberedCellBase<Kernel, Base>,
                                   tbb::scalable_allocator<scanmill::NumberedCellBase<Kernel, Base>>>
    : public scanmill::SharedContainer<scanmill::NumberedCellBase<Kernel, Base>> {};
template <class Kernel, class Base>
class Concurrent_compact_container<scanmill::RowVertexBase<Kernel, Base>,
                                   tbb::scalable_allocator<scanmill::RowVertexBase<Kernel, Base>>>
    : public scanmill::SharedContainer<scanmill::RowVertexBase<Kernel, Base>> {};

}  // namespace CGAL
