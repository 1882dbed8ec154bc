// SPDX-License-Identifier: GPL-3.0-or-later
// FIPS 180-2, appendix B: the examples that came with the definition.
#include <gtest/gtest.h>
#include "scanmill/worker/file_description.hpp"

namespace scanmill::test {
namespace {

std::string hash_of(std::string_view text) {
    Sha256 hash;
    hash.add(text);
    return hash.text();
}

TEST(Sha256, PublishedExamples_HaveTheirHashes) {
    EXPECT_EQ(hash_of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    EXPECT_EQ(hash_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Sha256, Pieces_HashAsTheWhole) {
    Sha256 hash;
    for (int i = 0; i < 1000; ++i) {
        hash.add(std::string(999, 'a'));
        hash.add("a");
    }
    EXPECT_EQ(hash.text(), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

}  // namespace
}  // namespace scanmill::test
