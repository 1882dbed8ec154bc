// SPDX-License-Identifier: GPL-3.0-or-later
/// Thinning a file in chunks gives the result of thinning the scan in memory, bit for bit.

#include "voxel_thin/voxel_thin.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "filters/voxel_thin/cases.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/formats/files.hpp"
#include "support/peak_memory.hpp"
#include "support/real_data.hpp"
#include "support/same_points.hpp"
#include "support/shapes.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;

struct Thinned {
    VoxelThinResult result;
    Metrics metrics;
};

Thinned thinned_stream(const std::filesystem::path& path, const VoxelThinParams& params, unsigned threads) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    const auto stream = open_point_stream(path, {}, threads);
    if (!stream) throw Error("'{}' is not read in chunks", path.string());
    Thinned thinned{voxel_thin(*stream, params, context), {}};
    thinned.metrics = context.metrics();
    return thinned;
}

void expect_as_in_memory(const std::filesystem::path& path, const VoxelThinParams& params) {
    Context context;
    const VoxelThinResult whole = voxel_thin(*read_points(path), params, context);
    EXPECT_GT(whole.removed, 0u);
    for (const unsigned threads : {1u, 3u}) {
        const Thinned streamed = thinned_stream(path, params, threads);
        EXPECT_TRUE(same_points(streamed.result.points, whole.points));
        EXPECT_TRUE(std::ranges::equal(streamed.result.kept, whole.kept));
        EXPECT_EQ(streamed.result.grid_origin, whole.grid_origin);
        EXPECT_EQ(streamed.result.noise, whole.noise);
        EXPECT_EQ(streamed.metrics.values, context.metrics().values);
    }
}

/// 300,000 points on a sphere of radius 1, with a column of their numbers, at `shift`.
PointCloud sphere(const Vec3& shift) {
    PointCloud cloud = random_sphere(300'000, 4);
    cloud.positions = translated(cloud.positions, shift);
    Array<u32> number(cloud.size());
    for (u32 row = 0; row < number.size(); ++row) number[row] = row;
    cloud.columns.add(Column("number", 1, Buffer<u32>(std::move(number))));
    return cloud;
}

std::filesystem::path written(const TemporaryFolder& folder, const char* name, const PointCloud& cloud) {
    const std::filesystem::path path = folder / name;
    write_file(path, std::make_shared<const PointCloud>(cloud));
    return path;
}

TEST(VoxelThinOfAStream, IsThatInMemory_OfDoublesWithColumns) {
    const TemporaryFolder folder;
    const auto path = written(folder, "sphere.ply", sphere(Vec3(0.1, 0, 0)));
    expect_as_in_memory(path, voxels_of(0.05));
    expect_as_in_memory(path, voxels_of(0.0002));  // voxels numbered in 64 bits
    VoxelThinParams params = voxels_of(0.01);
    params.min_points = 3;
    params.margin = 0.003;
    expect_as_in_memory(path, params);
}

TEST(VoxelThinOfAStream, IsThatInMemory_FarFromZero) {
    const TemporaryFolder folder;
    expect_as_in_memory(written(folder, "sphere.ply", sphere(Vec3(4e6, 5e6, -7e6))), voxels_of(0.05));
}

TEST(VoxelThinOfAStream, IsThatInMemory_OfText) {
    const TemporaryFolder folder;
    PointCloud cloud = sphere(Vec3(0, 100, 0));
    cloud.columns = {};
    expect_as_in_memory(written(folder, "sphere.xyz", cloud), voxels_of(0.05));
}

TEST(VoxelThinOfAStream, KeepsTheFirstOfEqualPoints_AcrossChunks) {
    // Eight points equally far from the centre of a voxel, a hundred thousand times each.
    PointCloud cloud;
    Array<Vec3> positions;
    for (u32 i = 0; i < 800'000; ++i)
        positions.emplace_back(i & 1 ? 0.75 : 0.25, i & 2 ? 0.75 : 0.25, i & 4 ? 0.75 : 0.25);
    // The grid begins at the origin. Fewer points there would be stray.
    for (u32 i = 0; i < 2000; ++i) positions.emplace_back(0, 0, 0);
    cloud.positions = std::move(positions);
    const TemporaryFolder folder;
    const Thinned thinned = thinned_stream(written(folder, "a.ply", cloud), voxels_of(1), 4);
    ASSERT_EQ(thinned.result.kept.size(), 1u);
    EXPECT_EQ(thinned.result.kept[0], 0u);
}

TEST(VoxelThinOfAStream, RefusesWhatIsRefusedInMemory) {
    const TemporaryFolder folder;
    const auto path = written(folder, "sphere.ply", sphere(Vec3::Zero()));
    for (const double size : {0.0, -1.0, 1e-9})
        EXPECT_EQ(sentence_of([&] { thinned_stream(path, voxels_of(size), 1); }),
                  sentence_of([&] { thin(*read_points(path), voxels_of(size)); }));
    VoxelThinParams params = voxels_of(0.001);
    params.min_points = 1000;
    EXPECT_THAT(sentence_of([&] { thinned_stream(path, params, 1); }), HasSubstr("no point would be kept"));
}

TEST(VoxelThinOfAStream, OfManyShortRows_TakesTheMemoryOfFewChunks) {
    std::string rows;
    for (int i = 0; i < 3'000'000; ++i) {
        rows += std::to_string(i % 10) + ' ';
        rows += std::to_string(i / 10 % 10) + " 0\n";
    }
    const TemporaryFolder folder;
    const auto path = folder.write("a.xyz", rows);
    for (const unsigned threads : {1u, 2u}) {
        std::size_t kept = 0;
        const auto peak = peak_of([&] { kept = thinned_stream(path, voxels_of(1), threads).result.kept.size(); });
        EXPECT_EQ(kept, 100u);
        if (!peak) GTEST_SKIP() << "the system does not report peak memory";
#ifndef __SANITIZE_THREAD__  // which needs memory of its own for every access
        EXPECT_LT(*peak, 80 << 20) << threads << " threads";  // 76 as in the header, and the stack of a thread
#endif
    }
}

TEST(VoxelThinOfAStream, IsThatInMemory_OfARealScan) {
    SCANMILL_REAL_SCAN(path, shared_data, "8-derived/happy_stand_merged_1M.ply");
    expect_as_in_memory(path, voxels_of(0.002));
}

}  // namespace
}  // namespace scanmill::test
