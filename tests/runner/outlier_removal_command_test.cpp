// SPDX-License-Identifier: GPL-3.0-or-later
// outlier-removal at its defaults in workflows, as their users see it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "scanmill/formats/files.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;

class OutlierRemovalCommand : public testing::Test {
protected:
    OutlierRemovalCommand() {
        folder_.write("clean.yaml",
                      "scanmill: 1\ninputs: {scan: points}\nsteps:\n  - outlier-removal:\n"
                      "outputs:\n  \"{scan}-clean.xyz\": outlier-removal\n");
    }
    ProgramResult run(const std::string& scan) const {
        return scanmill_program({"run", "clean.yaml", scan, "-o", "out", "--no-cache"}, {.folder = folder_.path()});
    }
    TemporaryFolder folder_;
};

TEST_F(OutlierRemovalCommand, EveryPointTwice_TheRadiusIsThatOfTheDistinctPositions) {
    // The spacing of such a scan is 0, so `3 spacing` has no length for other filters.
    std::string text;
    for (int i = 0; i < 400; ++i)
        for (int twice = 0; twice < 2; ++twice) text += std::to_string(i % 20) + " " + std::to_string(i / 20) + " 0\n";
    folder_.write("twice.xyz", text + "10 10 100\n");
    const ProgramResult ran = run("twice.xyz");
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(read_points(folder_ / "out/twice-clean.xyz")->size(), 800u);
}

TEST_F(OutlierRemovalCommand, OnePoint_Stays) {
    folder_.write("one.xyz", "1 2 3\n");
    const ProgramResult ran = run("one.xyz");
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(read_points(folder_ / "out/one-clean.xyz")->size(), 1u);
}

TEST_F(OutlierRemovalCommand, NotANumber_IsRefusedWhereTheScanIsRead) {
    folder_.write("bad.xyz", "1 2 3\nnan 0 0\n");
    const ProgramResult ran = run("bad.xyz");
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_THAT(ran.err, HasSubstr("1 of 2 points"));
    EXPECT_THAT(ran.err, HasSubstr("--invalid drop"));
}

}  // namespace
}  // namespace scanmill::test
