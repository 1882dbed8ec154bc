// SPDX-License-Identifier: GPL-3.0-or-later
// All LAS and LAZ files of the collection, written by other programs, with the content that laspy reads.
#include "core/formats/samples_support.hpp"
#include "core/formats/support.hpp"

namespace scanmill::test {
namespace {

const std::string basics =
    "intensity return_number number_of_returns classification scan_angle user_data point_source_id";

/// A sample that is only read where the module LAZ is built.
Sample laz(const char* file, std::size_t points, const std::string& columns, const Vec3& last) {
#ifdef SCANMILL_LAZ
    return {file, points, columns, last};
#else
    (void)points, (void)columns, (void)last;
    return {file, 0, ", LAS in compressed form; it is not read"};
#endif
}

const std::vector<Sample> las_samples{
    {"las/odd/pdal_1.2-empty-geotiff-vlrs.las",
     43,
     basics + " gps_time Amplitude Reflectance Deviation",
     {211.08525, 81.46075, -8.505749999999999}},
    {"las/odd/pdal_1.2-no-points.las", 0, "promises 1065 points of 34 bytes"},
    {"las/odd/pdal_epsg_4326.las", 5380, basics, {-94.6803588, 31.0473291, 52.680000199999995}},
    {"las/odd/pdal_extrabytes.las",
     1065,
     basics + " scan_direction gps_time colour Colors Flags Intensity Time",
     {637342.85, 853240.3200000001, 423.92}},
    {"las/odd/pdal_gps-time-nan.las", 1, basics + " gps_time", {0.0, 0.0, 0.0}},
    {"las/odd/pdal_interesting.las",
     1065,
     basics + " scan_direction gps_time colour",
     {637342.85, 853240.3200000001, 423.92}},
    laz("las/odd/pdal_laszip-generated_with2bytespadding.laz", 1065, basics + " scan_direction gps_time colour",
        {637342.85, 853240.3200000001, 423.92}),
    {"las/odd/pdal_lots_of_vlr.las",
     1,
     basics + " scan_direction gps_time",
     {715001.346, 839349.171, 17.275000000000002}},
    {"las/odd/pdal_no-points.las", 0, "its header declares 0"},
    {"las/odd/pdal_prec3.las", 110, basics + " scan_direction gps_time colour", {636034.83, 849387.53, 458.83}},
    laz("las/odd/pdal_simple-laszip-compressor-version-1.2r0.laz", 1065, basics + " scan_direction gps_time colour",
        {637342.85, 853240.3200000001, 423.92}),
    {"las/odd/pdal_spec_3.las", 10, basics + " gps_time colour", {289818.5, 4320980.59, 170.58}},
    {"las/odd/pdal_spurious.las",
     1065,
     basics + " scan_direction gps_time colour",
     {-123.06879389999999, 44.0618225, 129.21}},
    {"las/odd/pdal_wontcompress3.las", 1000, basics + " withheld overlap gps_time", {768348.48, 2028742.987, 107.37}},
    {"las/ok/laspy_1_4_w_evlr.las",
     1000,
     basics + " overlap scan_direction edge_of_flight_line gps_time",
     {1694291.6363326558, 1816493.0662305846, 5597.089652537912}},
    laz("las/ok/laspy_1_4_w_evlr.laz", 1000, basics + " overlap scan_direction edge_of_flight_line gps_time",
        {1694291.6363326558, 1816493.0662305846, 5597.089652537912}),
    laz("las/ok/laspy_fullwave.laz", 10750, basics + " gps_time colour nir", {194300.063, 8249099.341, 1000.491}),
    laz("las/ok/laspy_plane.laz", 28185, basics + " gps_time colour", {1423214.55, 4189096.79, 67.87}),
    {"las/ok/laspy_simple1_1.las", 1065, basics + " scan_direction gps_time", {637342.85, 853240.3200000001, 423.92}},
    {"las/ok/laspy_simple1_3.las",
     999,
     basics + " scan_direction edge_of_flight_line gps_time",
     {-235433.76, 5800946.08, 273.729}},
    {"las/ok/loadersgl_pdrf10-1.4.las",
     1024,
     basics + " synthetic key_point withheld overlap scan_direction edge_of_flight_line gps_time colour16 nir FIELD_0 "
              "FIELD_1 FIELD_2 FIELD_3",
     {-1686130731.0, 1843512612.0, -1693648695.0}},
    laz("las/ok/loadersgl_pdrf10-1.4.laz", 1024,
        basics +
            " synthetic key_point withheld overlap scan_direction edge_of_flight_line gps_time colour16 nir FIELD_0 "
            "FIELD_1 FIELD_2 FIELD_3",
        {-1686130731.0, 1843512612.0, -1693648695.0}),
    {"las/ok/loadersgl_pdrf7-v4-1.4.las",
     1024,
     basics +
         " synthetic key_point withheld overlap scanner_channel scan_direction edge_of_flight_line gps_time colour16",
     {-489.84, 1034.79, 177.24}},
    laz("las/ok/loadersgl_pdrf8-1.4.laz", 1024,
        basics + " synthetic key_point withheld overlap scanner_channel scan_direction edge_of_flight_line gps_time "
                 "colour16 nir FIELD_0 FIELD_1 FIELD_2 FIELD_3",
        {-1686130731.0, 1843512612.0, -1693648695.0}),
    {"las/ok/pdal_1.0_0.las", 1, basics, {470692.44, 4602888.9, 16.0}},
    {"las/ok/pdal_1.0_1.las", 1, basics + " gps_time", {470692.44, 4602888.9, 16.0}},
    {"las/ok/pdal_1.1_0.las", 1, basics, {470692.44, 4602888.9, 16.0}},
    {"las/ok/pdal_1.1_1.las", 1, basics + " gps_time", {470692.44, 4602888.9, 16.0}},
    laz("las/ok/pdal_1.2-with-color.copc.laz", 1065, basics + " scan_direction gps_time colour",
        {638314.34, 852793.54, 419.65000000000003}),
    {"las/ok/pdal_1.2-with-color.las",
     1065,
     basics + " scan_direction gps_time colour",
     {637342.85, 853240.3200000001, 423.92}},
    {"las/ok/pdal_1.2_0.las", 1, basics, {470692.44, 4602888.9, 16.0}},
    {"las/ok/pdal_1.2_1.las", 1, basics + " gps_time", {470692.44, 4602888.9, 16.0}},
    {"las/ok/pdal_1.2_2.las", 1, basics + " colour", {470692.44, 4602888.9, 16.0}},
    {"las/ok/pdal_1.2_3.las", 1, basics + " gps_time colour", {470692.44, 4602888.9, 16.0}},
    {"las/ok/pdal_100-points.las", 100, basics + " scan_direction gps_time colour", {637738.91, 853334.88, 421.06}},
    {"las/ok/pdal_simple.las",
     1065,
     basics + " scan_direction gps_time colour",
     {637342.85, 853240.3200000001, 423.92}},
    laz("las/ok/pdal_simple.laz", 1065, basics + " scan_direction gps_time colour",
        {637342.85, 853240.3200000001, 423.92}),
    {"las/ok/pdal_test1_4.las",
     1000,
     basics + " overlap scan_direction edge_of_flight_line gps_time",
     {1694291.6363326558, 1816493.0662305846, 5597.089652537912}},
};

TEST(Samples_Las, HaveTheirPointsAndColumns) { check_samples(las_samples, {"las"}); }

struct Sums {
    const char* file;
    /// Sums of intensity, return_number, number_of_returns, classification, point_source_id and user_data.
    std::array<double, 6> sums;
};

const std::vector<Sums> sums{
    {"las/odd/pdal_1.2-empty-geotiff-vlrs.las", {0, 45, 46, 0, 0, 0}},
    {"las/odd/pdal_epsg_4326.las", {352578300, 0, 0, 0, 0, 0}},
    {"las/odd/pdal_prec3.las", {12366, 117, 131, 127, 805860, 13808}},
    {"las/odd/pdal_spec_3.las", {2660, 0, 60, 20, 0, 0}},
    {"las/odd/pdal_wontcompress3.las", {52584, 1076, 1142, 1086, 457000, 0}},
    {"las/ok/laspy_simple1_3.las", {102386, 999, 999, 999, 404152, 0}},
    {"las/ok/loadersgl_pdrf10-1.4.las", {32866212, 8088, 7669, 130942, 35203431, 135880}},
    {"las/ok/loadersgl_pdrf7-v4-1.4.las", {33446400, 4669, 8170, 130560, 33553920, 130560}},
    {"las/ok/pdal_simple.las", {81361, 1236, 1432, 1341, 7806350, 134663}},
#ifdef SCANMILL_LAZ
    {"las/odd/pdal_laszip-generated_with2bytespadding.laz", {81361, 1236, 1432, 1341, 7806350, 134663}},
    {"las/odd/pdal_simple-laszip-compressor-version-1.2r0.laz", {81361, 1236, 1432, 1341, 7806350, 134663}},
    {"las/ok/laspy_1_4_w_evlr.laz", {38007, 1030, 1030, 2000, 202000, 0}},
    {"las/ok/laspy_fullwave.laz", {46997969, 17126, 23504, 0, 10782250, 10750}},
    {"las/ok/laspy_plane.laz", {240588544, 28185, 28185, 0, 0, 0}},
    {"las/ok/loadersgl_pdrf10-1.4.laz", {32866212, 8088, 7669, 130942, 35203431, 135880}},
    {"las/ok/loadersgl_pdrf8-1.4.laz", {32866212, 8088, 7669, 130942, 35203431, 135880}},
    {"las/ok/pdal_1.2-with-color.copc.laz", {81361, 1236, 1432, 1341, 7806350, 134663}},
    {"las/ok/pdal_simple.laz", {81361, 1236, 1432, 1341, 7806350, 134663}},
#endif
    {"las/ok/pdal_test1_4.las", {38007, 1030, 1030, 2000, 202000, 0}},
};

TEST(Samples_Las, SumsOfTheirColumns_AreThoseOfAnotherReader) {
    SCANMILL_REAL_SCAN(collection, shared_data, "6-formats");
    constexpr std::array<const char*, 6> names{"intensity",      "return_number",   "number_of_returns",
                                               "classification", "point_source_id", "user_data"};
    for (const Sums& sample : sums) {
        const auto cloud = read_points(collection / sample.file);
        for (std::size_t i = 0; i < names.size(); ++i) {
            const Column* column = cloud->columns.find(names[i]);
            ASSERT_NE(column, nullptr) << sample.file << " " << names[i];
            double sum = 0;
            for (std::size_t row = 0; row < cloud->size(); ++row) sum += column->number(row);
            EXPECT_EQ(sum, sample.sums[i]) << sample.file << " " << names[i];
        }
    }
}

#ifdef SCANMILL_LAZ
struct Extremes {
    const char* file;
    Vec3 low, high;
};

const std::vector<Extremes> extremes{
    {"las/odd/pdal_laszip-generated_with2bytespadding.laz",
     {635619.85, 848899.7, 406.59},
     {638982.55, 853535.43, 586.38}},
    {"las/odd/pdal_simple-laszip-compressor-version-1.2r0.laz",
     {635619.85, 848899.7, 406.59},
     {638982.55, 853535.43, 586.38}},
    {"las/ok/laspy_1_4_w_evlr.laz",
     {1694038.4456374517, 1816492.7062700584, 5592.7499174683535},
     {1694539.677014474, 1816497.9762624602, 5599.069686751426}},
    {"las/ok/laspy_fullwave.laz", {194267.419, 8249096.014, 989.944}, {194318.295, 8249137.34, 1003.704}},
    {"las/ok/laspy_plane.laz", {1423214.52, 4189096.63, 67.86}, {1423216.76, 4189098.6, 67.9}},
    {"las/ok/loadersgl_pdrf10-1.4.laz",
     {-2141890547.0, -2147415624.0, -2147101580.0},
     {2146619417.0, 2139249378.0, 2146599318.0}},
    {"las/ok/loadersgl_pdrf8-1.4.laz",
     {-2141890547.0, -2147415624.0, -2147101580.0},
     {2146619417.0, 2139249378.0, 2146599318.0}},
    {"las/ok/pdal_1.2-with-color.copc.laz", {635619.85, 848899.7, 406.59}, {638982.55, 853535.43, 586.38}},
    {"las/ok/pdal_simple.laz", {635619.85, 848899.7, 406.59}, {638982.55, 853535.43, 586.38}},
};

TEST(Samples_Laz, Extremes_AreThoseOfAnotherReader) {
    SCANMILL_REAL_SCAN(collection, shared_data, "6-formats");
    for (const Extremes& sample : extremes) {
        const auto cloud = read_points(collection / sample.file);
        BoundingBox box;
        for (std::size_t row = 0; row < cloud->size(); ++row) box.add(world_of(*cloud, row));
        // A few units in the last place of 10^7.
        EXPECT_LT((box.low - sample.low).norm(), 5e-9) << sample.file;
        EXPECT_LT((box.high - sample.high).norm(), 5e-9) << sample.file;
    }
}
#endif

TEST(Samples_Las, ExtraBytesOfAScanner_AreScaled) {
    SCANMILL_REAL_SCAN(path, shared_data, "6-formats/las/odd/pdal_1.2-empty-geotiff-vlrs.las");
    const auto cloud = read_points(path);
    EXPECT_NEAR(cloud->columns.find("Amplitude")->number(0), 16.84, 1e-9);
    EXPECT_NEAR(cloud->columns.find("Reflectance")->number(42), -8.43, 1e-9);
    EXPECT_EQ(cloud->columns.find("Deviation")->type(), ScalarType::uint16);
    EXPECT_EQ(cloud->frame.unit, LengthUnit::metre);
}

}  // namespace
}  // namespace scanmill::test
