// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_update/mesh_update.hpp"

#include <gmock/gmock.h>

#include "filters/mesh_update/blocks.hpp"
#include "scanmill/data/topology.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

MeshUpdateParams block_params(double max_distance = 3) {
    MeshUpdateParams params;
    params.max_distance = max_distance;
    return params;
}

TEST(MeshUpdate, PadOnABlock) {
    const std::vector clouds{step_cloud({20, 10, 40, 30}, 20, 6, 4, 1)};
    Context context;
    const MeshUpdateResult result = mesh_update(block(), clouds, block_params(), context);
    for (const Metric& m : context.metrics().values) std::cout << m.name << " " << m.value << "\n";
    for (auto& w : context.warnings()) std::cout << w << "\n";
    for (auto& w : context.doubts()) std::cout << w.text << "\n";
    EXPECT_EQ(result.groups, 2);
    EXPECT_EQ(result.replaced, 1);
    const MeshTopology found = topology(result.mesh);
    EXPECT_TRUE(found.closed);
    EXPECT_EQ(found.euler, 2);
    EXPECT_NEAR(signed_volume(result.mesh), 60 * 40 * 20 + 20 * 20 * 6, 1 * (28 * 28 + 4 * 20 * 6) / 2.0);
    std::cout << signed_volume(result.mesh) - 50400 << "\n";
}

TEST(MeshUpdate, PocketInABlock) {
    const std::vector clouds{step_cloud({20, 10, 40, 30}, 20, -8, 4, 1)};
    Context context;
    const MeshUpdateResult result = mesh_update(block(), clouds, block_params(), context);
    for (const Metric& m : context.metrics().values) std::cout << m.name << " " << m.value << "\n";
    for (auto& w : context.warnings()) std::cout << w << "\n";
    for (auto& w : context.doubts()) std::cout << w.text << "\n";
    EXPECT_EQ(topology(result.mesh).euler, 2);
    std::cout << signed_volume(result.mesh) - 48000+3200 << "\n";
}

}  // namespace
}  // namespace scanmill::test
