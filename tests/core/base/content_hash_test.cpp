// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "scanmill/base/hash.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using ::testing::HasSubstr;

TEST(ContentHash, EqualBytes_HaveEqualHashesWhateverTheFile) {
    const TemporaryFolder folder;
    const std::string long_text(3'000'000, 'x');  // longer than one block of reading
    const std::string hash = content_hash(folder.write("a", long_text));
    EXPECT_THAT(hash, testing::MatchesRegex("[0-9a-f]{32}"));
    EXPECT_EQ(content_hash(folder.write("b", long_text)), hash);
    std::string other = long_text;
    for (const std::size_t place : {std::size_t(0), std::size_t(1) << 20, other.size() - 1}) {
        other[place] = 'y';
        EXPECT_NE(content_hash(folder.write("b", other)), hash) << place;
        other[place] = 'x';
    }
    EXPECT_NE(content_hash(folder.write("b", long_text + "x")), hash);
}

TEST(ContentHash, EmptyFile_HasThePublishedHashOfNothing) {
    // XXH3-128 of no bytes with seed 0.
    const TemporaryFolder folder;
    EXPECT_EQ(content_hash(folder.write("empty", "")), "99aa06d3014798d86001c324468d497f");
}

TEST(ContentHash, MissingFileOrFolder_IsRefused) {
    const TemporaryFolder folder;
    EXPECT_EQ(sentence_of([&] { content_hash(folder / "missing"); }),
              "'" + (folder / "missing").string() + "' cannot be read");
    EXPECT_THAT(sentence_of([&] { content_hash(folder.path()); }), HasSubstr("cannot be read"));
}

}  // namespace
}  // namespace scanmill::test
