// SPDX-License-Identifier: GPL-3.0-or-later
// Is the part within tolerance? The shipped workflows on a scanned block with a dent and a pad of known sizes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "scanmill/base/random.hpp"
#include "scanmill/formats/files.hpp"
#include "support/folders.hpp"
#include "support/numbers.hpp"
#include "support/program.hpp"
#include "support/shapes.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr double dent_depth = 0.4, pad_height = 0.2, noise = 0.02;  // in mm
constexpr double flat_radius = 4, foot_radius = 5;

struct Form {
    double x, y, height;
};
constexpr Form dent{15, 10, -dent_depth}, pad{45, 30, pad_height};

/// Height of the top face over z = 20: flat in the middle of the dent and the pad, with straight flanks.
double top_at(double x, double y) {
    for (const Form& form : {dent, pad})
        if (const double r = std::hypot(x - form.x, y - form.y); r < foot_radius)
            return form.height * std::min(1.0, (foot_radius - r) / (foot_radius - flat_radius));
    return 0;
}

/// A block of 60 x 40 x 20 mm with a step, scanned from all sides.
class ScannedBlock {
public:
    std::vector<std::size_t> floor, top;  ///< rows on the flat floor of the dent, and on the flat top of the pad

    explicit ScannedBlock(const TemporaryFolder& folder) : folder_(folder.path()) {
        Random random(5);
        const auto add = [&](const Vec3& position, const Vec3& normal) {
            positions_.push_back(position + noise * random.normal() * normal);
        };
        constexpr double step = 0.5;
        for (double x = step / 2; x < 60; x += step)
            for (double y = step / 2; y < 40; y += step) {
                for (const auto& [form, rows] : {std::pair(dent, &floor), {pad, &top}})
                    if (std::hypot(x - form.x, y - form.y) < flat_radius - 0.5) rows->push_back(positions_.size());
                add({x, y, 20 + top_at(x, y)}, Vec3::UnitZ());
                add({x, y, 0}, -Vec3::UnitZ());
            }
        for (double z = step / 2; z < 20; z += step) {
            for (double x = step / 2; x < 60; x += step) {
                add({x, 0, z}, -Vec3::UnitY());
                add({x, 40, z}, Vec3::UnitY());
            }
            for (double y = step / 2; y < 40; y += step) {
                add({0, y, z}, -Vec3::UnitX());
                add({60, y, z}, Vec3::UnitX());
            }
        }
        TriangleMesh block;
        Array<Vec3> corners;
        const TriangleMesh unit = cube(1);
        const Vec3 low = bounding_box(unit.positions.span()).low;
        for (const Vec3& corner : unit.positions) corners.push_back((corner - low).cwiseProduct(Vec3(60, 40, 20)));
        block.positions = std::move(corners);
        block.triangles = unit.triangles;
        block.frame.unit = LengthUnit::millimetre;
        write(folder_ / "nominal.ply", block);
    }

    /// Writes part.ply, moved by `motion`.
    void write_scan(const Eigen::Isometry3d& motion = Eigen::Isometry3d::Identity()) const {
        write(folder_ / "part.ply", cloud_of(positions_, motion));
    }
    /// Writes the corners of the base as points of the scan, picked with an error, and as points of the nominal.
    void write_corners(const Eigen::Isometry3d& motion) const {
        const std::vector<Vec3> corners{{0, 0, 0}, {60, 0, 0}, {60, 40, 0}, {0, 40, 20}};
        std::vector<Vec3> picked;
        for (std::size_t i = 0; i < corners.size(); ++i)
            picked.push_back(corners[i] + 0.15 * Vec3(i % 2 ? 1 : -1, i / 2 ? 1 : -1, i == 1 || i == 2 ? 1 : -1));
        write(folder_ / "scan-points.ply", cloud_of(picked, motion));
        write(folder_ / "nominal-points.ply", cloud_of(corners, Eigen::Isometry3d::Identity()));
    }

private:
    static PointCloud cloud_of(const std::vector<Vec3>& positions, const Eigen::Isometry3d& motion) {
        PointCloud cloud;
        cloud.frame.unit = LengthUnit::millimetre;
        Array<Vec3> moved;
        for (const Vec3& position : positions) moved.push_back(motion * position);
        cloud.positions = std::move(moved);
        return cloud;
    }
    template <class T>
    static void write(const fs::path& file, const T& object) {
        write_file(file, Value(std::make_shared<const T>(object)));
    }

