// SPDX-License-Identifier: GPL-3.0-or-later
// A part was changed: the shipped workflows on a block with a pad and a pocket of known volumes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include "filters/mesh_update/blocks.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/formats/files.hpp"
#include "support/folders.hpp"
#include "support/program.hpp"
#include "support/shapes.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr double spacing = 0.5, border = 4, pad_height = 6, pocket_depth = 5;
constexpr Rectangle pad{10, 12, 22, 28}, pocket{38, 12, 50, 28};
constexpr double face = 12 * 16, perimeter = 2 * (12 + 16);
constexpr double block_volume = 60.0 * 40 * 20, changed_volume = block_volume + face * (pad_height - pocket_depth);
/// Triangles cut the edges of the pad and of the pocket by at most half a square of the spacing.
constexpr double tolerance = (4 * perimeter + 4 * (pad_height + pocket_depth)) * spacing * spacing / 2;

template <class T>
void write(const fs::path& file, const T& object) {
    write_file(file, Value(std::make_shared<const T>(object)));
}

PointCloud lifted(const PointCloud& cloud, double height) {
    PointCloud result = cloud;
    Array<Vec3> positions;
    for (const Vec3& position : cloud.positions) positions.push_back(position + Vec3(0, 0, height));
    result.positions = std::move(positions);
    return result;
}

/// Points of a grid on all faces of the block.
PointCloud scan_of_block() {
    Array<Vec3> positions;
    for (int x = 0; x <= 60; ++x)
        for (int y = 0; y <= 40; ++y)
            for (int z = 0; z <= 20; ++z)
                if (x % 60 == 0 || y % 40 == 0 || z % 20 == 0) positions.emplace_back(x, y, z);
    PointCloud cloud;
    cloud.positions = std::move(positions);
    return cloud;
}

class UpdateWorkflows : public testing::Test {
protected:
    void SetUp() override {
        write(folder_ / "block.ply", block());
        write(folder_ / "pad.ply", *step_cloud(pad, 20, pad_height, border, spacing));
        write(folder_ / "pocket.ply", *step_cloud(pocket, 20, -pocket_depth, border, spacing));
        write(folder_ / "high.ply", lifted(*step_cloud(pad, 20, pad_height, border, spacing), spacing));
    }

    ProgramResult run(const std::string& workflow, std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), {"run", shipped(workflow)});
        arguments.insert(arguments.end(), {"-o", "out", "-q"});
        return scanmill_program(arguments, {.folder = folder_.path()});
    }

    void expect_pad_and_pocket(const std::string& name) {
        const auto updated = read_mesh(folder_ / ("out/" + name + "-updated.ply"));
        EXPECT_NEAR(signed_volume(*updated), changed_volume, tolerance);
        EXPECT_EQ(topology(*updated).euler, 2);
        const auto change = read_mesh(folder_ / ("out/" + name + "-change.ply"));
        const Column* distance = change->vertex_columns.find("distance-to-truth");
        ASSERT_TRUE(distance);
        double low = 0, high = 0;
        for (std::size_t row = 0; row < change->positions.size(); ++row) {
            low = std::min(low, distance->number(row));
            high = std::max(high, distance->number(row));
        }
        EXPECT_NEAR(high, pad_height, 1e-9) << "the pad is outside";
        EXPECT_NEAR(low, -pocket_depth, 1e-9) << "the pocket is inside";
        for (const char* file : {"-updated.stl", "-change.png"})
            EXPECT_TRUE(fs::exists(folder_ / ("out/" + name + file))) << file;
    }

    TemporaryFolder folder_;
};

TEST_F(UpdateWorkflows, Mesh_GetsThePadAndThePocket) {
    const ProgramResult ran = run("update-mesh.yaml", {"block.ply", "--in", "clouds=pad.ply,pocket.ply"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    expect_pad_and_pocket("block");
}

TEST_F(UpdateWorkflows, ModelOfAScan_GetsThePadAndThePocket) {
    write(folder_ / "scan.ply", scan_of_block());
    const ProgramResult ran = run("woo-dey-2005.yaml", {"scan.ply", "--in", "clouds=pad.ply,pocket.ply"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    expect_pad_and_pocket("scan");
    EXPECT_NEAR(signed_volume(*read_mesh(folder_ / "out/scan-model.ply")), block_volume, 1e-6) << "edges have points";
}

TEST_F(UpdateWorkflows, CloudBesideTheMesh_FailsOrKeepsTheMesh) {
    const ProgramResult failed = run("update-mesh.yaml", {"block.ply", "--in", "clouds=high.ply"});
    EXPECT_EQ(failed.exit_code, 1);
    EXPECT_THAT(failed.err, HasSubstr("registration"));
    const ProgramResult kept =
        run("update-mesh.yaml", {"block.ply", "--in", "clouds=high.ply", "--set", "on-doubt=keep"});
    EXPECT_EQ(kept.exit_code, 0) << kept.err;
    EXPECT_THAT(kept.err, HasSubstr("registration"));
    const auto mesh = read_mesh(folder_ / "out/block-updated.ply");
    EXPECT_TRUE(std::ranges::equal(mesh->triangles, block().triangles));
    EXPECT_TRUE(std::ranges::equal(mesh->positions, block().positions));
}

/// The script of docs/how-to/update-many-parts.md, with a tenth of the points.
TEST_F(UpdateWorkflows, WorkedCases_ReplaceWhatTheirCloudsShow) {
    const std::string script = source_folder() + "/docs/how-to/update-a-changed-part/worked_cases.py";
    const fs::path cases = folder_ / "cases";
    ASSERT_EQ(std::system(("python3 '" + script + "' '" + cases.string() + "' --share 0.1").c_str()), 0);
    const ProgramResult scanned = scanmill_program({"batch", "scan.yaml", "-o", "scans", "-q"}, {.folder = cases});
    ASSERT_EQ(scanned.exit_code, 0) << scanned.err;
    const ProgramResult updated =
        scanmill_program({"batch", "update.yaml", "-o", "updated", "-q", "--strict"}, {.folder = cases});
    ASSERT_EQ(updated.exit_code, 0) << updated.err;
    const std::map<std::string, int> replaced{
        {"airbag", 3}, {"block", 1}, {"golf-club", 1}, {"joystick-1", 1}, {"joystick-2", 1}};
    for (const auto& [name, groups] : replaced) {
        const std::string description = content_of(cases / ("updated/" + name + "-updated.ply.json"));
        EXPECT_THAT(description, HasSubstr("\"replaced\": " + std::to_string(groups))) << name;
        EXPECT_THAT(description, HasSubstr("\"groups\": " + std::to_string(groups + 1))) << name;
    }
}

TEST_F(UpdateWorkflows, TightCocone_MakesAClosedMeshOfAScan) {
    write(folder_ / "scan.ply", scan_of_block());
    const ProgramResult ran = run("tight-cocone.yaml", {"scan.ply"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_NEAR(signed_volume(*read_mesh(folder_ / "out/scan.ply")), block_volume, 1e-6);
    EXPECT_TRUE(fs::exists(folder_ / "out/scan.stl"));
}

}  // namespace
}  // namespace scanmill::test
