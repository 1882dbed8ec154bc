// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/io/atomic_file.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <barrier>
#include <chrono>
#include <thread>
#include <vector>

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

TEST(AtomicFile, WritersOfEqualBytes_KeepTheFirstFile) {
    const test::TemporaryFolder folder;
    constexpr int writers = 6, rounds = 300;
    std::vector<std::array<ino_t, rounds>> files(writers);
    std::barrier together(writers);
    std::vector<std::thread> threads;
    for (auto& of_writer : files)
        threads.emplace_back([&] {
            for (int round = 0; round < rounds; ++round) {
                const fs::path target = folder / std::to_string(round);
                AtomicFile file(target);
                file.write("equal bytes");
                together.arrive_and_wait();
                file.commit(AtomicFile::Sync::no);
                struct stat status;
                ASSERT_EQ(::stat(target.c_str(), &status), 0);
                of_writer[static_cast<std::size_t>(round)] = status.st_ino;
            }
        });
    for (std::thread& thread : threads) thread.join();
    for (const auto& of_writer : files) EXPECT_EQ(of_writer, files[0]) << "others may have mapped the first file";
    EXPECT_EQ(folder.files(), std::size_t(rounds));
}

using namespace std::chrono_literals;

class AbandonedParts : public testing::Test {
protected:
    /// A temporary file of this age.
    fs::path part(const std::string& host, pid_t process, std::chrono::seconds age) {
        const fs::path file = folder_.write(fmt::format(".scanmill-{}-{}-0.part", host, process), "x");
        fs::last_write_time(file, fs::file_time_type::clock::now() - age);
        return file;
    }
    static std::string this_host() {
        std::array<char, 65> name{};
        ::gethostname(name.data(), name.size() - 1);
        return name.data();
    }
    static pid_t ended_process() {
        const pid_t gone = ::fork();
        if (gone == 0) ::_exit(0);
        ::waitpid(gone, nullptr, 0);
        return gone;
    }
    test::TemporaryFolder folder_;
};

TEST_F(AbandonedParts, OfThisMachine_AreRemovedAMinuteAfterTheEndOfTheirProcess) {
    const pid_t gone = ended_process();
    const fs::path mine = part(this_host(), ::getpid(), 1h), other = folder_.write(".scanmill-notes", "x");
    fs::last_write_time(other, fs::file_time_type::clock::now() - 48h);
    const fs::path fresh = part(this_host(), gone, 0s);
    remove_abandoned_parts(folder_.path());
    EXPECT_TRUE(fs::exists(fresh)) << "a container of this machine may be writing it";
    part(this_host(), gone, 2min);
    remove_abandoned_parts(folder_.path());
    EXPECT_FALSE(fs::exists(fresh));
    EXPECT_TRUE(fs::exists(mine));
    EXPECT_TRUE(fs::exists(other));
    EXPECT_NO_THROW(remove_abandoned_parts(folder_ / "not-there"));
}

TEST_F(AbandonedParts, OfOtherMachines_AreRemovedAfterADay) {
    const pid_t gone = ended_process();
    const fs::path theirs = part("node-7.cluster", gone, 2h), old = part("node-7.cluster", ::getpid(), 25h);
    remove_abandoned_parts(folder_.path());
    EXPECT_TRUE(fs::exists(theirs)) << "their processes cannot be seen, and their clocks may differ";
    EXPECT_FALSE(fs::exists(old));
}

}  // namespace
}  // namespace scanmill
