// SPDX-License-Identifier: GPL-3.0-or-later
// The table that `run` prints: which columns, how wide, how many rows.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "output/run_table.hpp"
#include "output/terminal.hpp"
#include "scanmill/plan/plan.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

std::size_t widest(const std::string& text) {
    std::istringstream lines(text);
    std::size_t most = 0;
    for (std::string line; std::getline(lines, line);) most = std::max(most, runner::columns_of(line));
    return most;
}

class RunTable : public testing::Test {
protected:
    RunTable() {
        folder_.write("scan.yaml",
                      "scanmill: 1\nname: scan\nsteps:\n  - virtual-scan: {shape: sphere, size: 1 u, views: [12], "
                      "resolution: 0.1 u}\noutputs: {'a.ply': virtual-scan}\n");
        EXPECT_EQ(scanmill({"run", "scan.yaml", "-o", "."}).exit_code, 0);
        folder_.write("mesh.yaml",
                      "scanmill: 1\nname: mesh\ninputs: {scan: points}\nsteps:\n  - voxel-thin: {bin-size: 0.1 u}\n"
                      "  - id: surface\n    region-grow:\n  - measure:\n    in: {mesh: surface, truth: surface}\n"
                      "outputs: {'{scan}.ply': surface, '{scan}.json': measure}\n");
    }
    ProgramResult scanmill(const std::vector<std::string>& arguments) {
        return scanmill_program(arguments, {.folder = folder_.path(), .cache = folder_ / "home"});
    }
    TemporaryFolder folder_;
};

TEST_F(RunTable, HasTheNumbersOfTheResult_AndOfWhatMeasuresIt) {
    const std::string table = scanmill({"run", "mesh.yaml", "a.ply", "-o", "out", "-q"}).out;
    EXPECT_THAT(table, ContainsRegex("^scan   outcome  triangles  closed  genus  hausdorff .*loops.*  seconds  files"));
    EXPECT_THAT(table, AllOf(Not(HasSubstr("kept")), Not(HasSubstr("points  ")), HasSubstr("out/a.ply +1")));
    EXPECT_LE(widest(table), 100u);
}

TEST_F(RunTable, Wide_HasEveryHeadlineMetricAndEveryFile) {
    const std::string table = scanmill({"run", "mesh.yaml", "a.ply", "-o", "out", "-q", "--wide"}).out;
    EXPECT_THAT(table, AllOf(HasSubstr("points"), HasSubstr("kept"), HasSubstr("hausdorff"),
                             HasSubstr("out/a.ply, out/a.json")));
}

TEST_F(RunTable, AMetricOfTwoSteps_GetsAColumnForEach) {
    folder_.write("twice.yaml",
                  "scanmill: 1\nname: twice\ninputs: {scan: points}\nsteps:\n  - id: first\n    voxel-thin: {bin-size: "
                  "0.05 u}\n  - id: second\n    voxel-thin: {bin-size: 0.4 u}\noutputs: {'{scan}.ply': second}\n");
    EXPECT_THAT(scanmill({"run", "twice.yaml", "a.ply", "-o", "out", "-q", "--wide"}).out,
                ContainsRegex("first.kept  second.kept"));
    const std::string table = scanmill({"run", "twice.yaml", "a.ply", "-o", "out", "-q"}).out;
    EXPECT_THAT(table, AllOf(StartsWith("scan   outcome  kept  seconds  files\n"), Not(HasSubstr("first"))));
}

TEST_F(RunTable, LongNamesWithBlanksColonsAndLetters_AreCut_AndTheTableFits) {
    const std::string name = "grün: ein sehr langer Name, mit Leerzeichen " + std::string(60, 'x') + " 日本.ply";
    std::filesystem::copy(folder_ / "a.ply", folder_ / name);
    const std::string table = scanmill({"run", "mesh.yaml", "a.ply", name, "-o", "out", "-q"}).out;
    EXPECT_LE(widest(table), 100u);
    EXPECT_THAT(table, AllOf(HasSubstr("grün: "), HasSubstr("日本.ply"), HasSubstr("triangles")));
    EXPECT_THAT(scanmill({"run", "mesh.yaml", "a.ply", name, "-o", "out", "-q", "--wide"}).out, HasSubstr(name));
}

/// A run of `cells` cells without steps, all ok but the last two.
struct MadeRun {
    explicit MadeRun(std::size_t cells) {
        Plan plan;
        plan.workflow.name = "w";
        plan.variants.resize(1);
        graph.plans = {std::make_shared<const Plan>(std::move(plan))};
        for (std::size_t cell = 0; cell < cells; ++cell) {
            graph.scan_names.push_back("scans/" + std::to_string(cell) + ".ply");
            graph.cells.push_back({0, cell, 0, {}, {}});
            report.cells.emplace_back().outcome = Outcome::ok;
        }
        report.cells[cells - 2].outcome = Outcome::doubtful;
        report.cells[cells - 1].outcome = Outcome::failed;
    }
    RunGraph graph;
    RunReport report;
};

TEST(RunTableOf10000Cells, ShowsFiftyRows_TheWorstAmongThem) {
    const MadeRun run(10'000);
    const std::string table = runner::run_table(run.graph, run.report, runner::TableExtent::result);
    EXPECT_EQ(std::ranges::count(table, '\n'), 1 + 50 + 1 + 2);
    EXPECT_THAT(table, AllOf(HasSubstr("\n9998.ply  doubtful"), HasSubstr("\n9999.ply  failed"),
                             HasSubstr("and 9950 more cells; --wide prints all\n"), HasSubstr("1 of 10000 doubtful"),
                             HasSubstr("1 of 10000 failed")));
    EXPECT_EQ(std::ranges::count(runner::run_table(run.graph, run.report, runner::TableExtent::everything), '\n'),
              1 + 10'000 + 2);
}

TEST(RunTableOf40Columns, LeavesOutColumns_AndSaysSo) {
    const MadeRun run(3);
    const std::string table = runner::run_table(run.graph, run.report, runner::TableExtent::result, 30);
    EXPECT_LE(widest(table.substr(0, table.find("1 of"))), 40u);
    EXPECT_THAT(table,
                AllOf(StartsWith("scan   outcome   files\n"), HasSubstr("1 column left out; --wide prints all")));
}

}  // namespace
}  // namespace scanmill::test
