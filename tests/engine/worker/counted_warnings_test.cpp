// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/worker/counted_warnings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanmill::test {
namespace {

using testing::ElementsAre;

TEST(CountedWarnings, EqualSentences_AreOneWithItsCount) {
    CountedWarnings warnings;
    EXPECT_TRUE(warnings.add("a"));
    EXPECT_TRUE(warnings.add("b"));
    EXPECT_FALSE(warnings.add("a"));
    EXPECT_FALSE(warnings.add("a"));
    EXPECT_THAT(warnings.sentences(), ElementsAre("a (3 times)", "b"));
}

}  // namespace
}  // namespace scanmill::test
