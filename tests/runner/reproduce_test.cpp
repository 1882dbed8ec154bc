// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/reproduce.hpp"

#include <gtest/gtest.h>

#include "engine/compare/made_runs.hpp"

namespace scanmill::runner {
namespace {

using test::add_cell;
using test::made_run;
using test::run_of_one;

TEST(ReproducingCommand, OfABatch_NamesScanAndVariant) {
    RunDetails now = run_of_one(2, 0.9, {{"hausdorff", "+1 %", {}}});
    EXPECT_EQ(reproducing_command(now, now.cells[0], "scans/a.ply"),
              "scanmill batch jobs/nightly.yaml --scan scans/a.ply --only default -o reproduced");
    now.start.seed = 7;
    add_cell(now, "jobs/it's \"b\"\n.ply").workflow = "other";
    now.cells[1].outcome = Outcome::failed;
    const Comparison comparison = compare(now, nullptr, reproducing_command);
    EXPECT_EQ(comparison.cells[1].command,
              "scanmill batch jobs/nightly.yaml --scan $'it\\'s \"b\"\\n.ply' --workflow other --seed 7 --only default "
              "-o reproduced");
}

TEST(ReproducingCommand, OfARun_KeepsWhatDecidesResults) {
    RunDetails run = made_run(1);
    run.start.file = "w.yaml";
    run.start.arguments = {"scanmill", "run", "w.yaml", "a.ply", "b.ply",     "--set", "x=1 mm",
                           "-o",       "out", "--unit", "mm",    "--threads", "2",     "--set=y=2"};
    CellRecord& cell = add_cell(run, "b.ply", "fine");
    cell.workflow = "w";
    EXPECT_EQ(reproducing_command(run, cell, "b.ply"),
              "scanmill run w.yaml b.ply --set 'x=1 mm' --unit mm --set=y=2 --only fine -o reproduced");
    cell.scan = "w";
    EXPECT_EQ(
        reproducing_command(run, cell, "w"),
        "scanmill run w.yaml a.ply b.ply --set 'x=1 mm' --unit mm --threads 2 --set=y=2 --only fine -o reproduced");
}

TEST(ReproducingCommand, OfARunWithAPicture_DrawsIt) {
    RunDetails run = made_run(1);
    run.start.file = "w.yaml";
    run.start.arguments = {"scanmill", "run", "w.yaml", "--picture", "a.ply", "b.ply"};
    const CellRecord& cell = add_cell(run, "b.ply", "fine");
    run.cells.back().workflow = "w";
    EXPECT_EQ(reproducing_command(run, cell, "b.ply"), "scanmill run w.yaml b.ply --picture --only fine -o reproduced");
}

TEST(QuotedWord, AnyName_IsOneWordOnOneLine) {
    EXPECT_EQ(quoted_word("a/b.ply"), "a/b.ply");
    EXPECT_EQ(quoted_word("a b"), "'a b'");
    EXPECT_EQ(quoted_word("it's"), "'it'\\''s'");
    EXPECT_EQ(quoted_word("a\n\x1b'\\"), "$'a\\n\\x1b\\'\\\\'");
    EXPECT_EQ(quoted_word("ö\xff"), "$'ö\\xff'");
    EXPECT_EQ(quoted_word("ö"), "'ö'");
    EXPECT_EQ(quoted_word("$(rm x)"), "'$(rm x)'");
    EXPECT_EQ(quoted_word(""), "''");
}

}  // namespace
}  // namespace scanmill::runner
