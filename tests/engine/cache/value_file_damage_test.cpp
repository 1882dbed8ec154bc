// SPDX-License-Identifier: GPL-3.0-or-later
// Files that hold no whole value are refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/cache/value_samples.hpp"
#include "scanmill/base/error.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;

TEST_F(ValueFile, AnyByteThatChanged_IsNoticed) {
    for (const Value& each : one_of_each_kind()) {
        EncodedValue(each).write(folder_ / "value");
        const std::string whole = content_of(folder_ / "value");
        for (std::size_t at = 0; at < whole.size(); ++at) {
            // The last eight bytes of the preamble and the zeros behind the header say nothing.
            std::string spoilt = whole;
            spoilt[at] = static_cast<char>(spoilt[at] ^ 0x20);
            folder_.write("spoilt", spoilt);
            try {
                const Value read = read_value(folder_ / "spoilt");
                EXPECT_EQ(key_of(read), key_of(each)) << "byte " << at;
            } catch (const Error& error) {
                EXPECT_THAT(error.sentence(), HasSubstr("spoilt")) << "byte " << at;
            }
        }
    }
}

TEST_F(ValueFile, CutShortAnywhere_IsRefused) {
    EncodedValue(value(mesh())).write(folder_ / "value");
    const std::string whole = content_of(folder_ / "value");
    for (std::size_t size = 0; size < whole.size(); ++size) {
        folder_.write("cut", whole.substr(0, size));
        EXPECT_THROW(read_value(folder_ / "cut"), Error) << size;
    }
}

TEST_F(ValueFile, WhatIsNone_IsRefused) {
    folder_.write("scan.ply", "ply\nformat ascii 1.0\n" + std::string(100, ' '));
    EXPECT_THAT(sentence_of([&] { read_value(folder_ / "scan.ply"); }), HasSubstr("is not a value file"));
    EXPECT_THAT(sentence_of([&] { read_value(folder_ / "absent"); }), HasSubstr("there is no such file"));
}

}  // namespace
}  // namespace scanmill::test
