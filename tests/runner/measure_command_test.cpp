// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes against their truth: the command, and measure as a step of a workflow.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "scanmill/formats/files.hpp"
#include "support/program.hpp"
#include "support/shapes.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;

/// A unit sphere, and the same moved by a tenth along x.
class MeasureCommand : public testing::Test {
protected:
    MeasureCommand() {
        TriangleMesh sphere = geodesic_sphere(1, 15);
        write_file(folder_ / "sphere.ply", std::make_shared<const TriangleMesh>(sphere));
        Array<Vec3> moved(sphere.positions.size());
        for (std::size_t i = 0; i < moved.size(); ++i) moved[i] = sphere.positions[i] + Vec3(0.1, 0, 0);
        sphere.positions = std::move(moved);
        write_file(folder_ / "moved.ply", std::make_shared<const TriangleMesh>(sphere));
        folder_.write("w.yaml", workflow("mean: < 5 %diag"));
    }

    static std::string workflow(const std::string& expectation) {
        return "scanmill: 1\nname: w\ninputs:\n  mesh: mesh\n  truth: mesh\nsteps:\n"
               "  - measure: {samples: 5000, thresholds: [5 %diag, 1 %diag]}\n    in: {mesh: mesh, truth: truth}\n"
               "    expect: {" +
               expectation + "}\noutputs:\n  \"{scan}.json\": measure\n";
    }

