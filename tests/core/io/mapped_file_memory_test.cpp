// SPDX-License-Identifier: GPL-3.0-or-later
// After release(), no page of a mapped file counts as memory, also those that the system mapped around each access,
// single pages or blocks of 2 MB.
#include <gtest/gtest.h>

#include <fstream>
#include <optional>

#include "scanmill/io/mapped_file.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

/// Bytes of the file that are resident in this process; empty where the system does not report them.
std::optional<std::size_t> resident_of(const std::filesystem::path& file) {
    std::ifstream mappings("/proc/self/smaps");
    if (!mappings) return std::nullopt;
    std::size_t bytes = 0;
    bool is_its = false;
    for (std::string line; std::getline(mappings, line);) {
        const bool begins_a_mapping = line.find('-') < line.find(' ');
        if (begins_a_mapping) is_its = line.ends_with(file.string());
        if (is_its && line.starts_with("Rss:")) bytes += 1024 * std::stoul(line.substr(4));
    }
    return bytes;
}

class MappedFileMemory : public testing::Test {
protected:
    static constexpr std::size_t size = std::size_t(24) << 20;
    /// Writes page by page: the system then keeps the file in pages, and maps some around each access. It would release
    /// larger blocks as a whole.
    MappedFileMemory() : path_(std::filesystem::canonical(folder_.write("large", ""))) {
        constexpr std::size_t page = 4096;
        std::ofstream stream(path_, std::ios::binary);
        for (std::size_t written = 0; written < size; written += page) (stream << std::string(page, '\1')).flush();
    }

    TemporaryFolder folder_;
    std::filesystem::path path_;
};

TEST_F(MappedFileMemory, BytesTouchedHereAndThere_LeaveNothingWhenGivenBack) {
    const MappedFile file(path_, false);
    // Not on the limits of blocks, nor only at their beginnings.
    constexpr std::size_t step = 1'300'021;
    volatile char sum = 0;
    for (std::size_t at = 700'000; at < size; at += step) sum = static_cast<char>(sum + file.bytes()[at]);
    const std::optional<std::size_t> touched = resident_of(path_);
    if (!touched) GTEST_SKIP() << "the system does not report the resident pages of a file";
    EXPECT_GT(*touched, 0u);
    for (std::size_t at = 700'000; at < size; at += step) file.release(file.bytes().substr(at, 1));
    EXPECT_EQ(resident_of(path_), 0u) << "of " << *touched << " bytes";
}

TEST_F(MappedFileMemory, APartThatWasFetched_LeavesNothingWhenGivenBack) {
    const MappedFile file(path_, false);
    const std::string_view part = file.bytes().substr(5'000'001, 3'000'000);
    file.fetch(part);
    volatile char last = part.back();  // where fetching is not to be had
    static_cast<void>(last);
    const std::optional<std::size_t> fetched = resident_of(path_);
    if (!fetched) GTEST_SKIP() << "the system does not report the resident pages of a file";
    EXPECT_GT(*fetched, 0u);
    file.release(part);
    EXPECT_EQ(resident_of(path_), 0u) << "of " << *fetched << " bytes";
    EXPECT_EQ(file.bytes()[5'000'001], '\1') << "it can be read again";
}

}  // namespace
}  // namespace scanmill::test
