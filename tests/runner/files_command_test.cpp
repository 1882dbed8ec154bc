// SPDX-License-Identifier: GPL-3.0-or-later
// What the command says about files: shifts of far STL files, files larger than memory, compressed files, columns.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "scanmill/formats/files.hpp"
#include "support/folders.hpp"
#include "support/gzip.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

class FilesCommand : public testing::Test {
protected:
    ProgramResult scanmill(std::vector<std::string> arguments) {
        return scanmill_program(arguments, {.folder = folder_.path()});
    }
    /// Points of a sphere of radius 5, by a spiral.
    std::string sphere(const Vec3& centre) const {
        std::string text;
        constexpr int points = 4000;
        for (int i = 0; i < points; ++i) {
            const double z = (2 * i + 1.0) / points - 1, turn = i * std::numbers::pi * (3 - std::sqrt(5.0));
            const double ring = std::sqrt(1 - z * z);
            text += fmt::format("{:.6f} {:.6f} {:.6f} {}\n", centre.x() + 5 * ring * std::cos(turn),
                                centre.y() + 5 * ring * std::sin(turn), centre.z() + 5 * z, i % 7);
        }
        return text;
    }

    TemporaryFolder folder_;
};

TEST_F(FilesCommand, ASphereAtSurveyCoordinates_IsWrittenClosed_WithItsShiftBesideIt) {
    folder_.write("far.xyz", sphere(Vec3(500000, 4500000, 300)));
    const std::string quickstart = test::source_folder() + "/workflows/quickstart.yaml";
    const ProgramResult ran = scanmill({"run", quickstart, "far.xyz", "-o", "out", "--no-cache"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_THAT(ran.err, HasSubstr("relative to 500000 4500000 0:"));
    EXPECT_THAT(ran.err, HasSubstr("STL left out 1 column of the vertices (c4)")) << "the filter's own need no warning";
    const json described = json::parse(content_of(folder_ / "out/far.stl.json"));
    EXPECT_EQ(described["file"]["shift"], json({500000.0, 4500000.0, 0.0}));
    EXPECT_EQ(described["file"]["properties"]["closed"], true);
    EXPECT_THAT(scanmill({"info", "out/far.stl"}).out, HasSubstr("closed          yes"));
}

TEST_F(FilesCommand, Convert_GivesTheSameWarningOfAShift_AndNoneNearZero) {
    folder_.write("far.off",
                  "OFF\n4 4 0\n500000 4500000 300\n500000.1 4500000 300\n500000 4500000.1 300\n500000 "
                  "4500000 300.1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n");
    const ProgramResult far = scanmill({"convert", "far.off", "far.stl"});
    EXPECT_EQ(far.exit_code, 0);
    EXPECT_THAT(far.err, HasSubstr("relative to 500000 4500000 300"));
    EXPECT_THAT(scanmill({"info", "far.stl"}).out, HasSubstr("closed          yes"));
    folder_.write("near.off", "OFF\n3 1 0\n0 0 0\n0.1 0 0\n0 0.1 0\n3 0 1 2\n");
    EXPECT_EQ(scanmill({"convert", "near.off", "near.stl"}).err, "");
}

TEST_F(FilesCommand, InfoOfAMeshLargerThanMemory_IsRefusedAtOnce) {
    constexpr std::uint32_t facets = 4'000'000'000;
    {
        std::ofstream file(folder_ / "huge.stl", std::ios::binary);
        file << std::string(80, ' ');
        file.write(reinterpret_cast<const char*>(&facets), sizeof facets);
    }
    std::error_code unsupported;
    std::filesystem::resize_file(folder_ / "huge.stl", 84 + 50 * std::uintmax_t(facets), unsupported);
    if (unsupported) GTEST_SKIP() << "no file of 200 GB: " << unsupported.message();
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"info", "huge.stl"}, {"convert", "huge.stl", "huge.ply"}}) {
        const ProgramResult result = scanmill(command);
        EXPECT_EQ(result.exit_code, 1);
        EXPECT_THAT(result.err, AllOf(ContainsRegex("error: 'huge.stl': .*186 GiB.* 373 GiB"),
                                      HasSubstr("hint: thin or split it")));
    }
}

TEST_F(FilesCommand, ACompressedScan_IsReadAndNamesItsOutputs) {
    folder_.write("ball.xyz.gz", gzipped(sphere(Vec3::Zero())));
    folder_.write("thin.yaml",
                  "scanmill: 1\ninputs: {scan: points}\nsteps: [{voxel-thin: {bin-size: 2 u}}]\noutputs: "
                  "{'{scan}.ply': voxel-thin}\n");
    const ProgramResult ran = scanmill({"run", "thin.yaml", "ball.xyz.gz", "-o", "out", "--no-cache"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out/ball.ply"));
    EXPECT_THAT(scanmill({"info", "ball.xyz.gz"}).out,
                AllOf(HasSubstr("ascii, gzip"), HasSubstr("points          4000")));
}

TEST_F(FilesCommand, AnInputThatIsReadTwice_WarnsOnce) {
    folder_.write("a.xyz", "# unit parsec\n0 0 0\n1 0 0\n0 1 0\n");
    folder_.write("two.yaml",
                  "scanmill: 1\ninputs: {one: points, other: {kind: points, frame: part}}\nsteps:\n  - id: a\n    "
                  "voxel-thin: {bin-size: 2 u}\n    in: {points: one}\n  - id: b\n    voxel-thin: {bin-size: 3 u}\n    "
                  "in: {points: other}\noutputs: {'{scan}-a.ply': a, '{scan}-b.ply': b}\n");
    const ProgramResult ran = scanmill({"run", "two.yaml", "a.xyz", "--in", "other=a.xyz", "-o", "out", "--no-cache"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    const std::size_t first = ran.err.find("parsec");
    ASSERT_NE(first, std::string::npos);
    EXPECT_EQ(ran.err.find("parsec", first + 1), std::string::npos) << ran.err;
}

}  // namespace
}  // namespace scanmill::test
