// SPDX-License-Identifier: GPL-3.0-or-later
/// a-patch on scanned models, decimated.
#include "decimate/decimate.hpp"
#include "filters/a_patch_cases.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/geometry/distance/self_intersections.hpp"
#include "support/real_data.hpp"
#include "tessellate/tessellate.hpp"

namespace scanmill::test {
namespace {

class APatchReal : public testing::TestWithParam<const char*> {};

TEST_P(APatchReal, DecimatedModel_HasOneClosedSmoothSheet) {
    SCANMILL_REAL_SCAN(path, fetched_data, GetParam());
    const auto mesh = read_mesh(path);
    DecimateParams reduction;
    reduction.max_error = 0.003 * surface_box(*mesh).diagonal();
    Context context;
    const TriangleMesh light = decimate(*mesh, nullptr, reduction, context).mesh;
    for (const Split split : {Split::always, Split::where_needed}) {
        APatchParams params;
        params.split = split;
        const PatchRun run = patched(light, params, nullptr, 2);
        EXPECT_EQ(run.result.inverted, 0u);
        EXPECT_EQ(run.result.sign_violations, 0u);
        EXPECT_LT(run.result.c1_jump, 1e-9);
        EXPECT_GT(for_each_ray(run.result.patches, 4, [](u32, const Vec3&) {}), 1000u);
        Execution execution;
        const TriangleMesh fine = tessellate(run.result.patches, {3, {}}, execution);
        const MeshTopology found = topology(fine);
        EXPECT_TRUE(found.closed);
        EXPECT_EQ(found.euler, topology(light).euler);
        const TriangleTree tree(fine.positions.span(), fine.triangles.span(), 2);
        EXPECT_EQ(self_intersections(fine.positions.span(), fine.triangles.span(), tree, execution).count, 0u);
    }
}
INSTANTIATE_TEST_SUITE_P(Models, APatchReal,
                         testing::Values("meshes/bunny00.off", "meshes/bear.off", "meshes/eight.off",
                                         "meshes/knot1.off"));

}  // namespace
}  // namespace scanmill::test
