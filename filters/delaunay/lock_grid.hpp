// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Locks boxes of space, for threads that change one triangulation.

#include <CGAL/Bbox_3.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

#include "scanmill/data/array.hpp"

namespace scanmill {

/// A grid over space: threads lock its boxes before they change cells there. A failed attempt to lock returns at once.
/// CGAL's Spatial_lock_grid_3 would spin by default, for a whole time slice when the owner of the lock waits for a
/// core; it also looks the thread up in a hash table at every call, which took a tenth of a tetrahedralisation.
///
/// The members whose names CGAL gives are those that its triangulations call. A thread uses one grid at a time.
class LockGrid {
public:
    LockGrid(const CGAL::Bbox_3& space, int boxes_per_axis)
        : space_(space),
          boxes_per_axis_(boxes_per_axis),
          owners_(std::make_unique<std::atomic<u32>[]>(
              static_cast<std::size_t>(boxes_per_axis * boxes_per_axis * boxes_per_axis))) {
        for (int axis = 0; axis < 3; ++axis)
            boxes_per_length_[axis] = boxes_per_axis / (space.max(axis) - space.min(axis));
    }

    const CGAL::Bbox_3& get_bbox() const { return space_; }

    /// Locks the box of the point; true if this thread has it. Pre: radius is 0.
    template <class Point>
    bool try_lock(const Point& point, [[maybe_unused]] int radius = 0) {
        Thread& thread = this_thread();
        const std::size_t box = box_of(point);
        u32 owner = owners_[box].load(std::memory_order_relaxed);
        if (owner == thread.number) return true;
        if (owner != nobody || !owners_[box].compare_exchange_strong(owner, thread.number, std::memory_order_acquire))
            return false;
        thread.locked.push_back(box);
        return true;
    }
    template <class Point>
    bool is_locked_by_this_thread(const Point& point) const {
        return owners_[box_of(point)].load(std::memory_order_relaxed) == this_thread().number;
    }
    void unlock_all_points_locked_by_this_thread() { unlock_all_but(none); }
    template <class Point>
    void unlock_all_tls_locked_locations_but_one_point(const Point& point) {
        unlock_all_but(box_of(point));
    }

private:
    static constexpr u32 nobody = 0;
    static constexpr std::size_t none = ~std::size_t(0);

    struct Thread {
        u32 number;
        u64 grid;
        std::vector<std::size_t> locked;
    };
    Thread& this_thread() const {
        static std::atomic<u32> threads = nobody;
        thread_local Thread thread{++threads, number_, {}};
        if (thread.grid != number_) {  // a thread that failed may have left locks in another grid
            thread.grid = number_;
            thread.locked.clear();
        }
        return thread;
    }
    static u64 next_number() {
        static std::atomic<u64> grids = 0;
        return ++grids;
    }

    template <class Point>
    std::size_t box_of(const Point& point) const {
        std::size_t box = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const double at = (point[axis] - space_.min(axis)) * boxes_per_length_[axis];
            box = box * static_cast<std::size_t>(boxes_per_axis_) +
                  static_cast<std::size_t>(std::clamp(static_cast<int>(at), 0, boxes_per_axis_ - 1));
        }
        return box;
    }
    void unlock_all_but(std::size_t kept) {
        Thread& thread = this_thread();
        bool keeps = false;
        for (const std::size_t box : thread.locked)
            if (box == kept)
                keeps = true;
            else
                owners_[box].store(nobody, std::memory_order_release);
        thread.locked.clear();
        if (keeps) thread.locked.push_back(kept);
    }

    u64 number_ = next_number();
    CGAL::Bbox_3 space_;
    int boxes_per_axis_;
    double boxes_per_length_[3];
    /// The number of the thread that has locked a box, or nobody.
    std::unique_ptr<std::atomic<u32>[]> owners_;
};

}  // namespace scanmill
