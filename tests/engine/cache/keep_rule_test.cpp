// SPDX-License-Identifier: GPL-3.0-or-later
// Which values are worth a place in the cache.

#include "scanmill/cache/cache.hpp"

#include <gtest/gtest.h>

namespace scanmill::test {
namespace {

TEST(KeepRule, WeighsMakingAgainstWriting) {
    KeepRule rule;
    EXPECT_TRUE(rule.is_worth(1, 100'000'000)) << "0.2 s to write at 500 MB/s";
    EXPECT_FALSE(rule.is_worth(0.3, 100'000'000));
    rule.wrote(10'000'000, 1);  // a slow disk
    EXPECT_EQ(rule.bytes_per_second(), 1e7);
    EXPECT_FALSE(rule.is_worth(1, 100'000'000));
    rule.wrote(30'000'000, 1);
    EXPECT_EQ(rule.bytes_per_second(), 2e7);
    rule.wrote(10, 5);
    EXPECT_EQ(rule.bytes_per_second(), 2e7) << "too small to tell";
    EXPECT_TRUE(KeepRule(KeepRule::Policy::always).is_worth(0, ~u64(0)));
    EXPECT_FALSE(KeepRule(KeepRule::Policy::never).is_worth(1e9, 1));
}

}  // namespace
}  // namespace scanmill::test
