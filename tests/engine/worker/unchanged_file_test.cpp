// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/worker/unchanged_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "scanmill/base/hash.hpp"
#include "scanmill/plugin/module.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;

TEST(UnchangedWhileRead, FileThatStaysAsItWas_Passes) {
    const TemporaryFolder folder;
    const auto fresh = folder.write("fresh", "1 2 3");
    for (const std::filesystem::path& file : {fresh, core_library_file()})
        for (const bool beside : {false, true}) UnchangedWhileRead(file, content_hash(file), beside).require();
}

TEST(UnchangedWhileRead, FileThatChangedBefore_IsRefused) {
    const TemporaryFolder folder;
    for (const std::filesystem::path& file : {folder.write("fresh", "1 2 3"), core_library_file()})
        for (const bool beside : {false, true})
            EXPECT_THAT(sentence_of([&] { UnchangedWhileRead(file, std::string(32, '0'), beside).require(); }),
                        HasSubstr("changed during the run"));
}

TEST(UnchangedWhileRead, FileThatChangesAfterItWasHashed_IsRefused) {
    const TemporaryFolder folder;
    const auto file = folder.write("scan", "1 2 3");
    const std::string content = content_hash(file);
    std::this_thread::sleep_for(std::chrono::milliseconds(3100));  // or the stamps count for nothing
    for (const bool beside : {false, true}) {
        UnchangedWhileRead check(file, content, beside);
        std::this_thread::sleep_for(std::chrono::milliseconds(100));  // hashed by then, if beside
        folder.write("scan", "1 2 4");
        EXPECT_THAT(sentence_of([&] { check.require(); }), HasSubstr("changed during the run"));
        folder.write("scan", "1 2 3");
        std::this_thread::sleep_for(std::chrono::milliseconds(beside ? 0 : 3100));
    }
}

}  // namespace
}  // namespace scanmill::test
