// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How much memory a run may need, before any of its scans is opened.

#include "scanmill/graph/graph.hpp"

namespace scanmill {

/// A guess from above, in bytes: what doing everything for one scan takes, for the scan that takes most. 0 when no scan
/// has a file. A file of binary coordinates becomes up to about a hundred times its size on the way to a mesh, other
/// files less. Of a streamed one only what is kept goes that way; but it may turn out that it has to be read as a
/// whole, which, with what is kept, takes about four times its size.
u64 memory_need(const RunGraph& graph);

}  // namespace scanmill
