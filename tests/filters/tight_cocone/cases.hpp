// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How the tests call tight-cocone.

#include "filters/cocone/cases.hpp"
#include "tight_cocone/tight_cocone.hpp"

namespace scanmill::test {

inline TightCoconeResult closed_through(const PointCloud& cloud, const TightCoconeParams& params = {},
                                        unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return tight_cocone(tets_of(cloud, threads), params, context);
}

inline double volume(const TriangleMesh& mesh) { return signed_volume(mesh.positions.span(), mesh.triangles.span()); }

}  // namespace scanmill::test
