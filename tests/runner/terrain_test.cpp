// SPDX-License-Identifier: GPL-3.0-or-later
/// The workflow terrain: open surfaces over hills.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <cmath>
#include <nlohmann/json.hpp>

#include "scanmill/base/random.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/formats/files.hpp"
#include "support/folders.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

/// A paraboloid of 100 x 80 with a top of 20: no libm function decides its points.
double height_at(double x, double y) { return 20 - x * x / 200 - y * y / 150; }

class Terrain : public testing::Test {
protected:
    nlohmann::json metrics_of_filling(const std::string& scan) {
        const ProgramResult ran = scanmill_program(
            {"run", test::source_folder() + "/workflows/terrain.yaml", scan, "-o", "out", "--json", "-q"},
            {.folder = folder_.path()});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        const nlohmann::json report = nlohmann::json::parse(ran.out);
        for (const nlohmann::json& step : report.at("steps"))
            if (step.at("step") == "fill-holes") return step.at("metrics");
        ADD_FAILURE() << "no step fill-holes in " << report;
        return {};
    }
    TemporaryFolder folder_;
};

TEST_F(Terrain, HillsWithAGapAndALake_BecomeOneOpenSurface_WithTheGapFilled) {
    std::string points;
    Random random(1);
    std::size_t high = 0;
    for (int i = 0; i < 40000; ++i) {
        const double x = random.uniform(-50, 50), y = random.uniform(-40, 40);
        if ((x - 20) * (x - 20) + (y - 10) * (y - 10) < 1) continue;  // the gap, with a boundary of 6
        if ((x + 20) * (x + 20) + (y + 10) * (y + 10) < 64) continue;  // the lake, with a boundary of 50
        double z = height_at(x, y) + random.uniform(-0.05, 0.05);
        if (i % 400 == 0) z += 12, ++high;  // birds
        points += fmt::format("{} {} {}\n", x, y, z);
    }
    folder_.write("hill.xyz", points);
    const nlohmann::json metrics = metrics_of_filling("hill.xyz");
    EXPECT_EQ(metrics.at("outer"), 2) << "the boundary of the hill, and of the lake";
    EXPECT_GE(metrics.at("filled"), 1);
    const auto mesh = read_mesh(folder_ / "out/hill.ply");
    const MeshTopology found = topology(*mesh);
    EXPECT_EQ(found.components, 1u);
    EXPECT_EQ(found.boundary_loops, 2u);
    EXPECT_EQ(found.genus, 0);
    for (const Vec3& offset : mesh->positions) {
        const Vec3 p = mesh->frame.origin + offset;
        EXPECT_NEAR(p.z(), height_at(p.x(), p.y()), 0.4) << "no bird, and no sheet below the ground";
    }
    double up = 0, down = 0;
    for (const auto& [a, b, c] : mesh->triangles) {
        const Vec3& origin = mesh->positions[a];
        const double area = (mesh->positions[b] - origin).cross(mesh->positions[c] - origin).z() / 2;
        (area > 0 ? up : down) += std::abs(area);
    }
    EXPECT_GT(up, 7000) << "of 8000, without the lake of 200 and the rim";
    EXPECT_LT(down, 1) << "slivers between noisy points";
}

}  // namespace
}  // namespace scanmill::test
