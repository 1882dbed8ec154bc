// SPDX-License-Identifier: GPL-3.0-or-later
// Sizes and times, as people write them.

#include <gmock/gmock.h>

#include "scanmill/workflow/sizes.hpp"
#include "support/thrown.hpp"

namespace scanmill {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(Duration, EveryUnit_IsSeconds) {
    EXPECT_EQ(parse_duration("250 ms"), 0.25);
    EXPECT_EQ(parse_duration("30s"), 30);
    EXPECT_EQ(parse_duration("10 min"), 600);
    EXPECT_EQ(parse_duration("1.5 h"), 5400);
    EXPECT_EQ(parse_duration("+2  s"), 2);
    EXPECT_EQ(parse_duration("0 s"), 0);
}

TEST(Duration, WhatIsNone_SaysWhatWasExpected) {
    EXPECT_EQ(test::sentence_of([] { parse_duration("10"); }),
              "'10' has no unit; expected 500 ms, 30 s, 10 min or 2 h");
    for (const char* text : {"", "s", "-1 s", "inf s", "nan h", "1e308 h", "10 m", "1,5 h", "ten min", " 1 s", "1 s "})
        EXPECT_THAT(test::sentence_of([&] { parse_duration(text); }), HasSubstr("is not a time; expected 500 ms"))
            << text;
}

TEST(Duration, Text_ReadsBack) {
    for (const char* text : {"250 ms", "1 s", "59.5 s", "10 min", "1.5 h", "0 s"})
        EXPECT_EQ(duration_text(parse_duration(text)), text);
    EXPECT_EQ(duration_text(90), "1.5 min");
}

TEST(ByteSize, EveryUnit_IsBytes) {
    EXPECT_EQ(parse_byte_size("8 GiB"), u64(8) << 30);
    EXPECT_EQ(parse_byte_size("1.5 kB"), 1500u);
    EXPECT_EQ(parse_byte_size("4096"), 4096u);
    EXPECT_THAT(test::sentence_of([] { parse_byte_size("-1 B"); }), StartsWith("'-1 B' is not a size"));
    EXPECT_THAT(test::sentence_of([] { parse_byte_size("8 Gb"); }), StartsWith("'8 Gb' is not a size"));
}

}  // namespace
}  // namespace scanmill
