// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What holds for every tessellation of a closed mesh's patches.

#include <set>

#include "filters/a_patch/cases.hpp"
#include "tessellate/tessellate.hpp"

namespace scanmill::test {

inline TriangleMesh tessellated(const PatchComplex& patches, const TessellateParams& params, unsigned threads = 1) {
    Execution execution({threads, {}, {}});
    return tessellate(patches, params, execution);
}
inline TriangleMesh tessellated(const PatchComplex& patches, u32 subdivision, std::optional<Length> max_error = {}) {
    return tessellated(patches, TessellateParams{subdivision, max_error});
}

inline void expect_no_equal_corners(const TriangleMesh& mesh) {
    for (const auto& [a, b, c] : mesh.triangles) {
        EXPECT_NE(mesh.positions[a], mesh.positions[b]);
        EXPECT_NE(mesh.positions[b], mesh.positions[c]);
        EXPECT_NE(mesh.positions[c], mesh.positions[a]);
    }
}

/// Closed, with the topology of `mesh`, every directed edge once against its opposite, no two vertices at one position.
inline void expect_closed(const TriangleMesh& result, const TriangleMesh& mesh) {
    const MeshTopology found = topology(result), wanted = topology(mesh);
    EXPECT_TRUE(found.closed);
    EXPECT_EQ(found.euler, wanted.euler);
    EXPECT_EQ(found.components, wanted.components);
    EXPECT_EQ(found.unused_vertices, 0u);
    std::set<std::array<u32, 2>> directed;
    for (const Triangle& t : result.triangles)
        for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(directed.insert({t[i], t[(i + 1) % 3]}).second);
    for (const auto& [a, b] : directed) EXPECT_TRUE(directed.contains({b, a}));
    std::set<std::array<double, 3>> places;
    for (const Vec3& p : result.positions) EXPECT_TRUE(places.insert({p.x(), p.y(), p.z()}).second);
    expect_no_equal_corners(result);
}

}  // namespace scanmill::test