    fs::path folder_;
    std::vector<Vec3> positions_;
};

double mean_of(const PointCloud& deviations, const std::vector<std::size_t>& rows) {
    const Column* column = deviations.columns.find("deviation");
    if (!column) return nan;
    double sum = 0;
    for (const std::size_t row : rows) sum += column->number(row);
    return sum / static_cast<double>(rows.size());
}

json metrics_in(const fs::path& file) { return json::parse(std::ifstream(file)).at("metrics"); }

/// The values of the labels: `label`, `label@2`, …
std::vector<double> labels_in(const json& metrics) {
    std::vector<double> labels;
    for (const auto& [name, value] : metrics.items())
        if (name == "label" || name.starts_with("label@")) labels.push_back(value.get<double>());
    return labels;
}

void expect_dent_and_pad(const ScannedBlock& block, const fs::path& out) {
    const auto deviations = read_points(out / "part-deviation.ply");
    EXPECT_NEAR(mean_of(*deviations, block.floor), -dent_depth, 0.01);
    EXPECT_NEAR(mean_of(*deviations, block.top), pad_height, 0.01);
    const std::vector<double> labels = labels_in(metrics_in(out / "part-inspection.json"));
    EXPECT_THAT(labels, testing::Contains(testing::Lt(-dent_depth + noise)));
    EXPECT_THAT(labels, testing::Contains(testing::Gt(pad_height - noise)));
}

std::vector<std::string> inspection(const std::string& workflow, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"run", shipped(workflow), "part.ply", "--in", "nominal=nominal.ply", "-o",
                                       "out", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

TEST(InspectWorkflows, PartOutOfTolerance_FailsButEverythingIsWritten) {
    const TemporaryFolder folder;
    const ScannedBlock block(folder);
    block.write_scan();
    const ProgramResult ran = scanmill_program(inspection("inspect.yaml"), {.folder = folder.path()});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_THAT(ran.out, HasSubstr("in-tolerance in [99 %, 100 %]"));
    const fs::path out = folder.path() / "out/failed";
    for (const char* name : {"part-inspection.json", "part-deviation.ply", "part-on-nominal.ply", "part-on-nominal.glb",
                             "part-deviation.png", "part-on-nominal.png"})
        EXPECT_TRUE(fs::exists(out / name)) << name;
    expect_dent_and_pad(block, out);
    const json metrics = metrics_in(out / "part-inspection.json");
    EXPECT_LT(metrics.at("in-tolerance"), 0.99);
    EXPECT_NEAR(metrics.at("in-tolerance").get<double>() + metrics.at("above").get<double>() +
                    metrics.at("below").get<double>(),
                1, 1e-12);
    const auto on_nominal = read_mesh(out / "part-on-nominal.ply");
    EXPECT_TRUE(on_nominal->vertex_columns.find("colour")) << "programs show the heat map";
}

TEST(InspectWorkflows, LowerDemand_Passes) {
    const TemporaryFolder folder;
    const ScannedBlock block(folder);
    block.write_scan();
    const ProgramResult ran =
        scanmill_program(inspection("inspect.yaml", {"--set", "required=95 %"}), {.folder = folder.path()});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    expect_dent_and_pad(block, folder.path() / "out");
}

TEST(InspectWorkflows, DisplacedPart_IsAlignedAndHasTheSameMeans) {
    const TemporaryFolder folder;
    const ScannedBlock block(folder);
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    motion.rotate(Eigen::AngleAxisd(0.5 * degree, Vec3(1, 2, 2).normalized()));
    motion.pretranslate(Vec3(0.6, -0.6, 0.5));
    block.write_scan(motion);
    block.write_corners(motion);
    const ProgramResult ran = scanmill_program(
        inspection("inspect-aligned.yaml", {"--in", "scan-points=scan-points.ply", "--in",
                                            "nominal-points=nominal-points.ply", "--set", "required=95 %"}),
        {.folder = folder.path()});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    expect_dent_and_pad(block, folder.path() / "out");
    const json metrics = metrics_in(folder.path() / "out/part-inspection.json");
    EXPECT_GT(metrics.at("alignment-rms"), noise / 2);
    EXPECT_LT(metrics.at("alignment-rms"), 2 * noise);
}

}  // namespace
}  // namespace scanmill::test
