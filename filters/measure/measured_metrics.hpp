// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A measurement under the names that workflows, gates and reports use.

#include <span>
#include <string>

#include "measure/measure.hpp"
#include "scanmill/data/metrics.hpp"

namespace scanmill {

/// Only what exists: a number that is absent from the measurement has no metric.
///
///   mean, mean-spread, rms, p50, p90, p95, p99, max     over both sides (for a cloud as truth: from the truth)
///   the same with -to-truth, -from-truth, -to-points    one side
///   beyond-borders                                      where the points there are left out
///   hausdorff, chamfer
///   threshold, f-score, precision, recall               at the first threshold
///   the same with @2, @3, …                             at the others, in their order
///   normal-consistency, normal-consistency-unsigned, without-normal
///   hausdorff-lower, hausdorff-upper, certified, cuts
///   diagonal                                            of the mesh's bounding box
///   triangles, area, volume, components, genus, boundary-loops, …, self-intersections      the mesh
///   the same with truth- in front, but no self-intersections                              the truth, if a mesh
Metrics metrics_of(const Measurement& measured);

}  // namespace scanmill
