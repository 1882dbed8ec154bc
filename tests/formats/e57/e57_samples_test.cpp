// SPDX-License-Identifier: GPL-3.0-or-later
// All E57 files of the collection, with the counts, extremes and sums that pye57 0.4.19 computes from them (read_scan()
// with transform, on each scan).
#include <set>

#include "core/formats/support.hpp"
#include "support/real_data.hpp"

namespace scanmill::test {
namespace {

struct Sample {
    const char* file;
    u32 view;
    u32 views;
    std::size_t points;
    const char* columns;
    Vec3 low, high, sum;
};

const std::vector<Sample> samples{
    {"libe57_ColouredCubeDouble.e57",
     1,
     1,
     7680,
     "colour",
     {-0.5, -0.5, -0.5},
     {0.5, 0.5, 0.5},
     {-49.7208476960659, 17.862877547740936, -30.592817962169647}},
    {"libe57_ColouredCubeFloat.e57",
     1,
     1,
     7680,
     "colour",
     {-0.5, -0.5, -0.5},
     {0.5, 0.5, 0.5},
     {-49.7208476960659, 17.862877547740936, -30.592817962169647}},
    {"libe57_bunnyDouble.e57",
     1,
     1,
     30571,
     "",
     {-0.094689, 0.040011, -0.061873},
     {0.061008999999999994, 0.187321, 0.058799},
     {-841.093298, 3151.1987419999996, 264.243972}},
    {"libe57_bunnyInt32.e57",
     1,
     1,
     30571,
     "",
     {-0.094689, 0.040011, -0.061873},
     {0.061008999999999994, 0.187321, 0.058799},
     {-841.093298, 3151.1987419999996, 264.243972}},
    {"pdal_A4.e57",
     1,
     1,
     4,
     "intensity colour",
     {-44.95220184326172, -1.3493000268936157, -0.607699990272522},
     {-44.30009841918945, -0.8859999775886536, 0.3693999946117401},
     {-178.20790100097656, -4.253399968147278, 0.4260999858379364}},
    {"pdal_A_B.e57",
     1,
     2,
     2,
     "intensity colour",
     {-42.64229965209961, 1.8725999593734741, 0.5101000070571899},
     {-42.63949966430664, 2.057800054550171, 0.666700005531311},
     {-85.28179931640625, 3.930400013923645, 1.176800012588501}},
    {"pdal_A_B.e57",
     2,
     2,
     4,
     "intensity colour",
     {-44.95220184326172, -1.3493000268936157, -0.607699990272522},
     {-44.30009841918945, -0.8859999775886536, 0.3693999946117401},
     {-178.20790100097656, -4.253399968147278, 0.4260999858379364}},
    {"pdal_A_moved_B.e57",
     1,
     2,
     2,
     "intensity colour",
     {-42.64229965209961, 1.8725999593734741, 0.5101000070571899},
     {-42.63949966430664, 2.057800054550171, 0.666700005531311},
     {-85.28179931640625, 3.930400013923645, 1.176800012588501}},
    {"pdal_A_moved_B.e57",
     2,
     2,
     4,
     "intensity colour",
     {-44.11943817138672, 0.7053028345108032, -0.607699990272522},
     {-43.46733474731445, 1.1686029434204102, 0.3693999946117401},
     {-174.87684631347656, 3.9650115966796875, 0.4260999858379364}},
};

TEST(E57Samples, HaveThePointsOfPye57) {
    SCANMILL_REAL_SCAN(collection, shared_data, "6-formats");
    std::set<std::string> unknown;
    for (const auto& entry : fs::recursive_directory_iterator(collection / "e57"))
        if (entry.path().extension() == ".e57") unknown.insert(entry.path().filename());
    for (const Sample& sample : samples) {
        unknown.erase(sample.file);
        const fs::path file = collection / "e57/ok" / sample.file;
        EXPECT_EQ(count_views(file), sample.views) << sample.file;
        const auto cloud = read_points(view_name(file, sample.view));
        EXPECT_EQ(cloud->size(), sample.points) << sample.file;
        std::string names;
        for (const Column& column : cloud->columns) names += (names.empty() ? "" : " ") + column.name();
        EXPECT_EQ(names, sample.columns) << sample.file;
        Vec3 low = world_of(*cloud, 0), high = low, sum = Vec3::Zero();
        for (std::size_t row = 0; row < cloud->size(); ++row) {
            const Vec3 point = world_of(*cloud, row);
            low = low.cwiseMin(point);
            high = high.cwiseMax(point);
            sum += point;
        }
        // The pose of one file is written with seven digits; other figures differ by the order of the sum.
        EXPECT_LT((low - sample.low).norm(), 1e-12) << sample.file << " " << low.transpose();
        EXPECT_LT((high - sample.high).norm(), 1e-12) << sample.file << " " << high.transpose();
        EXPECT_LT((sum - sample.sum).norm(), 1e-9) << sample.file << " " << sum.transpose();
    }
    EXPECT_THAT(unknown, testing::IsEmpty());
}

}  // namespace
}  // namespace scanmill::test
