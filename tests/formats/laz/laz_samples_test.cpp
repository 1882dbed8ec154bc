// SPDX-License-Identifier: GPL-3.0-or-later
// LAZ files that other programs wrote. Counts, extremes and sums were computed with laspy and lazrs.
#include <algorithm>
#include <set>

#include "core/formats/support.hpp"
#include "support/real_data.hpp"
#include "support/same_points.hpp"

namespace scanmill::test {
namespace {

struct Sample {
    const char* file;
    std::size_t points;
    Vec3 low, high, last;
    /// Sums of intensity, return_number, number_of_returns, classification, point_source_id and user_data.
    std::array<double, 6> sums;
};

const Vec3 autzen_low{635619.85, 848899.7, 406.59}, autzen_high{638982.55, 853535.43, 586.38},
    autzen_last{637342.85, 853240.32, 423.92};
const std::array<double, 6> autzen_sums{81361, 1236, 1432, 1341, 7806350, 134663};
const Vec3 random_low{-2141890547, -2147415624, -2147101580}, random_high{2146619417, 2139249378, 2146599318},
    random_last{-1686130731, 1843512612, -1693648695};
const std::array<double, 6> random_sums{32866212, 8088, 7669, 130942, 35203431, 135880};

const std::vector<Sample> samples{
    {"6-formats/las/odd/pdal_laszip-generated_with2bytespadding.laz", 1065, autzen_low, autzen_high, autzen_last,
     autzen_sums},
    // lazrs does not read this file; the figures are those of the same points in other files.
    {"6-formats/las/odd/pdal_simple-laszip-compressor-version-1.2r0.laz", 1065, autzen_low, autzen_high, autzen_last,
     autzen_sums},
    {"6-formats/las/ok/laspy_1_4_w_evlr.laz",
     1000,
     {1694038.4456374517, 1816492.7062700584, 5592.7499174683535},
     {1694539.677014474, 1816497.9762624602, 5599.069686751426},
     {1694291.6363326558, 1816493.0662305846, 5597.089652537912},
     {38007, 1030, 1030, 2000, 202000, 0}},
    {"6-formats/las/ok/laspy_fullwave.laz",
     10750,
     {194267.419, 8249096.014, 989.944},
     {194318.295, 8249137.34, 1003.704},
     {194300.063, 8249099.341, 1000.491},
     {46997969, 17126, 23504, 0, 10782250, 10750}},
    {"6-formats/las/ok/laspy_plane.laz",
     28185,
     {1423214.52, 4189096.63, 67.86},
     {1423216.76, 4189098.6, 67.9},
     {1423214.55, 4189096.79, 67.87},
     {240588544, 28185, 28185, 0, 0, 0}},
    {"6-formats/las/ok/loadersgl_pdrf10-1.4.laz", 1024, random_low, random_high, random_last, random_sums},
    {"6-formats/las/ok/loadersgl_pdrf8-1.4.laz", 1024, random_low, random_high, random_last, random_sums},
    {"6-formats/las/ok/pdal_1.2-with-color.copc.laz",
     1065,
     autzen_low,
     autzen_high,
     {638314.34, 852793.54, 419.65},
     autzen_sums},
    {"6-formats/las/ok/pdal_simple.laz", 1065, autzen_low, autzen_high, autzen_last, autzen_sums},
    {"5-raw/lone-star.laz",
     518862,
     {515368.60225, 4918340.364, 2322.89625},
     {515401.043, 4918381.12375, 2338.5755},
     {515384.9525, 4918363.14275, 2325.02725},
     {562919835, 518862, 518862, 0, 0, 0}},
};

double sum_of(const Column& column) {
    double sum = 0;
    for (std::size_t row = 0; row < column.rows(); ++row) sum += column.number(row);
    return sum;
}

TEST(LazSamples, HaveTheirPointsExtremesAndSums_AsComputedWithAnotherReader) {
    SCANMILL_REAL_SCAN(collection, shared_data, "6-formats");
    const fs::path root = collection.parent_path();
    std::set<std::string> unknown;
    for (const auto& entry : fs::recursive_directory_iterator(root / "6-formats/las"))
        if (entry.path().extension() == ".laz") unknown.insert(fs::relative(entry.path(), root).string());
    constexpr std::array<const char*, 6> names{"intensity",      "return_number",   "number_of_returns",
                                               "classification", "point_source_id", "user_data"};
    for (const Sample& sample : samples) {
        SCOPED_TRACE(sample.file);
        unknown.erase(sample.file);
        const auto cloud = read_points(root / sample.file);
        ASSERT_EQ(cloud->size(), sample.points);
        const BoundingBox box = bounding_box(cloud->positions.span());
        // Half a unit in the last place of 10^7.
        EXPECT_LT((cloud->frame.origin + box.low - sample.low).norm(), 1e-9);
        EXPECT_LT((cloud->frame.origin + box.high - sample.high).norm(), 1e-9);
        EXPECT_LT((world_of(*cloud, cloud->size() - 1) - sample.last).norm(), 1e-9);
        for (std::size_t i = 0; i < names.size(); ++i)
            EXPECT_EQ(sum_of(*cloud->columns.find(names[i])), sample.sums[i]) << names[i];
    }
    EXPECT_THAT(unknown, testing::IsEmpty());
}

TEST(LazSamples, ThatExistUncompressed_AreEqual) {
    SCANMILL_REAL_SCAN(folder, shared_data, "6-formats/las/ok");
    for (const char* name : {"pdal_simple", "loadersgl_pdrf10-1.4", "laspy_1_4_w_evlr"}) {
        const auto laz = read_points(folder / (std::string(name) + ".laz")),
                   las = read_points(folder / (std::string(name) + ".las"));
        EXPECT_TRUE(same_points(*laz, *las)) << name;
    }
    const auto oldest = read_points(folder.parent_path() / "odd/pdal_simple-laszip-compressor-version-1.2r0.laz");
    EXPECT_TRUE(same_points(*oldest, *read_points(folder / "pdal_simple.las")));
}

TEST(LazSamples, ColoursTimesAndExtraBytes_AreThoseOfAnotherReader) {
    SCANMILL_REAL_SCAN(folder, shared_data, "6-formats/las/ok");
    const auto wave = read_points(folder / "laspy_fullwave.laz");
    const Column* const colours = wave->columns.find("colour");
    ASSERT_TRUE(colours);
    constexpr double multiple = 257;  // stored as bytes times 257
    std::array<double, 3> sums{};
    for (std::size_t row = 0; row < wave->size(); ++row)
        for (u32 i = 0; i < 3; ++i) sums[i] += multiple * colours->number(row, i);
    EXPECT_EQ(sums, (std::array<double, 3>{332453401, 376481613, 125259487}));
    EXPECT_NEAR(sum_of(*wave->columns.find("gps_time")), 4485099992.640074, 1e-3);
    const auto copc = read_points(folder / "pdal_1.2-with-color.copc.laz");
    EXPECT_NEAR(sum_of(*copc->columns.find("gps_time")), 263704809.3907848, 1e-4);
    const auto random = read_points(folder / "loadersgl_pdrf8-1.4.laz");
    for (const char* name : {"nir", "FIELD_0", "FIELD_1", "FIELD_2", "FIELD_3"})
        EXPECT_TRUE(random->columns.find(name)) << name;
}

}  // namespace
}  // namespace scanmill::test
