// SPDX-License-Identifier: GPL-3.0-or-later
// PCD files from the collections of other programs. Their counts and sums were computed with another reader.

#include <gmock/gmock.h>

#include <cmath>
#include <set>

#include "core/formats/support.hpp"
#include "support/real_data.hpp"

namespace scanmill::test {
namespace {

struct Sample {
    const char* file;
    const char* what;
    std::size_t points;
    std::string columns;
    Vec3 sum;  ///< of all positions, NaN left out
    double column_sum;  ///< of all numbers in all columns, NaN left out
};

const std::vector<Sample> samples{
    {"ok/loadersgl_simple-ascii.pcd",
     "ascii, colours packed into floats",
     213,
     "colour",
     {1.929937275184784, 32.31178914569318, 0},
     29154 + 33354 + 37632},
    {"ok/pcl_car6.pcd", "compressed", 10031, "", {-375096.4949645996, -647618.8002090454, -63155.11009502411}, 0},
    {"ok/pcl_colored_cloud.pcd",
     "normals and colours",
     1000,
     "normal colour curvature",
     {-218.51275972346775, -513.7772444486618, 1210.1030099391937},
     140634 + 139284 + 136778 + 82.56763773989587 + 201.36179842545243 - 235.8313776855939 + 29.3173869233392},
    {"ok/pcl_curve3d.pcd", "a curve", 110, "", {51.500320713534165, 55.000000044703484, 1.926115652313456}, 0},
    {"ok/pcl_ism_test.pcd", "a shape", 3400, "", {-38998.124529883265, 3373.917008334771, 162685.64801513776}, 0},
    {"ok/pcl_lamppost.pcd", "a street lamp", 1771, "", {-17894.46875, 131.0625, -3798.3508338928223}, 0},
    {"ok/pcl_nhood_test.pcd",
     "version .5, without a viewpoint",
     36,
     "intensity",
     {-37.6485630273819, -26.863635003566742, 55.16075873374939},
     0.06253800031845458},
    {"ok/pcl_octants.pcd", "a point in every octant", 8, "", {-1, -48, -48}, 0},
    {"odd/pcl_noisy_slice_displaced.pcd",
     "with noise",
     3782,
     "",
     {3780.9182045459747, 2821.7020642757416, 4847.998939394951},
     0},
    {"odd/pcl_sac_plane_test.pcd",
     "some normals are NaN, and not all are of length 1",
     3283,
     "normal curvature",
     {3697.3390234708786, -217.93783762389648, -43.72511591062539},
     -1992.9656421263935 - 763.6127184194047 - 1162.1230329817627 + 36.260204078159404},
};

double finite_sum(const ColumnTable& columns) {
    double sum = 0;
    for (const Column& column : columns)
        for (std::size_t row = 0; row < column.rows(); ++row)
            for (u32 component = 0; component < column.components(); ++component)
                if (const double number = column.number(row, component); !std::isnan(number)) sum += number;
    return sum;
}

Vec3 finite_sum(const PointCloud& cloud) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t row = 0; row < cloud.size(); ++row)
        for (int axis = 0; axis < 3; ++axis)
            if (const double number = world_of(cloud, row)[axis]; !std::isnan(number)) sum[axis] += number;
    return sum;
}

TEST(PcdSamples, HaveTheirPointsAndColumns_AsComputedWithAnotherReader) {
    SCANMILL_REAL_SCAN(folder, shared_data, "6-formats/pcd");
    std::set<std::string> unknown;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) unknown.insert(fs::relative(entry.path(), folder).string());
    for (const Sample& sample : samples) {
        SCOPED_TRACE(std::string(sample.file) + ": " + sample.what);
        EXPECT_EQ(unknown.erase(sample.file), 1u);
        Warnings warnings;
        const LoadedFile loaded = read_file(folder / sample.file, warnings.reading());
        EXPECT_THAT(warnings.sentences, testing::IsEmpty());
        const auto& cloud = *loaded.value.get<PointCloud>();
        EXPECT_EQ(cloud.size(), sample.points);
        std::string names;
        for (const Column& column : cloud.columns) names += (names.empty() ? "" : " ") + column.name();
        EXPECT_EQ(names, sample.columns);
        const Vec3 sum = finite_sum(cloud);
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(sum[axis], sample.sum[axis], 1e-12 * std::abs(sample.sum[axis]) + 1e-12) << axis;
        EXPECT_NEAR(finite_sum(cloud.columns), sample.column_sum, 1e-9);
    }
    EXPECT_THAT(unknown, testing::IsEmpty());
}

TEST(PcdSamples, OrganisedScan_KeepsItsNans) {
    SCANMILL_REAL_SCAN(file, shared_data, "5-raw/milk_cartoon_all_small_clorox.pcd");
    const auto cloud = read_points(file);
    EXPECT_EQ(cloud->size(), 307200u);
    EXPECT_TRUE(std::isnan(cloud->positions[307199].x()));
    EXPECT_NEAR(finite_sum(*cloud).z(), 218447.3789679408, 1e-6);
    EXPECT_TRUE(cloud->columns.find("colour"));
}

}  // namespace
}  // namespace scanmill::test
