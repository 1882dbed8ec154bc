// SPDX-License-Identifier: GPL-3.0-or-later
#include "delaunay/triangulate.hpp"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Regular_triangulation_3.h>
#include <CGAL/Regular_triangulation_cell_base_3.h>
#include <CGAL/Regular_triangulation_vertex_base_3.h>
#include <CGAL/Spatial_lock_grid_3.h>
#include <CGAL/Spatial_sort_traits_adapter_3.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/scalable_allocator.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <chrono>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/tets/canonical_cells.hpp"

namespace scanmill {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using PointRow = std::pair<Kernel::Point_3, u32>;

/// The number of a finite cell, or TetMesh::outside_hull.
struct CellNumber {
    u32 number;
};

/// The smallest of the input rows at a vertex's position.
struct FirstRow {
    static constexpr u32 none = 0xffff'ffff;
    u32 row = none;
};

template <class Base>
using NumberedCellBase = CGAL::Triangulation_cell_base_with_info_3<CellNumber, Kernel, Base>;
template <class Base>
using RowVertexBase = CGAL::Triangulation_vertex_base_with_info_3<FirstRow, Kernel, Base>;

// Types for triangulations without weights.
using VertexBase = RowVertexBase<CGAL::Triangulation_vertex_base_3<Kernel>>;
using CellBase = NumberedCellBase<CGAL::Delaunay_triangulation_cell_base_3<Kernel>>;
template <class Concurrency>
using DataStructure = CGAL::Triangulation_data_structure_3<VertexBase, CellBase, Concurrency>;
/// A spatial grid. A thread locks the boxes of the grid in which it changes cells. A failed attempt to lock returns at
/// once. CGAL's default would spin instead, for a whole time slice if the owner of the lock waits for a core.
using Locks = CGAL::Spatial_lock_grid_3<CGAL::Tag_non_blocking>;
using SharedTriangulation =
    CGAL::Delaunay_triangulation_3<Kernel, DataStructure<CGAL::Parallel_tag>, CGAL::Default, Locks>;
/// For one thread, without the cost of synchronisation.
using LoneTriangulation = CGAL::Delaunay_triangulation_3<Kernel, DataStructure<CGAL::Sequential_tag>>;

// Types for triangulations with weights. CGAL drops points that become hidden, so the hidden points are those in no
// cell at the end.
using WeightedCellBase = CGAL::Regular_triangulation_cell_base_3<Kernel, CGAL::Triangulation_cell_base_3<Kernel>,
                                                                 CGAL::Discard_hidden_points>;
using WeightedCell = NumberedCellBase<WeightedCellBase>;
using WeightedVertex = RowVertexBase<CGAL::Regular_triangulation_vertex_base_3<Kernel>>;
using Weighted =
    CGAL::Regular_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<WeightedVertex, WeightedCell>>;

/// The points and their rows in the order of insertion.
std::vector<PointRow> insertion_order(std::span<const Vec3> positions, unsigned threads) {
    std::vector<PointRow> points(positions.size());
    for_each_chunk(threads, positions.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            const Vec3& p = positions[row];
            points[row] = {Kernel::Point_3(p.x(), p.y(), p.z()), static_cast<u32>(row)};
        }
    });
    using Traits = CGAL::Spatial_sort_traits_adapter_3<Kernel, CGAL::First_of_pair_property_map<PointRow>>;
    const auto sort = [&]<class Concurrency>(Concurrency) {
        CGAL::spatial_sort<Concurrency>(points.begin(), points.end(), Traits());
    };
    if (threads > 1)
        within_thread_budget(threads, [&] { sort(CGAL::Parallel_tag()); });
    else
        sort(CGAL::Sequential_tag());
    return points;
}

/// With fewer points, a second thread does not save time. With more, one thread inserts the first `serial_points`,
/// because insertions touch most of the cells as long as there are few.
constexpr std::size_t least_for_threads = 10'000, serial_points = 1000;
constexpr int lock_boxes_per_axis = 64;

/// Waits before the next attempt to lock boxes that another thread has locked.
void wait_after(int failures) {
    constexpr int short_waits = 30;
    if (failures < short_waits)
        for (int i = 0; i < 256 << std::min(failures, 6); ++i) std::atomic_signal_fence(std::memory_order_seq_cst);
    else  // the other thread may itself be waiting for a core, perhaps for this one
        std::this_thread::sleep_for(std::chrono::microseconds(50));
}

/// Inserts all points into an empty triangulation.
template <class Triangulation>
class Insertion {
    static constexpr bool is_shared = std::is_same_v<Triangulation, SharedTriangulation>;
    using Vertex = typename Triangulation::Vertex_handle;

public:
    Insertion(Triangulation& triangulation, std::span<const PointRow> points, Context& context)
        : triangulation_(triangulation),
          points_(points),
          context_(context) {}

