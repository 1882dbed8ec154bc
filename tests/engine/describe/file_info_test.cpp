// SPDX-License-Identifier: GPL-3.0-or-later
// The description of files that do not fit into memory.
#include "scanmill/describe/file_info.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scanmill/formats/files.hpp"
#include "support/point_files.hpp"
#include "support/shapes.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using Json = nlohmann::ordered_json;

TEST(FileInfo, OfPointsLargerThanMemory_IsThatOfTheWholeFile_WithoutTheSpacing) {
    const TemporaryFolder folder;
    PointCloud cloud;
    cloud.frame.unit = LengthUnit::metre;
    cloud.positions = {Vec3(1e6, 0, 3), Vec3(1e6 + 2, 5, 3.5), Vec3(1e6, 7, 3)};
    cloud.columns.add(Column("ring", 1, Buffer<u8>{1, 2, 3}));
    write_file(folder / "a.ply", std::make_shared<const PointCloud>(cloud));
    const std::string file = (folder / "a.ply").string();
    const Json whole = file_info(file), streamed = file_info(file, 1);
    for (const char* key :
         {"file", "kind", "points", "columns", "low", "high", "diagonal", "not-finite", "unit", "origin"})
        EXPECT_EQ(streamed.at(key), whole.at(key)) << key;
    EXPECT_TRUE(whole.contains("spacing"));
    EXPECT_FALSE(streamed.contains("spacing"));
    EXPECT_THAT(streamed.at("warnings").at(0).get<std::string>(), HasSubstr("read in chunks"));
}

TEST(FileInfo, OfAMeshLargerThanMemory_IsRefusedWithBothNumbers) {
    const TemporaryFolder folder;
    write_file(folder / "a.stl", std::make_shared<const TriangleMesh>(cube(1)));
    const Error error = error_of([&] { file_info((folder / "a.stl").string(), 100); });
    EXPECT_THAT(error.sentence(), AllOf(HasSubstr("it has 684 B"), HasSubstr("1.34 KiB"), HasSubstr("100 B are")));
    EXPECT_THAT(error.hint(), HasSubstr("thin or split"));
}

TEST(FileInfo, OfPointsThatCannotBeStreamed_IsRefused) {
    const TemporaryFolder folder;
    folder.write("a.xyz", "1 2 3\n4 5 nan\n");
    EXPECT_THROW(file_info((folder / "a.xyz").string(), 1), Error);
    folder.write("b.las", "LASF");
    EXPECT_THROW(file_info((folder / "b.las").string(), 1), Error);
}

}  // namespace
}  // namespace scanmill::test
