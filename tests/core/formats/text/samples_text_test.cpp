// SPDX-License-Identifier: GPL-3.0-or-later
// All texts of the collection, written by other programs, with the counts of another reader.
#include "core/formats/samples_support.hpp"
#include "core/formats/support.hpp"

namespace scanmill::test {
namespace {

const std::vector<Sample> text_samples{
    {"xyz/odd/pdal_crlf_test.txt", 10, "Intensity", {289818.50, 4320980.59, 170.58}},
    {"xyz/odd/pdal_crlf_test2.txt", 10, "Intensity", {289818.50, 4320980.59, 170.58}},
    {"xyz/odd/pdal_duplicates-unsorted.txt", 7, "GpsTime PointSourceId UserData", {0, 1, 1}},
    {"xyz/odd/pdal_missingheader.txt", 5, "c4", {5, 5, 5}},
    {"xyz/odd/pdal_numeric_dim.txt", 5, "Eigenvalue0", {5, 5, 5}},
    {"xyz/odd/pdal_quoted.txt", 9, "", {29, 22, 2}},
    {"xyz/odd/pdal_utm17_1.txt", 10, "", {289818.50, 4320980.59, 170.58}},
    {"xyz/odd/pdal_utm17_2.txt", 10, "", {289818.50, 4320980.59, 170.58}},
    {"xyz/ok/cgal_cube.xyz", 8, "", {1, -1, 1}},
    {"xyz/ok/cgal_oneK.xyz", 1000, "", {0.795013, 0.307159, 0.124268}},
    {"xyz/ok/cgal_oni.pwn", 1435, "normal", {0.230974, -0.411741, -0.210068}},
    {"xyz/ok/cgal_points.xyz", 50, "", {-0.061372220516204834, 0.92836838960647583, 0.36655905842781067}},
    {"xyz/ok/cgal_sphere926.pwn", 926, "normal", {6.28334, 1.84495, 7.5575}},
    {"xyz/ok/cgal_sphere_1k.xyz", 1050, "normal", {-0.927172, 0.260749, -0.229844}},
    {"xyz/ok/pdal_data.xyz", 400, "", {441890, 3750150, 107}},
    {"xyz/ok/trimesh_points_agisoft.xyz", 100, "c4 c5 c6", {665186.236769, 5648351.141146, 244.871176}},
    {"xyz/ok/trimesh_points_cloudcompare.xyz", 101, "c4 c5 c6 c7", {665184.713891, 5648298.096676, 228.049194}},
    {"pts/ok/open3d_point_cloud_sample1.pts", 10, "intensity colour", {-6.369919, -13.915909, -65.089279}},
    {"pts/ok/open3d_point_cloud_sample2.pts", 10, "intensity", {-6.369919, -13.915909, -65.089279}},
    {"pts/ok/pdal_autzen.pts", 10, "intensity colour", {636125.879990, 848971.060013, 428.050003}},
    {"pts/ok/pdal_site_56_8.pts", 8, "intensity", {6728.512429, 35.903329, -14.709473}},
    {"pts/ok/pdal_test.pts", 19, "intensity colour", {-19.501053, -24.533554, -1.533951}},
    {"ptx/ok/pdal_1.2-with-color.ptx", 1065, "intensity colour approach", {637342.85, 853240.32, 423.92}},
    {"ptx/ok/pdal_multiple-and-transform.ptx", 8, "intensity approach scan", {636699.38, 848991.01, 425.39}},
    {"ptx/ok/pdal_no-color.ptx", 15, "intensity approach", {635795.24, 849310.43, 426.61}},
};

TEST(Samples_Text, HaveTheirPointsAndColumns) { check_samples(text_samples, {"xyz", "pts", "ptx"}); }

TEST(Samples_Ptx, TheScaledScan_LiesOnTheSameScanAsStored) {
    // Scan 0 has its first points less 6e5, 8e5, 400 and half as high, and the matrix that undoes that.
    SCANMILL_REAL_SCAN(scaled, shared_data, "6-formats/ptx/ok/pdal_multiple-and-transform.ptx");
    SCANMILL_REAL_SCAN(plain, shared_data, "6-formats/ptx/ok/pdal_no-color.ptx");
    const auto a = read_points(scaled), b = read_points(plain);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_LT((world_of(*a, i) - world_of(*b, i)).norm(), 1e-9) << i;
        EXPECT_EQ(world_of(*a, i + 4), world_of(*b, i)) << i;
    }
}

}  // namespace
}  // namespace scanmill::test