    /// Returns the rows whose position is exactly that of an earlier one, ascending.
    Array<u32> run() {
        if constexpr (is_shared) {
            // Locking needs cells. There are none while all inserted points of a scan lie in one plane.
            std::size_t begin = 0;
            do {
                const std::size_t end = std::min(begin + serial_points, points_.size());
                insert_serially(begin, end);
                begin = end;
            } while (triangulation_.dimension() < 3 && begin < points_.size());
            insert_in_parallel(begin);
        } else {
            insert_serially(0, points_.size());
        }
        std::ranges::sort(duplicates_);
        return std::move(duplicates_);
    }

private:
    static constexpr std::size_t chunk = 256;

    void insert_serially(std::size_t begin, std::size_t end) {
        for_each_chunk(1, end - begin, chunk, [&](std::size_t first, std::size_t last) {
            insert(points_.subspan(begin + first, last - first), last_);
        });
    }

    /// Inserts all points from `begin` on.
    void insert_in_parallel(std::size_t begin)
        requires is_shared
    {
        CGAL::Bbox_3 box;
        for (const auto& [point, row] : points_) box += point.bbox();
        Locks locks(box, lock_boxes_per_axis);
        triangulation_.set_lock_data_structure(&locks);
        tbb::enumerable_thread_specific<Vertex> last_of_thread(last_);
        for_each_chunk(context_.threads(), points_.size() - begin, chunk, [&](std::size_t first, std::size_t last) {
            insert(points_.subspan(begin + first, last - first), last_of_thread.local());
        });
        triangulation_.set_lock_data_structure(nullptr);
    }

    /// `last`: the vertex of the last point that this thread inserted. The next point is likely to be near it.
    void insert(std::span<const PointRow> points, Vertex& last) try {
        std::vector<u32> duplicates;
        for (const auto& [point, row] : points) {
            for (int failures = 0; !try_insert(point, last); ++failures) {
                if (broken_) return;
                wait_after(failures);
            }
            // Another thread may find the same vertex at the same time.
            const u32 other = exchange_with_smaller(last->info().row, row);
            if (other != FirstRow::none) duplicates.push_back(std::max(other, row));
        }
        finish_chunk(points.size(), duplicates);
    } catch (...) {
        broken_ = true;
        throw;
    }

    /// Returns false, without any change, if another thread has locked a box there.
    bool try_insert(const Kernel::Point_3& point, Vertex& last) {
        if constexpr (is_shared) {
            if (triangulation_.is_parallel()) return try_insert_locked(point, last);
        }
        last = triangulation_.insert(point, last);
        return true;
    }

    bool try_insert_locked(const Kernel::Point_3& point, Vertex& last)
        requires is_shared
    {
        bool locked = triangulation_.try_lock_vertex(last) && triangulation_.try_lock_point(point);
        if (locked) {
            const Vertex vertex = triangulation_.insert(point, last, &locked);
            if (locked) last = vertex;
        }
        triangulation_.unlock_all_elements();
        return locked;
    }

    /// Lowers `value` to `candidate` if `candidate` is smaller. Returns the old value.
    static u32 exchange_with_smaller(u32& value, u32 candidate) {
        const std::atomic_ref shared(value);
        u32 old = shared.load(std::memory_order_relaxed);
        while (candidate < old && !shared.compare_exchange_weak(old, candidate, std::memory_order_relaxed)) {
        }
        return old;
    }

    void finish_chunk(std::size_t count, std::span<const u32> duplicates) {
        const std::scoped_lock lock(mutex_);
        duplicates_.insert(duplicates_.end(), duplicates.begin(), duplicates.end());
        done_ += count;
        context_.check_cancelled();
        context_.progress(0.05 + 0.75 * static_cast<double>(done_) / static_cast<double>(points_.size()));
    }

    Triangulation& triangulation_;
    std::span<const PointRow> points_;
    Context& context_;
    Vertex last_;
    /// Whether an insertion ended with an exception. Its cells are inconsistent and stay locked, so that no thread
    /// enters them.
    std::atomic<bool> broken_ = false;
    std::mutex mutex_;
    std::size_t done_ = 0;
    Array<u32> duplicates_;
};

void insert_weighted(Weighted& triangulation, std::span<const PointRow> points, std::span<const double> weights,
                     std::span<const u8> is_duplicate, Context& context) {
    Weighted::Vertex_handle last;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i % 256 == 0) {
            context.check_cancelled();
            context.progress(0.25 + 0.55 * static_cast<double>(i) / static_cast<double>(points.size()));
        }
        const auto& [point, row] = points[i];
        if (is_duplicate[row]) continue;
        const Weighted::Vertex_handle vertex = triangulation.insert({point, weights[row]}, last);
        if (vertex == Weighted::Vertex_handle()) continue;  // hidden at once
        vertex->info().row = row;
        last = vertex;
    }
}

