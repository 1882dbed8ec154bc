// SPDX-License-Identifier: GPL-3.0-or-later
// Which files of a cell are what, by the wiring in its records.
#include "scanmill/session/cell_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/folders.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

StepRecord read_step(std::size_t node, const std::string& file, const std::string& unit = "") {
    StepRecord step;
    step.node = node;
    step.file = file;
    if (!unit.empty()) step.authored = {{"unit", unit}};
    return step;
}
StepRecord filter_step(std::size_t node, const std::string& filter, std::vector<InputRecord> inputs) {
    StepRecord step;
    step.node = node;
    step.filter = filter;
    step.inputs = std::move(inputs);
    return step;
}
OutputRecord output_of(std::size_t step, const std::string& port, const std::string& file, const std::string& kind,
                       Outcome outcome = Outcome::ok) {
    OutputRecord output;
    output.step = step;
    output.port = port;
    output.file = file;
    output.kind = kind;
    output.outcome = outcome;
    output.properties.unit = LengthUnit::millimetre;
    return output;
}

class CellFilesTest : public testing::Test {
protected:
    CellFiles files() {
        steps_ = steps_by_node(run_);
        for (const StepRecord& step : run_.steps) cell_.nodes.push_back(step.node);
        return {cell_, steps_, library_};
    }
    FilterLibrary library_{{plugin_folder()}};
    RunDetails run_;
    CellRecord cell_;
    StepsByNode steps_;
};

TEST_F(CellFilesTest, TruthIsTheFileAtTheTruthsInput_NotTheLastThatIsRead) {
    run_.steps = {read_step(0, "scan.ply"), read_step(1, "model.stl", "in"), read_step(2, "poses.json"),
                  filter_step(3, "measure", {{"mesh", 0, ""}, {"truth", 1, ""}})};
    const CellFiles files = this->files();
    EXPECT_EQ(files.scan().path, "scan.ply");
    EXPECT_EQ(files.truth().path, "model.stl");
    EXPECT_EQ(files.truth().unit, LengthUnit::inch);
    EXPECT_EQ(files.scan().unit, LengthUnit::unknown);
    EXPECT_FALSE(files.inspection());
}

TEST_F(CellFilesTest, TruthThatAStepMakes_IsItsWrittenOutput) {
    run_.steps = {filter_step(0, "virtual-scan", {}),
                  filter_step(1, "measure", {{"mesh", 5, ""}, {"truth", 0, "surface"}})};
    cell_.outputs = {output_of(0, "points", "scan.ply", "points"), output_of(0, "surface", "model.ply", "mesh")};
    EXPECT_EQ(files().truth().path, "model.ply");
    EXPECT_EQ(files().scan().path, "");
    cell_.outputs[1].outcome = Outcome::failed;
    EXPECT_EQ(files().truth().path, "") << "it was not written";
}

TEST_F(CellFilesTest, DeviationMapIsTheBestOutputThatWasWritten_AlsoBelowFailed) {
    run_.steps = {read_step(0, "scan.ply"), read_step(1, "nominal.stl"),
                  filter_step(2, "inspect", {{"scan", 0, ""}, {"nominal", 1, ""}}),
                  filter_step(3, "render", {{"scene", 2, "deviation"}}), filter_step(4, "render", {{"scene", 0, ""}})};
    cell_.outputs = {output_of(2, "deviation", "deviation.ply", "points"),
                     output_of(2, "on-nominal", "on-nominal.ply", "mesh", Outcome::skipped),
                     output_of(3, "picture", "deviation.png", "picture"),
                     output_of(4, "picture", "scan.png", "picture")};
    const CellFiles files = this->files();
    const InspectionStep inspection = files.inspection();
    ASSERT_TRUE(inspection);
    EXPECT_EQ(files.truth().path, "nominal.stl");
    EXPECT_EQ(files.deviation_map(inspection)->file, "deviation.ply");
    cell_.outputs[1].evidence = "failed/on-nominal.ply";
    EXPECT_EQ(path_of(*files.deviation_map(inspection)), "failed/on-nominal.ply");
    EXPECT_EQ(path_of(*files.mesh()), "failed/on-nominal.ply");
    EXPECT_THAT(files.pictures_of(*inspection.step), ElementsAre(&cell_.outputs[2])) << "not that of the scan";
    cell_.outputs.clear();
    EXPECT_EQ(files.deviation_map(inspection), nullptr);
    EXPECT_THAT(files.pictures_of(*inspection.step), IsEmpty());
}

}  // namespace
}  // namespace scanmill::test
