// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/base/hash.hpp"

#include <gtest/gtest.h>

#include <set>

namespace scanmill {
namespace {

TEST(KeyBuilder, FieldBorders_CannotBeShifted) {
    std::set<std::string> keys{KeyBuilder().field("ab", "c").key(),
                               KeyBuilder().field("a", "bc").key(),
                               KeyBuilder().field("a", "b").field("c", "").key(),
                               KeyBuilder().field("", "abc").key(),
                               KeyBuilder().field("a", "b").field("", "c").key(),
                               KeyBuilder().field("1:a", "").key(),
                               KeyBuilder().key()};
    EXPECT_EQ(keys.size(), 7u);
}

TEST(KeyBuilder, SwappedFields_GiveAnotherKey) {
    EXPECT_NE(KeyBuilder().field("source", "x").field("target", "y").key(),
              KeyBuilder().field("source", "y").field("target", "x").key());
}

TEST(KeyBuilder, EqualFields_GiveEqualKeysOf32HexadecimalDigits) {
    const std::string key = KeyBuilder().field("a", "b").key();
    EXPECT_EQ(key, KeyBuilder().field("a", "b").key());
    EXPECT_EQ(key.size(), 32u);
    EXPECT_EQ(key.find_first_not_of("0123456789abcdef"), std::string::npos);
}

}  // namespace
}  // namespace scanmill
