// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Calls of measure, for its tests.

#include "measure/measure.hpp"
#include "support/mesh_operations.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {

template <class Truth>
Measurement measured(const TriangleMesh& mesh, const Truth& truth, const MeasureParams& params = {},
                     unsigned threads = 2) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return measure(mesh, truth, params, context);
}

/// Few samples, for tests about vertices, topology or refusals.
inline MeasureParams few_samples() {
    MeasureParams params;
    params.samples = 2000;
    return params;
}

inline MeasureParams certified(double percent = 1) {
    MeasureParams params = few_samples();
    params.certify = true;
    params.gap = Ratio::percent(percent);
    return params;
}

}  // namespace scanmill::test
