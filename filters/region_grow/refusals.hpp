// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What no surface can be grown over: sentences with numbers and a way out.

#include "region_grow/region_grow.hpp"
#include "region_grow/surface.hpp"

namespace scanmill::growing {

/// Throws Error for a parameter out of its range.
void require_in_range(const RegionGrowParams& params, std::size_t points);
/// Throws Error unless there are three places off one line. `points`: of the cloud.
void require_area(const Samples& samples, std::size_t points);

/// For a `start` at which no triangle could be formed.
[[noreturn]] void refuse_start(u32 row);
/// For a cloud in which no triangle could be formed anywhere; tells bins that would make one sheet of several layers.
[[noreturn]] void refuse_all(const Surface& surface, const RegionGrowParams& params, LengthUnit unit, unsigned threads);

}  // namespace scanmill::growing
