// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/worker/resources.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace scanmill::test {
namespace {

TEST(ProcessState, FilesLeftOpen_AreCounted) {
    const ProcessState before = ProcessState::now();
    EXPECT_EQ(ProcessState::now().changes_since(before), "");
    const int one = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    EXPECT_EQ(ProcessState::now().changes_since(before), "1 more file is open");
    const int other = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    EXPECT_EQ(ProcessState::now().changes_since(before), "2 more files are open");
    ::close(other);
    ::close(one);
    EXPECT_EQ(ProcessState::now().changes_since(before), "");
}

}  // namespace
}  // namespace scanmill::test
