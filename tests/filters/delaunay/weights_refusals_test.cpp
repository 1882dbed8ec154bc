// SPDX-License-Identifier: GPL-3.0-or-later
// Unusable weights are refused, with the numbers found.

#include <gmock/gmock.h>

#include <limits>

#include "filters/alpha_solid/weighted_cases.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::AllOf;
using testing::HasSubstr;

std::string weights_refusal(const PointCloud& cloud, const DelaunayParams& params) {
    try {
        weighted(cloud, params);
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

PointCloud with_one_weight(double weight) {
    Array<double> weights(10, 0.25);
    weights[6] = weight;
    return with_weights(random_cube(10, 1), weights);
}

TEST(DelaunayWeights, ValuesOutOfRange_AreRefusedWithTheFirst) {
    const double infinity = std::numeric_limits<double>::infinity();
    for (double weight : {std::numeric_limits<double>::quiet_NaN(), infinity, -infinity, -1e-300, 1.01e18})
        EXPECT_THAT(weights_refusal(with_one_weight(weight), weighted_by("w")),
                    AllOf(HasSubstr("weights must be numbers from 0 to 1e+18; 1 of 10 in the column 'w' are not, the "
                                    "first is that of point 6: "),
                          HasSubstr("hint: a weight is a squared length")));
    EXPECT_THAT(weights_refusal(with_one_weight(-2), weighted_by("w", 3)), HasSubstr("point 6: -2 times 3"));
    EXPECT_THAT(weights_refusal(with_one_weight(1), weighted_by("w", 1e19)), HasSubstr("10 of 10"));
    EXPECT_EQ(weights_refusal(with_one_weight(1e18), weighted_by("w")), "accepted");
}

TEST(DelaunayWeights, AMissingColumn_IsRefusedWithTheExistingNames) {
    PointCloud cloud = with_one_weight(1);
    cloud.columns.add(Column("weight", 1, Buffer<float>(Array<float>(10, 1.0f))));
    EXPECT_THAT(weights_refusal(cloud, weighted_by("wieght")),
                AllOf(HasSubstr("no column 'wieght' to take weights from; their columns: w and weight"),
                      HasSubstr("did you mean 'weight'?")));
    EXPECT_THAT(weights_refusal(random_cube(10, 1), weighted_by("w")), HasSubstr("they have no columns"));
    EXPECT_THAT(weights_refusal(random_cube(10, 1), weighted_by("spacng")), HasSubstr("did you mean 'spacing'?"));
}

TEST(DelaunayWeights, AColumnOfSeveralNumbers_IsRefused) {
    PointCloud cloud = random_cube(10, 1);
    cloud.columns.add(Column("normal", 3, Buffer<float>(Array<float>(30, 1.0f))));
    cloud.columns.add(Column("list", Buffer<u64>(Array<u64>(11, u64(0))), Buffer<u8>{}));
    EXPECT_THAT(weights_refusal(cloud, weighted_by("normal")),
                AllOf(HasSubstr("weights need a column of one number per point; 'normal' has 3 numbers; no column has"),
                      HasSubstr("hint: `weights: spacing` needs no column")));
    cloud.columns.add(Column("quality", 1, Buffer<float>(Array<float>(10, 1.0f))));
    EXPECT_THAT(weights_refusal(cloud, weighted_by("list")),
                HasSubstr("'list' has lists; columns of one number: quality\n"));
}

TEST(DelaunayWeights, AFactorOutOfRange_IsRefused) {
    const PointCloud cloud = with_one_weight(1);
    EXPECT_THAT(weights_refusal(cloud, weighted_by("spacing", 4.5)),
                HasSubstr("with `weights: spacing`, factor must be at most 4; it is 4.5"));
    EXPECT_EQ(weights_refusal(cloud, weighted_by("w", 4.5)), "accepted");
    for (double factor : {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        EXPECT_THAT(weights_refusal(cloud, weighted_by("w", factor)),
                    AllOf(HasSubstr("factor must be a number of 0 or more"), HasSubstr("hint: ")));
}

TEST(DelaunayWeights, AFlatScan_IsRefusedAsWithoutWeights) {
    EXPECT_THAT(weights_refusal(rotated(flat_square(0), 0.7), weighted_by("spacing")), HasSubstr("of one plane"));
}

}  // namespace
}  // namespace scanmill
