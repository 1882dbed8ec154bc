// SPDX-License-Identifier: GPL-3.0-or-later
// From a dense scan to a light mesh and its lines: the shipped workflows on scans whose truth is known.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "support/folders.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

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

// A probe measures the edges of the block in the machine's frame, which is turned and shifted.

struct Machine {
    static constexpr double cosine = 0.8, sine = 0.6;  // a turn about z
    static std::array<double, 3> from_scanner(double x, double y, double z) {
        return {cosine * x - sine * y + 400, sine * x + cosine * y + 300, z + 50};
    }
    static std::array<double, 3> to_scanner(const json& p) {
        const double x = p[0].get<double>() - 400, y = p[1].get<double>() - 300;
        return {cosine * x + sine * y, cosine * y - sine * x, p[2].get<double>() - 50};
    }
};

/// From a point of the block's upper face to the nearest of its true edges: four sides, five rims.
double to_edge(double x, double y) {
    double nearest = std::min(std::abs(std::abs(x) - 44), std::abs(std::abs(y) - 47.5));
    nearest = std::min(nearest, std::abs(std::hypot(x, y) - 21));
    return std::min(nearest, std::abs(std::hypot(std::abs(x) - 30.8, std::abs(y) - 33.25) - 5));
}

class HybridWorkflow : public testing::Test {
protected:
    void SetUp() override {
        write_scan(
            folder, "block",
            "shape: block-with-holes, size: [88 u, 95 u, 41 u, 21 u, 5 u], views: [0, 0, 1], resolution: 0.25 u");
        write_scan(folder, "plate", "shape: box, size: [200 u, 120 u, 10 u], views: [0, 0, 1], resolution: 1 u");
        std::ofstream corners(folder / "corners.csv");
        corners << "x,y,z\n";
        for (const auto& [x, y] : {std::pair(100, -60), {-100, 60}, {100, 60}, {-100, -60}}) {  // in no order
            const auto p = Machine::from_scanner(x, y, 5);
            corners << p[0] << ',' << p[1] << ',' << p[2] << '\n';
        }
    }
    ProgramResult run(const std::string& first_corner) {
        return scanmill_program(
            {"run", shipped("wang-2006-hybrid.yaml"), "block.ply", "--unit", "mm", "--in", "plate=plate.ply", "--in",
             "corners=corners.csv", "--set", "first-corner=" + first_corner, "-o", "out"},
            {.folder = folder.path()});
    }
    TemporaryFolder folder;
};

TEST_F(HybridWorkflow, PlansTouchesOfTheBlocksEdgesInTheMachinesFrame) {
    const ProgramResult ran = run("[95 u, -65 u, 0 u]");
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json transform = content(folder / "out/block-to-machine.json");
    EXPECT_EQ(transform.at("frame"), "machine");
    EXPECT_TRUE(std::filesystem::exists(folder / "out/block-probes.dmi"));
    const json& rows = transform.at("poses")[0].at("matrix");
    EXPECT_NEAR(rows[0][0].get<double>(), Machine::cosine, 1e-4);
    EXPECT_NEAR(rows[0][1].get<double>(), -Machine::sine, 1e-4);
    EXPECT_NEAR(rows[0][3].get<double>(), 400, 1e-2);
    EXPECT_NEAR(rows[2][3].get<double>(), 50, 1e-2);

    const json plan = content(folder / "out/block-probes.json");
    EXPECT_EQ(plan.at("frame"), "machine");
    std::set<json> features;
    std::size_t made = 0;
    for (const json& touch : plan.at("touches")) {
        features.insert(touch.at("feature"));
        const auto p = Machine::to_scanner(touch.at("point"));
        EXPECT_LE(to_edge(p[0], p[1]), 1) << "within scanner-error of the true edge";
        EXPECT_NEAR(p[2], 20.5, 0.05) << "on the upper face";
        if (touch.at("reason") != "none") continue;
        ++made;
        EXPECT_EQ(touch.at("false-share"), 0);
        EXPECT_EQ(touch.at("contact"), "edge");
    }
    EXPECT_EQ(features.size(), 6u) << "the outer boundary and five rims";
    EXPECT_EQ(made, plan.at("touches").size());
    // Sides and rims, every 2 % of the diagonal of the turned block's box, from two directions.
    const double length = 2 * (88 + 95) + 2 * 3.14159 * (21 + 4 * 5);
    const double diagonal = std::hypot(0.8 * 88 + 0.6 * 95, 0.6 * 88 + 0.8 * 95);
    EXPECT_NEAR(static_cast<double>(made), 2 * length / (0.02 * diagonal), 0.1 * static_cast<double>(made));
}

TEST_F(HybridWorkflow, ACornerThatTheMachineDidNotMeasureFirst_IsRefused) {
    const ProgramResult ran = run("[95 u, 65 u, 0 u]");
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_THAT(ran.err, testing::HasSubstr("long sides meet short ones"));
    EXPECT_THAT(run("[0 u, 0 u, 0 u]").err, testing::HasSubstr("from the nearest corner of the source"));
}

TEST_F(HybridWorkflow, MovingTwice_IsRefused) {
    const auto twice =
        folder.write("twice.yaml",
                     "scanmill: 1\nname: twice\ninputs:\n  scan: {kind: points, frame: scanner}\n"
                     "  motion: transform\nsteps:\n  - id: once\n    apply-transform:\n    in: {value: scan, "
                     "transform: motion}\n  - id: again\n    apply-transform:\n    in: {value: once, "
                     "transform: motion}\noutputs: {\"{scan}-moved.ply\": again}\n");
    ASSERT_EQ(run("[95 u, -65 u, 0 u]").exit_code, 0);
    const ProgramResult ran = scanmill_program(
        {"run", twice.string(), "block.ply", "--unit", "mm", "--in", "motion=out/block-to-machine.json", "-o", "moved"},
        {.folder = folder.path()});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_THAT(ran.err, testing::HasSubstr("already in the frame 'machine'"));
}

}  // namespace
}  // namespace scanmill::test
