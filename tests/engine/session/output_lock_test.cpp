// SPDX-License-Identifier: GPL-3.0-or-later
// One run per output folder: the lock, and what a killed holder leaves.
#include "scanmill/session/output_lock.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <optional>

#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

class LockedFolder : public testing::Test {
protected:
    OutputLock locked(const std::string& command = "batch") {
        return OutputLock(folder_.path(), {"scanmill", command}, [&](std::string text) { warnings_.push_back(text); });
    }
    TemporaryFolder folder_;
    std::vector<std::string> warnings_;
};

TEST_F(LockedFolder, SecondRun_IsRefusedWithTheFirstOne) {
    const OutputLock first = locked("first");
    try {
        locked("second");
        FAIL() << "nothing was refused";
    } catch (const FolderInUse& error) {
        EXPECT_THAT(
            error.sentence(),
            AllOf(HasSubstr(fmt::format("the output folder '{}' is in use: process {} (scanmill first) has been "
                                        "writing to it for ",
                                        folder_.path().string(), ::getpid())),
                  testing::EndsWith(" s")));
        EXPECT_THAT(error.hint(), HasSubstr("wait until it has ended"));
    }
    EXPECT_TRUE(OutputLock::is_held(folder_.path()));
    EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(LockedFolder, AfterTheRun_IsFree_AndHoldsNoFileOfIt) {
    { const OutputLock first = locked(); }
    EXPECT_FALSE(OutputLock::is_held(folder_.path()));
    EXPECT_EQ(folder_.files(), 0u);
    const OutputLock second = locked();
    EXPECT_TRUE(OutputLock::is_held(folder_.path()));
}

TEST_F(LockedFolder, LookingAtTheLock_LetsARunBegin) {
    folder_.write("scanmill.lock", "");
    EXPECT_FALSE(OutputLock::is_held(folder_.path()));
    const OutputLock run = locked();
}

TEST_F(LockedFolder, ProcessThatIsKilled_LeavesNoLock) {
    int ready[2];
    ASSERT_EQ(::pipe(ready), 0);
    const int child = ::fork();
    if (child == 0) {
        const OutputLock held = locked("killed");
        [[maybe_unused]] const ssize_t sent = ::write(ready[1], "x", 1);
        for (;;) ::pause();
    }
    char received = 0;
    ASSERT_EQ(::read(ready[0], &received, 1), 1);
    EXPECT_TRUE(OutputLock::is_held(folder_.path()));
    EXPECT_THAT(sentence_of([&] { locked(); }), HasSubstr(fmt::format("process {} (scanmill killed)", child)));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "scanmill.lock")) << "its file stays";
    EXPECT_FALSE(OutputLock::is_held(folder_.path()));
    const OutputLock next = locked("next");
    EXPECT_THAT(sentence_of([&] { locked(); }), HasSubstr("(scanmill next)"));
}

TEST_F(LockedFolder, FileOfSomethingElse_IsOverwritten_ALinkIsNotFollowed) {
    folder_.write("scanmill.lock", "[1, 2");
    { const OutputLock run = locked(); }
    const TemporaryFolder elsewhere;
    std::filesystem::create_symlink(elsewhere / "target", folder_ / "scanmill.lock");
    const OutputLock run = locked();
    EXPECT_THAT(warnings_, testing::ElementsAre(AllOf(HasSubstr("cannot be locked"), HasSubstr("another run"))));
    EXPECT_EQ(elsewhere.files(), 0u);
}

TEST_F(LockedFolder, HolderWhoseTextCannotBeRead_IsStillNamedAsOne) {
    const OutputLock run = locked();
    folder_.write("scanmill.lock", R"({"process": "no number"})");
    EXPECT_THAT(sentence_of([&] { locked(); }), HasSubstr("is in use: another process is writing to it"));
}

}  // namespace
}  // namespace scanmill::test
