// SPDX-License-Identifier: GPL-3.0-or-later
// PCD through its module: writing, and reading back without a change.

#include "formats/pcd_files.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

PointCloud every_column() {
    PointCloud cloud;
    cloud.frame = {LengthUnit::millimetre, Vec3::Zero(), "bench"};
    cloud.positions = {Vec3(1, 2, 3), Vec3(4, 5, 6)};
    cloud.columns.add(Column("normal", 3, Buffer<float>{0, 0, 1, 0, 1, 0}));
    cloud.columns.add(Column("colour", 4, Buffer<u8>{1, 2, 3, 4, 5, 6, 7, 8}));
    cloud.columns.add(Column("time", 1, Buffer<double>{0.1, 0.2}));
    cloud.columns.add(Column("ring", 1, Buffer<std::uint16_t>{7, 9}));
    cloud.columns.add(Column("offset", 1, Buffer<std::int8_t>{-7, 9}));
    cloud.columns.add(Column("histogram", 3, Buffer<float>{1, 2, 3, 4, 5, 6}));
    return cloud;
}

TEST(PcdWriter, EveryColumn_IsReadBackUnchanged) {
    const TemporaryFolder folder;
    const PointCloud cloud = every_column();
    Warnings warnings;
    write_file(folder / "a.pcd", std::make_shared<const PointCloud>(cloud), warnings.writing());
    const auto back = read_points(folder / "a.pcd");
    EXPECT_EQ(rows_of(back->positions), rows_of(cloud.positions));
    EXPECT_EQ(back->columns, cloud.columns);
    EXPECT_EQ(back->frame, cloud.frame);
    EXPECT_THAT(warnings.sentences, IsEmpty());
}

TEST(PcdWriter, Positions_AreDoublesOnlyWhereFloatsAreInexact) {
    const TemporaryFolder folder;
    PointCloud cloud;
    cloud.frame.origin = Vec3(5e6, 0, 0);
    cloud.positions = {Vec3(1e-6, 0.1, 0), Vec3(1, 0.2, 0)};
    write_file(folder / "a.pcd", std::make_shared<const PointCloud>(cloud));
    EXPECT_THAT(content_of(folder / "a.pcd"), HasSubstr("SIZE 8 8 8"));
    const auto back = read_points(folder / "a.pcd");
    EXPECT_EQ(Vec3(back->frame.origin + back->positions[0]), Vec3(5e6 + 1e-6, 0.1, 0));
    cloud.frame.origin = Vec3::Zero();
    cloud.positions = {Vec3(1, 0.5, 0)};
    write_file(folder / "b.pcd", std::make_shared<const PointCloud>(cloud));
    EXPECT_THAT(content_of(folder / "b.pcd"), HasSubstr("SIZE 4 4 4"));
}

TEST(PcdWriter_Losses, NamesReservedByPcd_AreChangedWithAWarning) {
    const TemporaryFolder folder;
    Warnings warnings;
    PointCloud cloud;
    cloud.positions = {Vec3(1, 2, 3)};
    for (const char* name : {"_", "normal_x", "rgb", "a b", "a_b", "plain"})
        cloud.columns.add(Column(name, 1, Buffer<float>{7}));
    write_file(folder / "a.pcd", std::make_shared<const PointCloud>(cloud), warnings.writing());
    EXPECT_EQ(warnings.sentences.size(), 5u);
    const auto back = read_points(folder / "a.pcd");
    EXPECT_EQ(back->columns.size(), 6u);
    for (const char* name : {"__2", "normal_x_2", "rgb_2", "a_b", "a_b_2", "plain"})
        EXPECT_TRUE(back->columns.find(name)) << name;
}

TEST(PcdWriter_Losses, ListsAreReported) {
    const TemporaryFolder folder;
    Warnings warnings;
    PointCloud cloud;
    cloud.positions = {Vec3(1, 2, 3)};
    cloud.columns.add(Column("seen_by", Buffer<u64>{0, 2}, Buffer<u32>{4, 5}));
    write_file(folder / "a.pcd", std::make_shared<const PointCloud>(cloud), warnings.writing());
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("the lists of the column 'seen_by'")));
}

}  // namespace
}  // namespace scanmill::test
