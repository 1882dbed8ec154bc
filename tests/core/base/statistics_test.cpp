// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/base/statistics.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace scanmill {
namespace {

TEST(Statistics, MedianOfAnEvenNumber_IsTheUpperOfTheTwoInTheMiddle) {
    EXPECT_EQ(median(std::vector<double>{7}), 7);
    EXPECT_EQ(median(std::vector<double>{3, 1, 2}), 2);
    EXPECT_EQ(median(std::vector<double>{4, 1, 3, 2}), 3);
}

TEST(Statistics, Quantile_IsTheLeastValueThatTheShareDoesNotExceed) {
    const auto of_ten = [](double share) {
        return quantile(std::vector<double>{3, 9, 1, 7, 5, 10, 2, 8, 6, 4}, share);
    };
    EXPECT_EQ(of_ten(0), 1);
    EXPECT_EQ(of_ten(0.1), 1);
    EXPECT_EQ(of_ten(0.11), 2);
    EXPECT_EQ(of_ten(0.5), 5) << "of an even number the lower of the two in the middle";
    EXPECT_EQ(of_ten(0.95), 10);
    EXPECT_EQ(of_ten(1), 10);
}

}  // namespace
}  // namespace scanmill