/// Number of finite cells, and handles to every `chunk`-th of them in container order.
template <class Triangulation>
struct NumberedCells {
    static constexpr std::size_t chunk = 1 << 13;

    std::size_t count = 0;
    std::vector<typename Triangulation::Cell_handle> chunks;
};

/// Numbers the finite cells; infinite cells get TetMesh::outside_hull.
template <class Triangulation>
NumberedCells<Triangulation> number_cells(Triangulation& triangulation) {
    NumberedCells<Triangulation> cells;
    const typename Triangulation::Vertex_handle infinite = triangulation.infinite_vertex();
    auto& container = triangulation.tds().cells();
    for (auto cell = container.begin(); cell != container.end(); ++cell) {
        if (cell->has_vertex(infinite)) {
            cell->info().number = TetMesh::outside_hull;
            continue;
        }
        if (cells.count % cells.chunk == 0) cells.chunks.push_back(cell);
        cell->info().number = static_cast<u32>(cells.count++);
    }
    return cells;
}

/// Prefetches the data of a cell that fill_cells() needs, which is scattered over memory.
template <class Cell>
void prefetch_round(Cell& cell) {
    for (int corner = 0; corner < 4; ++corner) {
        __builtin_prefetch(&cell.vertex(corner)->info());
        __builtin_prefetch(&cell.neighbor(corner)->info());
    }
}

/// Fills raw.cells and raw.neighbours. Pre: the triangulation has dimension 3.
template <class Triangulation>
void fill_cells(Triangulation& triangulation, std::size_t points, unsigned threads, RawTriangulation& raw) {
    const NumberedCells<Triangulation> cells = number_cells(triangulation);
    if (cells.count >= TetMesh::outside_hull)
        throw Error("the tetrahedralisation of {} points has {} cells; at most {} can be numbered", points, cells.count,
                    TetMesh::outside_hull - 1)
            .hint("voxel-thin keeps fewer points");
    constexpr std::size_t prefetched = 16;
    raw.cells.resize(cells.count);
    raw.neighbours.resize(cells.count);
    const auto last = triangulation.tds().cells().end();
    for_each_chunk(threads, cells.count, cells.chunk, [&](std::size_t begin, std::size_t end) {
        auto at = cells.chunks[begin / cells.chunk], soon = at;
        for (std::size_t ahead = 0; ahead < prefetched && soon != last; ++ahead, ++soon) prefetch_round(*soon);
        for (std::size_t c = begin; c < end; ++at) {
            if (soon != last) prefetch_round(*soon++);
            if (at->info().number == TetMesh::outside_hull) continue;
            Tetrahedron cell;
            for (int corner = 0; corner < 4; ++corner) cell[corner] = at->vertex(corner)->info().row;
            const std::array<int, 4> corners = canonical_corners(cell);
            for (int i = 0; i < 4; ++i) {
                raw.cells[c][i] = cell[corners[i]];
                raw.neighbours[c][i] = at->neighbor(corners[i])->info().number;
            }
            ++c;
        }
    });
}

template <class Triangulation>
RawTriangulation triangulate_in(std::span<const Vec3> positions, Context& context) {
    RawTriangulation raw;
    Triangulation triangulation;
    {
        const std::vector<PointRow> points = insertion_order(positions, context.threads());
        raw.duplicates = Insertion(triangulation, points, context).run();
    }
    raw.dimension = triangulation.dimension();
    if (raw.dimension == 3) fill_cells(triangulation, positions.size(), context.threads(), raw);
    return raw;
}

}  // namespace

RawTriangulation triangulate(std::span<const Vec3> positions, Context& context) {
    const bool is_shared = context.threads() > 1 && positions.size() >= least_for_threads;
    if (!is_shared) return triangulate_in<LoneTriangulation>(positions, context);
    RawTriangulation raw = triangulate_in<SharedTriangulation>(positions, context);
    // Frees the memory that the allocator of CGAL's concurrent containers would otherwise keep.
    ::scalable_allocation_command(TBBMALLOC_CLEAN_ALL_BUFFERS, nullptr);
    return raw;
}

RawTriangulation triangulate_weighted(std::span<const Vec3> positions, std::span<const double> weights,
                                      Array<u32> duplicates, Context& context) {
    assert(weights.size() == positions.size());
    RawTriangulation raw;
    raw.duplicates = std::move(duplicates);
    Array<u8> is_duplicate(positions.size());
    std::ranges::fill(is_duplicate, u8(0));
    for (u32 row : raw.duplicates) is_duplicate[row] = 1;

    Weighted triangulation;
    insert_weighted(triangulation, insertion_order(positions, context.threads()), weights, is_duplicate, context);
    raw.dimension = triangulation.dimension();
    if (raw.dimension == 3) fill_cells(triangulation, positions.size(), context.threads(), raw);
    return raw;
}

}  // namespace scanmill
