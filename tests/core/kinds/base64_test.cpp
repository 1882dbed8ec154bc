// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/kinds/base64.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "scanmill/base/random.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;

std::string encoded(std::string_view text) { return base64_of(std::as_bytes(std::span(text))); }
std::string decoded(std::string_view text) {
    const Array<std::byte> bytes = bytes_of_base64(text);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
std::string refusal(std::string_view text) {
    try {
        bytes_of_base64(text);
    } catch (const JsonMismatch& mismatch) {
        return mismatch.sentence;
    }
    return "";
}

TEST(Base64, IsThatOfRfc4648) {
    // section 10
    const std::vector<std::pair<std::string, std::string>> vectors{{"", ""},
                                                                   {"f", "Zg=="},
                                                                   {"fo", "Zm8="},
                                                                   {"foo", "Zm9v"},
                                                                   {"foob", "Zm9vYg=="},
                                                                   {"fooba", "Zm9vYmE="},
                                                                   {"foobar", "Zm9vYmFy"}};
    for (const auto& [bytes, text] : vectors) {
        EXPECT_EQ(encoded(bytes), text);
        EXPECT_EQ(decoded(text), bytes);
    }
    EXPECT_EQ(encoded("\xfb\xff\xfe"), "+//+");
}

TEST(Base64, AnyBytes_AreReadBack) {
    Random random(1);
    for (std::size_t size = 0; size < 300; ++size) {
        std::string bytes(size, '\0');
        for (char& byte : bytes) byte = static_cast<char>(random.index(256));
        EXPECT_EQ(decoded(encoded(bytes)), bytes);
    }
}

TEST(Base64, LinesAreIgnored) { EXPECT_EQ(decoded("Zm9v\r\n YmFy\n"), "foobar"); }

TEST(Base64, RefusesOtherTexts) {
    EXPECT_THAT(refusal("Zm9*"), HasSubstr("character 3 is '*'"));
    EXPECT_THAT(refusal("Zm-_"), HasSubstr("character 2 is '-'"));  // the alphabet for file names
    EXPECT_THAT(refusal(std::string_view("Zm9v\0", 5)), HasSubstr("character 4"));
    for (const char* text : {"Z", "Zg", "Zg=", "Zm9vYg", "Zg===", "=", "====", "Zg==Zg==", "Z=g="})
        EXPECT_THAT(refusal(text), HasSubstr("whole groups of 4")) << text;
    EXPECT_NE(refusal("Zh=="), "");  // bits after the last byte
}

TEST(Base64, ArraysAreTheBytesOfTheirRows) {
    const Base64<std::array<u32, 2>> pairs{{{1, 2}, {258, 4294967295u}}};
    const Json json = json_of(pairs);
    EXPECT_EQ(json, "AQAAAAIAAAACAQAA/////w==");
    EXPECT_EQ((from_json<Base64<std::array<u32, 2>>>(json).rows), pairs.rows);
    EXPECT_EQ(json_of(Base64<double>{{1.0}}), "AAAAAAAA8D8=");
    EXPECT_EQ(json_of(Base64<double>{}), "");
    EXPECT_TRUE(from_json<Base64<double>>("").rows.empty());
}

TEST(Base64, RefusesBytesThatAreNotWholeRows) {
    try {
        JsonForm<Base64<double>> form;
        Base64<double> value;
        form.read("AAAAAAAA8D8A", value);
        ADD_FAILURE();
    } catch (const JsonMismatch& mismatch) {
        EXPECT_THAT(mismatch.sentence, HasSubstr("9 bytes, which are not whole rows of 8"));
    }
}

}  // namespace
}  // namespace scanmill::test
