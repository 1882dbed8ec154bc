// SPDX-License-Identifier: GPL-3.0-or-later
/// Cropping a file in chunks gives the result of cropping the scan in memory, bit for bit.

#include <gmock/gmock.h>

#include "filters/crop/cases.hpp"
#include "scanmill/formats/files.hpp"
#include "support/point_files.hpp"
#include "support/real_data.hpp"
#include "support/same_points.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;

Cropped cropped_stream(const std::filesystem::path& path, const CropParams& params, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    const auto stream = open_point_stream(path, {}, threads);
    if (!stream) throw Error("'{}' is not read in chunks", path.string());
    CropResult result = crop(*stream, params, context);
    return {std::move(result), context.metrics()};
}

void expect_as_in_memory(const std::filesystem::path& path, const CropParams& params) {
    const Cropped whole = cropped(*read_points(path), params);
    EXPECT_GT(whole.removed, 0u);
    for (const unsigned threads : {1u, 3u}) {
        const Cropped streamed = cropped_stream(path, params, threads);
        EXPECT_TRUE(same_points(streamed.points, whole.points));
        EXPECT_EQ(rows(streamed), rows(whole));
        EXPECT_EQ(streamed.metrics.values, whole.metrics.values);
    }
}

TEST(CropOfAStream, IsThatInMemory_WithColumns) {
    const TemporaryFolder folder;
    for (const Vec3& middle : {Vec3(0, 0, 0), Vec3(4e6, -5e6, 100)}) {
        const auto path = written(folder / "helix.ply", helix(300'000, middle));
        expect_as_in_memory(path, in_box(middle - Vec3(1, 0.5, 0), middle + Vec3(0.5, 2, 0.7)));
        expect_as_in_memory(path, in_ball(middle, 1.1));
    }
}

TEST(CropOfAStream, IsThatInMemory_OfText) {
    const TemporaryFolder folder;
    const auto path = written(folder / "helix.xyz", without_columns(helix(200'000, Vec3(0, 1000, 0))));
    expect_as_in_memory(path, in_ball({0, 1000, 0}, 1.2));
}

TEST(CropOfAStream, RefusesWhatIsRefusedInMemory) {
    const TemporaryFolder folder;
    const auto path = written(folder / "helix.ply", helix(100'000));
    CropParams both = in_ball({0, 0, 0}, 1);
    both.within = 1;
    for (const CropParams& params :
         {CropParams(), both, in_reach(1), in_box({0, 0, 0}, {-1, 1, 1}), in_ball({9, 9, 9}, 1)})
        EXPECT_EQ(sentence_of([&] { cropped_stream(path, params, 2); }),
                  sentence_of([&] { cropped(*read_points(path), params); }));
    EXPECT_THAT(sentence_of([&] { cropped_stream(path, in_ball({9, 9, 9}, 1)); }), HasSubstr("none of 100000 points"));
}

TEST(CropOfAStream, IsThatInMemory_OfARealScan) {
    SCANMILL_REAL_SCAN(path, shared_data, "8-derived/happy_stand_merged_1M.ply");
    const auto scan = read_points(path);
    const BoundingBox box = bounding_box(scan->positions.span());
    const Vec3 low = scan->frame.origin + box.low, high = scan->frame.origin + box.high;
    expect_as_in_memory(path, in_box(low, (low + high) / 2));
}

}  // namespace
}  // namespace scanmill::test
