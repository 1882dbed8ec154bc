// SPDX-License-Identifier: GPL-3.0-or-later
// Names in formats that allow fewer: they stay distinct, and invalid text becomes valid.

#include "scanmill/formats/common/writing.hpp"

#include "core/formats/support.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(ValidText, KeepsUtf8_AndReplacesEveryInvalidByte) {
    EXPECT_EQ(valid_text("Größe € 𝄞 \"<&"), "Größe € 𝄞 \"<&");
    EXPECT_EQ(valid_text("a\tb\n\x7f"), "a_b__");
    EXPECT_EQ(valid_text("\xff\x80 \xc3"), "__ _") << "no first byte, no last byte";
    EXPECT_EQ(valid_text("\xc0\xaf \xe0\x80\xaf"), "__ ___") << "not the shortest form";
    EXPECT_EQ(valid_text("\xed\xa0\x80"), "___") << "a surrogate";
    EXPECT_EQ(valid_text("\xf4\x90\x80\x80"), "____") << "beyond U+10FFFF";
    EXPECT_EQ(valid_text("\xef\xbf\xbe \xef\xbf\xbd"), "___ \xef\xbf\xbd") << "not a character, and the last valid one";
    EXPECT_EQ(valid_text(std::string_view("a\0b", 3)), "a_b");
    EXPECT_EQ(valid_text("\xe2\x82"), "__") << "cut short";
}

TEST(WrittenNames, StayDifferent_AndOnlyChangesAreReported) {
    Warnings warnings;
    const WriteOptions options = warnings.writing();
    WrittenNames names("ABC", options, {"x"});
    EXPECT_EQ(names.add("a", "a"), "a");
    EXPECT_EQ(names.add("x", "x"), "x_2");
    EXPECT_EQ(names.add("x_2", "x_2"), "x_2_2");
    EXPECT_EQ(names.add("ring", "_RING", "_RING"), "_RING");
    EXPECT_THAT(warnings.sentences, ElementsAre("ABC holds the column 'x' under the name 'x_2'",
                                                "ABC holds the column 'x_2' under the name 'x_2_2'"));
}

}  // namespace
}  // namespace scanmill::test
