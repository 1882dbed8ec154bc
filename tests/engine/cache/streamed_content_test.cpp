// SPDX-License-Identifier: GPL-3.0-or-later
// What a streamed scan is called in the cache is what its value would be called.
#include "scanmill/cache/value_file.hpp"
#include "scanmill/formats/files.hpp"

#include <gtest/gtest.h>

#include "support/point_files.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

void expect_the_values_name(const std::filesystem::path& path) {
    const EncodedValue whole(read_points(path));
    for (const unsigned threads : {1u, 3u}) {
        StreamedContent content;
        const auto stream =
            open_point_stream(path, {}, threads, [&](std::span<const Vec3> world) { content.add_world(world); });
        ASSERT_TRUE(stream) << path;
        const ValueName name = content.of(*stream, threads);
        EXPECT_EQ(name.content, whole.content()) << path << ", " << threads << " threads";
        EXPECT_EQ(name.bytes, whole.size());
    }
}

TEST(StreamedContent, OfPositionsAlone_IsThatOfTheValue) {
    const TemporaryFolder folder;
    for (const std::size_t count : {std::size_t(1), std::size_t(1) << 16, std::size_t(200'001)})
        for (const char* name : {"a.ply", "a.xyz"})
            expect_the_values_name(written(folder / name, without_columns(helix(count))));
}

TEST(StreamedContent, OfColumns_IsThatOfTheValue) {
    const TemporaryFolder folder;
    expect_the_values_name(written(folder / "a.ply", helix(150'000)));
    expect_the_values_name(written(folder / "one.ply", helix(1)));
}

TEST(StreamedContent, OfAColumnOfLengths_IsThatOfTheValue) {
    const TemporaryFolder folder;
    PointCloud cloud = without_columns(helix(1000));
    cloud.columns.add(Column("bin-size", 1, Buffer<double>(Array<double>(1000, 0.5))).with_length_exponent(1));
    expect_the_values_name(written(folder / "a.ply", cloud));
}

TEST(StreamedContent, FarFromZero_IsThatOfTheValueNearItsOrigin) {
    const TemporaryFolder folder;
    const PointCloud far = helix(150'000, Vec3(4e6, 5e6, -7e6));
    const auto path = written(folder / "a.ply", far);
    ASSERT_NE(read_points(path)->frame.origin, Vec3::Zero());
    expect_the_values_name(path);
    expect_the_values_name(written(folder / "a.xyz", without_columns(far)));
}

TEST(StreamedContent, ThePassOverPositionsAndColumns_CanBeEnded) {
    const TemporaryFolder folder;
    struct Enough {};
    for (const Vec3& middle : {Vec3(0, 0, 0), Vec3(4e6, 5e6, -7e6)}) {
        const auto path = written(folder / "a.ply", helix(150'000, middle));
        std::size_t told = 0;
        const auto learn = [&](std::size_t most) {
            StreamedContent content;
            const auto stream =
                open_point_stream(path, {}, 1, [&](std::span<const Vec3> world) { content.add_world(world); });
            told = 0;
            content.of(*stream, 1, [&] {
                if (++told > most) throw Enough{};
            });
        };
        learn(1000);
        EXPECT_EQ(told, 3u) << "one pass over three pieces";
        EXPECT_THROW(learn(0), Enough);
        EXPECT_THROW(learn(2), Enough) << "in the last";
    }
}

TEST(StreamedContent, UnitAndFrame_BelongToIt) {
    const TemporaryFolder folder;
    PointCloud cloud = helix(10);
    const auto plain = EncodedValue(std::make_shared<const PointCloud>(cloud)).content();
    cloud.frame.unit = LengthUnit::millimetre;
    cloud.frame.name = "part";
    expect_the_values_name(written(folder / "a.ply", cloud));
    EXPECT_NE(EncodedValue(read_points(folder / "a.ply")).content(), plain);
}

}  // namespace
}  // namespace scanmill::test
