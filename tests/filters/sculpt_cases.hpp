// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How the tests call sculpt, and what they ask of every result.

#include "filters/alpha_solid_cases.hpp"
#include "sculpt/sculpt.hpp"

namespace scanmill::test {

inline SculptResult sculpted(const TetMesh& labelled, const SculptParams& params = {}, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return sculpt(labelled, params, context);
}

}  // namespace scanmill::test
