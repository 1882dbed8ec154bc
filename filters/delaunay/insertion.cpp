// SPDX-License-Identifier: GPL-3.0-or-later
#include "delaunay/insertion.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>
#include <vector>

#include "scanmill/base/parallel.hpp"

namespace scanmill {

namespace {

/// Fewer points are not worth a second thread. Of more, the first are inserted by one: as long as there are few cells,
/// every insertion touches most of them.
constexpr std::size_t least_for_threads = 10'000, alone = 1000;
constexpr int lock_boxes_per_axis = 64;

/// Waits before the next of several tries at what another thread is busy with.
void wait_after(int failures) {
    constexpr int short_waits = 30;
    if (failures < short_waits)
        for (int i = 0; i < 256 << std::min(failures, 6); ++i) std::atomic_signal_fence(std::memory_order_seq_cst);
    else  // that thread may itself be waiting for a core, perhaps for this one
        std::this_thread::sleep_for(std::chrono::microseconds(50));
}

template <class Triangulation>
class Insertion {
    static constexpr bool is_shared = std::is_same_v<Triangulation, SharedTriangulation>;
    using Vertex = typename Triangulation::Vertex_handle;

public:
    Insertion(Triangulation& triangulation, std::span<const PointRow> points, Context& context)
        : triangulation_(triangulation),
          points_(points),
          context_(context) {}

    Array<u32> run() {
        if constexpr (is_shared) {
            // Locking needs cells: a scan may begin with points of one plane.
            std::size_t begin = 0;
            do {
                const std::size_t end = std::min(begin + alone, points_.size());
                insert_alone(begin, end);
                begin = end;
            } while (triangulation_.dimension() < 3 && begin < points_.size());
            insert_together(begin);
        } else {
            insert_alone(0, points_.size());
        }
        std::ranges::sort(duplicates_);
        return std::move(duplicates_);
    }

private:
    static constexpr std::size_t chunk = 256;

    void insert_alone(std::size_t begin, std::size_t end) {
        for_each_chunk(1, end - begin, chunk, [&](std::size_t first, std::size_t last) {
            insert(points_.subspan(begin + first, last - first), last_);
        });
    }

    /// All points from `begin` on.
    void insert_together(std::size_t begin)
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

    /// `last` is the vertex of the last point that this thread inserted: the next one is likely to be near it.
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

    /// False, and nothing has changed, when another thread is at work there.
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

    /// Lowers `value` to `candidate` if that is smaller; returns what it was.
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
    /// An insertion ended with an exception; its cells are half changed, and stay locked so that nobody enters them.
    std::atomic<bool> broken_ = false;
    std::mutex mutex_;
    std::size_t done_ = 0;
    Array<u32> duplicates_;
};

}  // namespace

bool is_worth_sharing(std::size_t points, unsigned threads) { return threads > 1 && points >= least_for_threads; }

Array<u32> insert_all(SharedTriangulation& triangulation, std::span<const Vec3> positions, Context& context) {
    const std::vector<PointRow> points = insertion_order(positions, context.threads());
    return Insertion(triangulation, points, context).run();
}

Array<u32> insert_all(LoneTriangulation& triangulation, std::span<const Vec3> positions, Context& context) {
    const std::vector<PointRow> points = insertion_order(positions, context.threads());
    return Insertion(triangulation, points, context).run();
}

}  // namespace scanmill
