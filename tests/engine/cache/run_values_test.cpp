// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/cache/run_values.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scanmill/base/error.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

Value two_points() {
    PointCloud cloud;
    cloud.positions = {Vec3(1, 2, 3), Vec3(4, 5, 6)};
    return std::make_shared<const PointCloud>(std::move(cloud));
}

std::size_t files_in(const std::filesystem::path& folder) {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

TEST(RunValues, ValueStaysUntilItIsRemoved_InMemoryAndInFiles) {
    const TemporaryFolder folder;
    for (RunValues values : {RunValues(), RunValues(std::filesystem::path(folder.path()))}) {
        EXPECT_FALSE(values.find({7, "points"}));
        values.put({7, "points"}, EncodedValue(two_points()));
        values.put({8, ""}, EncodedValue(two_points()));
        EXPECT_TRUE(values.contains({7, "points"}));
        EXPECT_FALSE(values.contains({7, "mesh"}));
        const std::optional<Value> found = values.find({7, "points"});
        ASSERT_TRUE(found);
        values.remove({7, "points"});
        EXPECT_FALSE(values.contains({7, "points"}));
        EXPECT_EQ(found->find<PointCloud>()->positions[1], Vec3(4, 5, 6)) << "it is in use";
        EXPECT_TRUE(values.contains({8, ""})) << "equal values have their own file";
        values.remove({8, ""});
        EXPECT_EQ(files_in(folder.path()), 0u);
    }
}

TEST(RunValues, FilesAreSharedByAllThatNameTheFolder) {
    const TemporaryFolder folder;
    RunValues one(folder.path());
    const RunValues other(folder.path());
    one.put({0, ""}, EncodedValue(two_points()));
    EXPECT_TRUE(other.find({0, ""}));
}

TEST(RunValues, FolderThatCannotBeWritten_IsAnErrorThatNamesTheWayOut) {
    const TemporaryFolder folder;
    RunValues values(folder / "missing");
    try {
        values.put({0, ""}, EncodedValue(two_points()));
        FAIL();
    } catch (const Error& error) {
        EXPECT_THAT(error.sentence(), testing::HasSubstr("cannot be passed to the next step"));
        EXPECT_THAT(error.hint(), testing::HasSubstr("TMPDIR"));
    }
}

}  // namespace
}  // namespace scanmill::test
