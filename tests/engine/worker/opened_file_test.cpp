// SPDX-License-Identifier: GPL-3.0-or-later
/// Outputs that are less closed in the file than in memory.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "scanmill/data/topology.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/worker/workbench.hpp"
#include "support/shapes.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Two spheres of radius 1000 that are 1e-9 apart: in single precision they touch in one point.
TriangleMesh nearly_touching_spheres() {
    const TriangleMesh sphere = geodesic_sphere(1000, 2);
    const auto count = static_cast<u32>(sphere.positions.size());
    const double right = std::ranges::max_element(sphere.positions, {}, [](const Vec3& p) { return p.x(); })->x();
    TriangleMesh both;
    Array<Vec3> positions(sphere.positions.begin(), sphere.positions.end());
    Array<Triangle> triangles(sphere.triangles.begin(), sphere.triangles.end());
    for (u32 i = 0; i < count; ++i)
        positions.emplace_back(2 * right + 1e-9 - positions[i].x(), positions[i].y(), positions[i].z());
    for (const auto& [a, b, c] : sphere.triangles) triangles.push_back({a + count, c + count, b + count});
    both.positions = std::move(positions);
    both.triangles = std::move(triangles);
    return both;
}

class OpenedFile : public testing::Test {
protected:
    JobReport written(bool must_be_closed) {
        const TriangleMesh mesh = nearly_touching_spheres();
        EXPECT_TRUE(topology(mesh).closed);
        write_file(folder_ / "mesh.ply", std::make_shared<const TriangleMesh>(mesh));
        LeafSource leaf;
        leaf.file = folder_ / "mesh.ply";
        leaf.kind = kind_of<TriangleMesh>();
        Job job;
        job.work = WriteWork{folder_ / "mesh.stl", "{}", {}, must_be_closed, {"", 0, "", "", leaf}};
        FilterLibrary library{{}};
        RunValues values;
        Workbench bench(library, nullptr, KeepRule::Policy::never, values, folder_ / "scratch");
        return bench.perform(job, {{}, [](std::string_view) {}, {}});
    }
    TemporaryFolder folder_;
};

TEST_F(OpenedFile, IsDoubtfulAndReportedAsNotClosed) {
    const JobReport report = written(false);
    EXPECT_EQ(report.outcome, Outcome::ok) << report.node.failure.whole().what();
    EXPECT_THAT(report.output.doubts,
                ElementsAre(testing::AllOf(HasSubstr("the mesh is closed, but the STL file is not"),
                                           testing::Not(HasSubstr(" 0 ")))))
        << "only defects that are there";
    EXPECT_EQ(report.output.properties.find("closed")->value, 0);
    EXPECT_FALSE(topology(*read_mesh(folder_ / "mesh.stl")).closed);
}

TEST_F(OpenedFile, ThatMustBeClosed_IsNotWritten) {
    const JobReport report = written(true);
    EXPECT_EQ(report.outcome, Outcome::failed);
    EXPECT_EQ(report.node.failure.cause, Cause::output);
    EXPECT_THAT(report.node.failure.whole().what(),
                HasSubstr("expected closed: true; the mesh is closed, but the STL"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "mesh.stl"));
}

}  // namespace
}  // namespace scanmill::test
