// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "filters/cluster_mesh/cases.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

Error refusal(const PointCloud& cloud, const ClusterMeshParams& params = {}) {
    try {
        clustered(cloud, params);
    } catch (const Error& error) {
        return error;
    }
    return Error("accepted");
}

void expect_refusal(const PointCloud& cloud, const ClusterMeshParams& params, const char* sentence, const char* hint) {
    const Error error = refusal(cloud, params);
    EXPECT_THAT(error.sentence(), HasSubstr(sentence));
    EXPECT_THAT(error.hint(), HasSubstr(hint));
}

TEST(ClusterMeshRefuses, FewPoints) {
    expect_refusal({}, {}, "needs at least 3 distinct points; the cloud has none", "scanmill info");
    expect_refusal(cloud_of({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}}), {}, "the cloud has 2 in 3 rows", "smaller voxels");
}

TEST(ClusterMeshRefuses, PointsOnALine) {
    expect_refusal(cloud_of({{0, 0, 0}, {1, 1, 0}, {2, 2, 0}, {3, 3, 0}}), {}, "all 4 distinct points lie on one line",
                   "profile");
}

TEST(ClusterMeshRefuses, NaN) {
    EXPECT_THAT(refusal(cloud_of({{0, 0, 0}, {1, std::numeric_limits<double>::quiet_NaN(), 0}, {2, 2, 0}})).sentence(),
                HasSubstr("1"));
}

TEST(ClusterMeshRefuses, AMaxEdgeFarBelowTheSpacing) {
    expect_refusal(grid(10, 10), with_max_edge(0.1),
                   "max-edge 0.1 u is 0.1 times the spacing 1 u: 100 of 100 points would be clusters of one point",
                   "try 2.5 u");
}

TEST(ClusterMeshRefuses, AMaxEdgeThatJoinsPairsOnly) {
    std::vector<Vec3> pairs;
    for (const Vec3& p : grid(5, 5).positions) {
        pairs.push_back(p);
        pairs.push_back(p + Vec3(0.1, 0, 0.02));
    }
    EXPECT_THAT(refusal(cloud_from(pairs), with_max_edge(0.2)).sentence(),
                HasSubstr("no triangle with edges below max-edge 0.2 u"));
}

TEST(ClusterMeshRefuses, NearDuplicatesEverywhere_WithAMaxEdgeThatWorks) {
    for (const double distance : {1e-3, 1e-11}) {
        std::vector<Vec3> pairs;
        for (const Vec3& p : grid(20, 20).positions) {
            pairs.push_back(p);
            pairs.push_back(p + Vec3(distance, 0, 0));
        }
        const PointCloud cloud = cloud_from(pairs);
        for (const ClusterMeshParams& params : {ClusterMeshParams(), with_max_edge(distance / 2)}) {
            const std::string hint = refusal(cloud, params).hint();
            double suggested = 0;
            ASSERT_EQ(std::sscanf(hint.c_str() + hint.find_first_of("0123456789"), "%lf", &suggested), 1) << hint;
            EXPECT_GT(suggested, std::sqrt(2.0)) << hint;
            EXPECT_LT(suggested, 4) << hint;
        }
    }
}

TEST(ClusterMeshRefuses, AMaxEdgeFarAboveTheSpacing) {
    expect_refusal(grid(40, 40), with_max_edge(30), "max-edge 30 u is too large: ", "leave max-edge at `auto`, or use");
    PointCloud cloud = grid(40, 40);
    cloud.columns.add(Column("bin-size", 1, Buffer<double>(Array<double>(1600, 13))));
    expect_refusal(cloud, {}, "max-edge 29.9 u is too large: ", "use about");
    EXPECT_THAT(refusal(cloud).hint(), Not(HasSubstr("auto")));
}

TEST(ClusterMeshRefuses, ParametersOutOfRange) {
    const PointCloud cloud = grid(3, 3);
    for (double length : {0.0, -1.0, std::numeric_limits<double>::infinity()}) {
        expect_refusal(cloud, with_max_edge(length), "max-edge is", "auto");
        ClusterMeshParams params;
        params.slice = Length(length);
        expect_refusal(cloud, params, "slice is", "auto");
    }
    ClusterMeshParams params;
    params.slice = Length(1e-12);
    expect_refusal(cloud, params, "slice 1e-12 u divides 2 u into 2e+12 slices", "a quarter of max-edge");
    params = {};
    params.up = {1, 0};
    expect_refusal(cloud, params, "up has 2 numbers", "x, y, z");
    for (const double z : {0.0, std::nan("")}) {
        params.up = {0, 0, z};
        expect_refusal(cloud, params, "up is (0, 0, ", "0, 0, 1");
    }
    for (double degrees : {0.0, 181.0}) {
        params = {};
        params.max_normal_angle = Angle::degrees(degrees);
        EXPECT_THAT(refusal(cloud, params).sentence(), HasSubstr("max-normal-angle is"));
        params = {};
        params.neighbour_angle = Angle::degrees(degrees);
        EXPECT_THAT(refusal(cloud, params).sentence(), HasSubstr("neighbour-angle is"));
    }
    params = {};
    params.overlap_angle = Angle::degrees(90);
    EXPECT_THAT(refusal(cloud, params).sentence(),
                HasSubstr("overlap-angle is 90 degrees; it must be above 0 and below 90"));
}

}  // namespace
}  // namespace scanmill
