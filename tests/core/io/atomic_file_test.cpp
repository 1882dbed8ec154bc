// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/io/atomic_file.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>

#include "support/temporary_folder.hpp"

namespace scanmill {
namespace {

namespace fs = std::filesystem;
using test::content_of;

TEST(AtomicFile, Commit_MakesTheFile_AndReplacesOne) {
    const test::TemporaryFolder folder;
    for (const char* text : {"first", "second"}) {
        AtomicFile file(folder / "a");
        file.write(text);
        EXPECT_NE(content_of(folder / "a"), text) << "not before commit";
        file.commit();
        EXPECT_EQ(content_of(folder / "a"), text);
        EXPECT_EQ(folder.files(), 1u);
    }
}

TEST(AtomicFile, EqualBytes_LeaveTheFileAsItIs) {
    const test::TemporaryFolder folder;
    const std::string large(200'000, 'x');
    const auto write = [&](const std::string& text) {
        AtomicFile file(folder / "a");
        file.write(text);
        file.commit();
        EXPECT_EQ(content_of(folder / "a"), text);
        EXPECT_EQ(folder.files(), 1u);
    };
    const auto age = [&](const std::string& content) {  // after a second write of `content`
        write(large);
        const auto old = fs::file_time_type::clock::now() - std::chrono::hours(1);
        fs::last_write_time(folder / "a", old);
        write(content);
        return fs::file_time_type::clock::now() - fs::last_write_time(folder / "a");
    };
    EXPECT_GT(age(large), std::chrono::minutes(59));
    std::string other = large;
    other.back() = 'y';
    EXPECT_LT(age(other), std::chrono::minutes(1)) << "the last byte differs";
    EXPECT_LT(age(large + "x"), std::chrono::minutes(1));
    EXPECT_LT(age(""), std::chrono::minutes(1));
}

TEST(AtomicFile, LinkToEqualBytes_IsReplacedByAFile) {
    const test::TemporaryFolder folder;
    folder.write("b", "same");
    fs::create_symlink(folder / "b", folder / "a");
    AtomicFile file(folder / "a");
    file.write("same");
    file.commit();
    EXPECT_FALSE(fs::is_symlink(folder / "a"));
}

TEST(AtomicFile, WithoutCommit_NothingIsLeft) {
    const test::TemporaryFolder folder;
    {
        AtomicFile file(folder / "a");
        file.write("x");
    }
    EXPECT_EQ(folder.files(), 0u);
}

TEST(AbandonedParts, OfProcessesThatAreGone_AreRemovedAfterAMinute) {
    const test::TemporaryFolder folder;
    const pid_t gone = ::fork();
    if (gone == 0) ::_exit(0);
    ::waitpid(gone, nullptr, 0);
    using namespace std::chrono_literals;
    const auto part = [&](pid_t process, std::chrono::seconds age) {
        const fs::path file = folder.write(".scanmill-" + std::to_string(process) + "-0.part", "x");
        fs::last_write_time(file, fs::file_time_type::clock::now() - age);
        return file;
    };
    const fs::path mine = part(::getpid(), 1h), other = folder.write(".scanmill-notes", "x");
    fs::last_write_time(other, fs::file_time_type::clock::now() - 1h);
    const fs::path fresh = part(gone, 0s);
    remove_abandoned_parts(folder.path());
    EXPECT_TRUE(fs::exists(fresh)) << "another machine may be writing it";
    part(gone, 2min);
    remove_abandoned_parts(folder.path());
    EXPECT_FALSE(fs::exists(fresh));
    EXPECT_TRUE(fs::exists(mine));
    EXPECT_TRUE(fs::exists(other));
    EXPECT_NO_THROW(remove_abandoned_parts(folder / "not-there"));
}

}  // namespace
}  // namespace scanmill
