// SPDX-License-Identifier: GPL-3.0-or-later
// From a dense scan to a light mesh and its lines: the shipped workflows on scans whose truth is known.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

std::string shipped(const std::string& name) { return std::string(SCANMILL_SOURCE_DIR) + "/workflows/" + name; }

json content(const fs::path& file) { return json::parse(std::ifstream(file)); }

/// A virtual scan of the shape, as NAME.ply in the folder.
void write_scan(const TemporaryFolder& folder, const std::string& name, const std::string& parameters) {
    const auto workflow =
        folder.write(name + ".yaml", "scanmill: 1\nname: " + name + "\nsteps:\n  - virtual-scan: {" + parameters +
                                         "}\noutputs: {\"" + name + ".ply\": virtual-scan}\n");
    const ProgramResult made = scanmill_program({"run", workflow.string(), "-o", folder.path().string()});
    ASSERT_EQ(made.exit_code, 0) << made.err;
}

struct Hole {
    double x, y, radius;
};

TEST(WangWorkflows, Block_HasItsFiveHolesWithinABin) {
    const TemporaryFolder folder;
    const ProgramResult ran =
        scanmill_program({"run", shipped("wang-2006-block.yaml"), "-o", "out"}, {.folder = folder.path()});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    std::vector<Hole> holes{{0, 0, 21}, {30.8, 33.25, 5}, {-30.8, 33.25, 5}, {30.8, -33.25, 5}, {-30.8, -33.25, 5}};
    const json features = content(folder / "out/block-features.json");
    for (const json& line : features.at("polylines")) {
        if (line.at("type") != "hole") continue;
        const json& points = line.at("points");
        double x = 0, y = 0;
        for (const json& point : points) {
            x += point[0].get<double>() / static_cast<double>(points.size());
            y += point[1].get<double>() / static_cast<double>(points.size());
        }
        const auto found = std::ranges::find_if(holes, [&](const Hole& h) { return std::hypot(h.x - x, h.y - y) < 3; });
        ASSERT_NE(found, holes.end()) << "a hole round " << x << " " << y;
        double mean = 0;
        for (const json& point : points) {
            const double radius = std::hypot(point[0].get<double>() - found->x, point[1].get<double>() - found->y);
            EXPECT_GE(radius, found->radius - 1e-9) << "where no point was";
            mean += radius / static_cast<double>(points.size());
        }
        EXPECT_LE(mean, found->radius + 3);
        holes.erase(found);
    }
    EXPECT_TRUE(holes.empty()) << holes.size() << " of the five were not found";
}

TEST(WangWorkflows, Saddle_KeepsTheToleranceWithAFractionOfThePoints) {
    const TemporaryFolder folder;
    write_scan(folder, "saddle", "shape: hyperboloid, size: [2 u, 1.5 u], views: [0, 0, 1], resolution: 0.02 u");
    const ProgramResult ran = scanmill_program(
        {"run", shipped("wang-2006.yaml"), "saddle.ply", "-o", "out", "--set", "tolerance=0.2 %diag", "--json"},
        {.folder = folder.path()});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json measured = content(folder / "out/saddle-metrics.json").at("metrics");
    EXPECT_EQ(measured.at("recall"), 1) << "of the points away from the border, within the tolerance";
    EXPECT_LE(measured.at("max").get<double>(), 0.002 * measured.at("diagonal").get<double>());
    EXPECT_EQ(measured.at("boundary-loops"), 1);
    EXPECT_EQ(measured.at("euler"), 1) << "a disc";
    const double points = 3.14159 * 100 * 100;
    EXPECT_LT(measured.at("vertices").get<double>(), points / 4);
    EXPECT_LT(measured.at("beyond-borders").get<double>(), points / 20);
    const json features = content(folder / "out/saddle-features.json");
    int boundaries = 0;
    for (const json& line : features.at("polylines")) boundaries += line.at("type") == "outer boundary";
    EXPECT_EQ(boundaries, 1);
}

TEST(WangWorkflows, Ball_IsClosedAndHasNoLines) {
    const TemporaryFolder folder;
    write_scan(folder, "ball", "shape: sphere, size: 10 u, views: [12], resolution: 0.3 u");
    const ProgramResult ran =
        scanmill_program({"run", shipped("wang-2006.yaml"), "ball.ply", "-o", "out"}, {.folder = folder.path()});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json measured = content(folder / "out/ball-metrics.json").at("metrics");
    EXPECT_EQ(measured.at("closed"), true);
    EXPECT_EQ(measured.at("genus"), 0);
    EXPECT_EQ(measured.at("recall"), 1);
    EXPECT_EQ(measured.at("beyond-borders"), 0);
    EXPECT_TRUE(content(folder / "out/ball-features.json").at("polylines").empty());
}

}  // namespace
}  // namespace scanmill::test
