// SPDX-License-Identifier: GPL-3.0-or-later
// `scanmill run --picture` draws the last surface of every cell beside its file.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "scanmill/data/picture.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/kinds/value.hpp"
#include "support/folders.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;

constexpr const char* ball = R"(scanmill: 1
name: ball
parameters: {most: {default: 10, help: Most boundary loops.}}
steps:
  - virtual-scan: {shape: sphere, size: 1 u, views: [12], resolution: 0.1 u}
  - delaunay:
  - id: surface
    alpha-solid:
    expect: {boundary-loops: "< $most"}
outputs:
  "ball.ply": surface
  "points.ply": virtual-scan
)";

std::shared_ptr<const Picture> picture_in(const std::filesystem::path& file) {
    return read_file(file).value.get<Picture>();
}

TEST(PictureOption, Surface_IsDrawnBesideItsFile_AndTheSameFromTheCache) {
    const TemporaryFolder folder;
    folder.write("ball.yaml", ball);
    const auto run = [&](const std::string& out) {
        const ProgramResult ran = scanmill_program({"run", "ball.yaml", "--picture", "-o", out, "--cache", "cache"},
                                                   {.folder = folder.path()});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        return picture_in(folder.path() / out / "ball.png");
    };
    const auto first = run("first"), second = run("second");
    EXPECT_EQ(first->width, 800u);
    EXPECT_EQ(first->height, 600u);
    EXPECT_THAT(first->caption, HasSubstr("triangles"));
    EXPECT_TRUE(std::ranges::equal(first->pixels, second->pixels));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "first/points.png")) << "points are not a surface";
}

TEST(PictureOption, SurfaceThatMissesACondition_IsDrawnBelowFailed) {
    const TemporaryFolder folder;
    folder.write("ball.yaml", ball);
    const ProgramResult ran = scanmill_program(
        {"run", "ball.yaml", "--picture", "-o", "out", "--no-cache", "--set", "most=0"}, {.folder = folder.path()});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_THAT(ran.err, HasSubstr("expected boundary-loops < 0, found 0"));
    EXPECT_EQ(picture_in(folder.path() / "out/failed/ball.png")->width, 800u);
}

TEST(PictureOption, WorkflowWithoutAnythingToDraw_IsRefused) {
    const TemporaryFolder folder;
    folder.write("numbers.yaml", R"(scanmill: 1
name: numbers
steps:
  - virtual-scan: {shape: sphere, size: 1 u, views: [2], resolution: 0.2 u}
  - delaunay:
outputs: {"cells.vtu": delaunay}
)");
    const ProgramResult ran =
        scanmill_program({"run", "numbers.yaml", "--picture", "-o", "out"}, {.folder = folder.path()});
    EXPECT_EQ(ran.exit_code, 2);
    EXPECT_THAT(ran.err, HasSubstr("no output for a picture"));
}

}  // namespace
}  // namespace scanmill::test
