// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The order that makes incremental insertion fast, with or without weights.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <span>
#include <utility>
#include <vector>

#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using PointRow = std::pair<Kernel::Point_3, u32>;

/// The points and their rows in a biased randomised order along Hilbert curves, in rounds of doubling size.
std::vector<PointRow> insertion_order(std::span<const Vec3> positions, unsigned threads);

}  // namespace scanmill