    ProgramResult scanmill(const std::vector<std::string>& arguments) const {
        return scanmill_program(arguments, {.folder = folder_.path()});
    }
    ProgramResult run(const std::vector<std::string>& more = {}) const {
        std::vector<std::string> arguments{"run", "w.yaml", "sphere.ply", "--in", "truth=moved.ply",
                                           "-o",  "out",    "--cache",    "cache"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return scanmill(arguments);
    }
    TemporaryFolder folder_;
};

TEST_F(MeasureCommand, MovedSphere_IsAsFarAsItWasMoved) {
    const ProgramResult ran = scanmill({"measure", "moved.ply", "sphere.ply", "--json", "--unit", "mm"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json printed = json::parse(ran.out);
    EXPECT_EQ(printed["mesh"], "moved.ply");
    EXPECT_EQ(printed["unit"], "mm");
    const json& metrics = printed["metrics"];
    EXPECT_NEAR(metrics["hausdorff"].get<double>(), 0.1, 1e-3);
    EXPECT_LE(metrics["hausdorff"].get<double>(), 0.1 + 1e-12);
    EXPECT_EQ(metrics["genus"], 0);
    EXPECT_EQ(metrics["closed"], true);
    EXPECT_EQ(metrics["self-intersections"], 0);
    EXPECT_NEAR(metrics["volume"].get<double>(), metrics["truth-volume"].get<double>(), 1e-9);
    EXPECT_NEAR(metrics["chamfer"].get<double>(), 0.05, 2e-3) << "the mean of |cos| over a sphere is a half";
}

TEST_F(MeasureCommand, SameMesh_IsAtZero) {
    const ProgramResult ran = scanmill({"measure", "sphere.ply", "sphere.ply", "--json", "--certify"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json metrics = json::parse(ran.out)["metrics"];
    for (const char* name : {"hausdorff", "mean", "max-from-truth", "hausdorff-upper"})
        EXPECT_EQ(metrics[name], 0) << name;
    EXPECT_EQ(metrics["f-score"], 1);
    EXPECT_EQ(metrics["certified"], true);
}

TEST_F(MeasureCommand, Table_NamesUnits) {
    const ProgramResult ran = scanmill({"measure", "moved.ply", "sphere.ply", "--unit", "mm"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_THAT(ran.out, AllOf(HasSubstr("hausdorff"), HasSubstr(" mm\n"), HasSubstr(" mm²\n"), HasSubstr(" mm³\n")));
    EXPECT_THAT(scanmill({"measure", "moved.ply", "sphere.ply"}).out, HasSubstr(" u\n"));
}

TEST_F(MeasureCommand, PointsAsTruth_HaveOneSide) {
    folder_.write("points.xyz", "1.1 0 0\n-1 0 0\n0 1 0\n0 0 -1\n");
    const ProgramResult ran = scanmill({"measure", "sphere.ply", "points.xyz", "--json"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json metrics = json::parse(ran.out)["metrics"];
    EXPECT_GE(metrics["max"].get<double>(), 0.1);
    EXPECT_LT(metrics["max"].get<double>(), 0.102) << "the facets lie a little inside the sphere";
    EXPECT_FALSE(metrics.contains("hausdorff"));
    EXPECT_EQ(metrics["recall"], 0.75);
}

TEST_F(MeasureCommand, Parameters_AreThoseOfTheFilter) {
    const auto with = [&](const std::string& setting) {
        return scanmill({"measure", "moved.ply", "sphere.ply", "--json", "--set", setting});
    };
    const json metrics = json::parse(with("thresholds=[0.2 u, 0.05 u]").out)["metrics"];
    EXPECT_EQ(metrics["f-score"], 1);
    EXPECT_LT(metrics["f-score@2"].get<double>(), 1);
    EXPECT_EQ(metrics["threshold@2"], 0.05);
    EXPECT_FALSE(json::parse(with("self-intersections=false").out)["metrics"].contains("self-intersections"));
    for (const auto& [setting, sentence] :
         {std::pair("sample=9", "did you mean 'samples'"), std::pair("samples=few", "samples"),
          std::pair("samples={sweep: [100, 200]}", "a sweep is allowed in workflows only"),
          std::pair("gap=100 %", "gap")}) {
        const ProgramResult refused = with(setting);
        EXPECT_EQ(refused.exit_code, 2) << setting;
        EXPECT_THAT(refused.err + refused.out, HasSubstr(sentence));
    }
}

TEST_F(MeasureCommand, WhatCannotBeMeasured_IsRefusedWithAnExitCodeOfOne) {
    folder_.write("points.xyz", "1 0 0\n2 0 0\n");
    for (const auto& [mesh, truth, sentence] : {std::tuple("absent.ply", "sphere.ply", "absent.ply"),
                                                std::tuple("points.xyz", "sphere.ply", "a mesh is needed"),
                                                std::tuple("sphere.ply", "absent.ply", "absent.ply")}) {
        const ProgramResult refused = scanmill({"measure", mesh, truth});
        EXPECT_EQ(refused.exit_code, 1);
        EXPECT_THAT(refused.err, HasSubstr(sentence));
        EXPECT_EQ(refused.out, "");
    }
}

std::set<std::string> names_of(const json& metrics) {
    std::set<std::string> names;
    for (const auto& [name, value] : metrics.items()) names.insert(name.substr(0, name.find('@')));
    return names;
}

TEST_F(MeasureCommand, EveryMetricIsDeclared_AndEveryDeclaredOneIsGiven) {
    folder_.write("points.xyz", "1 0 0\n-1 0 0\n0 1 0\n0 0 -1\n");
    std::set<std::string> given =
        names_of(json::parse(scanmill({"measure", "moved.ply", "sphere.ply", "--certify", "--json"}).out)["metrics"]);
    const ProgramResult of_points =
        scanmill({"measure", "moved.ply", "points.xyz", "--json", "--set", "borders=exclude"});
    given.merge(names_of(json::parse(of_points.out)["metrics"]));
    const json shown = json::parse(scanmill({"show", "measure", "--json"}).out);
    std::set<std::string> declared;
    for (const json& metric : shown["filter"]["metrics"]) declared.insert(metric["name"]);
    EXPECT_EQ(given, declared);
}

TEST_F(MeasureCommand, TruthOfAnotherKnownUnit_IsConverted) {
    scanmill({"convert", "sphere.ply", "metres.ply", "--unit", "mm", "--to-unit", "m"});
    scanmill({"convert", "sphere.ply", "millimetres.ply", "--unit", "mm"});
    for (const std::vector<std::string>& files : {std::vector<std::string>{"millimetres.ply", "metres.ply"},
                                                  {"sphere.ply", "metres.ply", "--unit", "mm", "--truth-unit", "m"}}) {
        std::vector<std::string> arguments{"measure", "--json"};
        arguments.insert(arguments.end(), files.begin(), files.end());
        const ProgramResult ran = scanmill(arguments);
        ASSERT_EQ(ran.exit_code, 0) << ran.err;
        const json printed = json::parse(ran.out);
        EXPECT_EQ(printed["unit"], "mm");
        EXPECT_LT(printed["metrics"]["hausdorff"].get<double>(), 1e-12);
        EXPECT_EQ(printed["units"]["hausdorff"], "length");
    }
    EXPECT_EQ(scanmill({"measure", "sphere.ply", "metres.ply", "--unit", "mm"}).exit_code, 0) << "that of the mesh";
    EXPECT_EQ(scanmill({"measure", "sphere.ply", "sphere.ply", "--unit", "banana"}).exit_code, 2);
    EXPECT_EQ(scanmill({"measure", "sphere.ply", "sphere.ply", "--truth-unit", "banana"}).exit_code, 2);
}

TEST_F(MeasureCommand, TruthOfAnotherSize_IsNotScored) {
    scanmill({"convert", "sphere.ply", "metres.ply", "--unit", "mm", "--to-unit", "m"});
    const ProgramResult refused = scanmill({"measure", "sphere.ply", "metres.ply", "--unit", "m"});
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_EQ(refused.out, "");
    EXPECT_THAT(refused.err, HasSubstr("1000"));
    const ProgramResult trusted =
        scanmill({"measure", "sphere.ply", "metres.ply", "--unit", "m", "--set", "same-frame=true"});
    EXPECT_EQ(trusted.exit_code, 0);
    EXPECT_THAT(trusted.err, HasSubstr("measured anyway"));
}

TEST_F(MeasureCommand, UnitThatOnlyOneOfBothDeclares_IsNotGuessed) {
    scanmill({"convert", "sphere.ply", "millimetres.ply", "--unit", "mm"});
    const ProgramResult mesh = scanmill({"measure", "sphere.ply", "millimetres.ply"});
    EXPECT_EQ(mesh.exit_code, 1);
    EXPECT_THAT(mesh.err, HasSubstr("the mesh has no unit, the truth is in mm"));
    EXPECT_THAT(mesh.err, HasSubstr(": --unit mm"));
    EXPECT_EQ(scanmill({"measure", "sphere.ply", "millimetres.ply", "--unit", "mm"}).exit_code, 0);
    const ProgramResult truth = scanmill({"measure", "millimetres.ply", "sphere.ply"});
    EXPECT_EQ(truth.exit_code, 1);
    EXPECT_THAT(truth.err, HasSubstr("the mesh is in mm, the truth has no unit"));
    EXPECT_THAT(truth.err, HasSubstr("--truth-unit mm"));
    EXPECT_EQ(scanmill({"measure", "millimetres.ply", "sphere.ply", "--truth-unit", "mm"}).exit_code, 0);
}

TEST_F(MeasureCommand, Step_ExpectsAndWritesItsNumbers) {
    const ProgramResult ran = run();
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json written = json::parse(content_of(folder_ / "out/sphere.json"));
    EXPECT_EQ(written["scanmill"], 1);
    EXPECT_EQ(written["unit"], nullptr);
    EXPECT_NEAR(written["metrics"]["hausdorff"].get<double>(), 0.1, 1e-3);
    EXPECT_EQ(written["units"]["hausdorff"], "length");
    const json step = json::parse(scanmill({"runs", "out", "show", "1", "--json"}).out)["steps"].back();
    EXPECT_NEAR(step["metrics"]["threshold@2"].get<double>(), 0.01 * 2 * std::sqrt(3.0), 1e-2);
}

TEST_F(MeasureCommand, Expectations_AreComparedAfreshWhenTheNumbersAreCached) {
    ASSERT_EQ(run({"--keep", "always"}).exit_code, 0);
    folder_.write("w.yaml", workflow("mean: < 0.1 %diag, f-score@2: '> 99 %'"));
    const ProgramResult again = run({"--keep", "always"});
    EXPECT_EQ(again.exit_code, 1);
    EXPECT_THAT(again.err + again.out,
                AllOf(HasSubstr("expected mean < 0.1 %diag"), HasSubstr("expected f-score@2 > 99 %")));
    EXPECT_THAT(scanmill({"runs", "out", "show", "2"}).out, HasSubstr("cached"));
    folder_.write("w.yaml", workflow("mean: < 1 spacing"));
    EXPECT_THAT(run().err, HasSubstr("spacing is not defined for metrics"));
}

TEST_F(MeasureCommand, Deviation_IsWiredByItsNameAlone) {
    const auto with = [&](const std::string& more) {
        folder_.write("w.yaml",
                      "scanmill: 1\nname: w\ninputs:\n  mesh: mesh\n  truth: mesh\nsteps:\n"
                      "  - edge-flip:\n    in: {mesh: mesh}\n"
                      "  - measure: {samples: 1000}\n    in: {mesh: edge-flip, truth: truth}\n" +
                          more);
    };
    with("  - features:\noutputs:\n  \"{scan}-deviation.ply\": measure.deviation\n  \"{scan}.json\": measure\n");
    const std::string plan = scanmill({"check", "w.yaml", "--plan"}).out;
    EXPECT_THAT(plan, HasSubstr("features\n        mesh <- edge-flip\n"));
    ASSERT_EQ(run().exit_code, 0);
    EXPECT_TRUE(json::parse(content_of(folder_ / "out/sphere.json")).contains("metrics")) << "the primary output";
    const json info = json::parse(scanmill({"info", "out/sphere-deviation.ply", "--json"}).out)["files"][0];
    ASSERT_EQ(info["columns"].size(), 1u);
    EXPECT_EQ(info["columns"][0]["name"], "distance-to-truth");
    // A length: written in thousandths, it is a thousand times as large.
    scanmill({"convert", "out/sphere-deviation.ply", "small.ply", "--unit", "m", "--to-unit", "mm"});
    const auto values = [&](const char* file) {
        const auto mesh = read_mesh(folder_ / file);
        const auto column = mesh->vertex_columns.find("distance-to-truth")->values<double>();
        return std::vector<double>(column.begin(), column.end());
    };
    const std::vector<double> one = values("out/sphere-deviation.ply"), thousand = values("small.ply");
    const auto [least, most] = std::ranges::minmax(one);
    EXPECT_NEAR(least, -0.1, 2e-3);
    EXPECT_NEAR(most, 0.1, 2e-3);
    ASSERT_EQ(one.size(), thousand.size());
    for (std::size_t i = 0; i < one.size(); ++i) EXPECT_DOUBLE_EQ(thousand[i], 1000 * one[i]);

    with("  - features:\n    in: {mesh: measure.deviation}\n");
    EXPECT_THAT(scanmill({"check", "w.yaml", "--plan"}).out, HasSubstr("mesh <- measure.deviation\n"));
}

TEST_F(MeasureCommand, DeviationThatNothingUses_IsNotCached) {
    const auto values = [&] {
        return json::parse(scanmill({"cache", "info", "--cache", "cache", "--json"}).out)["values"].get<int>();
    };
    ASSERT_EQ(run({"--keep", "always"}).exit_code, 0);
    const int before = values();
    folder_.write("w.yaml", workflow("mean: < 5 %diag") + "  \"{scan}-deviation.ply\": measure.deviation\n");
    for (int i = 0; i < 2; ++i) {
        ASSERT_EQ(run({"--keep", "always"}).exit_code, 0);
        EXPECT_EQ(values(), before + 1);
    }
    const json steps = json::parse(scanmill({"runs", "out", "show", "3", "--json"}).out)["steps"];
    EXPECT_EQ(steps.back()["origin"], "cached");
}

TEST_F(MeasureCommand, TruthIsNeverGuessed) {
    folder_.write("w.yaml",
                  "scanmill: 1\nname: w\ninputs:\n  mesh: mesh\nsteps:\n  - measure:\noutputs:\n  \"{scan}.json\": "
                  "measure\n");
    const ProgramResult unsaid = scanmill({"check", "w.yaml"});
    EXPECT_EQ(unsaid.exit_code, 2);
    EXPECT_THAT(unsaid.err + unsaid.out, ContainsRegex("port 'truth'.* mesh or points .*`in:"));
    folder_.write(
        "w.yaml",
        "scanmill: 1\nname: w\ninputs:\n  scan: points\nsteps:\n  - delaunay:\n  - alpha-solid:\n  - measure:\n"
        "    in: {truth: delaunay}\n");
    EXPECT_THAT(scanmill({"check", "w.yaml"}).err, ContainsRegex("'delaunay' is tets.* 'truth' .*mesh or points"));
}

TEST_F(MeasureCommand, JsonIsNoScan) {
    folder_.write("numbers.json", "{}");
    EXPECT_THAT(scanmill({"info", "numbers.json"}).err, HasSubstr("is JSON without a member that names its kind"));
}

}  // namespace
}  // namespace scanmill::test
