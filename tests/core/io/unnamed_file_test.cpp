// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/io/unnamed_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

TEST(UnnamedFile, HoldsItsBytes_AfterItself) {
    std::unique_ptr<MappedFile> mapped;
    {
        UnnamedFile file;
        file.append("abc");
        file.append("");
        file.append("def");
        mapped = file.map();
    }
    EXPECT_EQ(mapped->bytes(), "abcdef");
}

TEST(UnnamedFile, LeavesNothingInItsFolder) {
    const TemporaryFolder folder;
    const char* const before = std::getenv("TMPDIR");
    const std::string kept = before ? before : "";
    ::setenv("TMPDIR", folder.path().c_str(), 1);
    {
        UnnamedFile file;
        file.append("abc");
        EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
    ::setenv("TMPDIR", (folder.path() / "missing").c_str(), 1);
    try {
        const UnnamedFile file;
        ADD_FAILURE() << "a file in a folder that is missing";
    } catch (const Error& error) {
        EXPECT_THAT(error.sentence(), testing::HasSubstr("cannot be made in"));
        EXPECT_THAT(error.hint(), testing::HasSubstr("TMPDIR"));
    }
    before ? ::setenv("TMPDIR", kept.c_str(), 1) : ::unsetenv("TMPDIR");
}

}  // namespace
}  // namespace scanmill::test
