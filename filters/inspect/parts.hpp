// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The parts of a nominal surface for which numbers are reported.

#include "inspect/nominal.hpp"

namespace scanmill::inspecting {

struct Parts {
    /// By triangle of Nominal::surface(): the number of its part, from 0. Parts are numbered by their first triangles.
    Array<u32> of_triangle;
    std::size_t count = 0;
};

/// Parts that are connected through edges, whatever number of triangles an edge has.
Parts components_of(const Nominal& nominal);

/// The parts between sharp edges: edges whose triangles' normals differ by more than the default sharp angle of
/// find_features(), declared sharp edges, and edges that do not have two triangles of one orientation.
Parts patches_of(const Nominal& nominal, unsigned threads);

}  // namespace scanmill::inspecting
