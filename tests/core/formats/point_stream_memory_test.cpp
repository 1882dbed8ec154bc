// SPDX-License-Identifier: GPL-3.0-or-later
// What reading a file piece by piece has resident at most: pages of the file count, too.
#include <fcntl.h>
#include <unistd.h>

#include "core/formats/support.hpp"
#include "scanmill/formats/files.hpp"
#include "support/peak_memory.hpp"

namespace scanmill::test {
namespace {

constexpr double megabyte = 1 << 20;

/// `megabytes` of rows of 16 bytes, written in large blocks and flushed: the system keeps such a file in large pages.
fs::path large_ply(const TemporaryFolder& folder, std::size_t megabytes) {
    constexpr std::size_t row_size = 16;
    const std::size_t rows = (megabytes << 20) / row_size;
    const fs::path path = folder.write(
        "large.ply", fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\n"
                                 "property float y\nproperty float z\nproperty float w\nend_header\n",
                                 rows));
    const int file = ::open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
    const std::string block(std::size_t(4) << 20, '\1');
    for (std::size_t written = 0; written < rows * row_size; written += block.size())
        EXPECT_EQ(::write(file, block.data(), block.size()), static_cast<ssize_t>(block.size()));
    ::close(file);
    return path;
}

/// Every `step`th row.
std::vector<u32> sparse_rows(const PointStream& stream, std::size_t step) {
    std::vector<u32> rows;
    for (std::size_t row = 0; row < stream.size(); row += step) rows.push_back(static_cast<u32>(row));
    return rows;
}

TEST(PointStreamMemory, GatheringFewRowsOfALargeFile_HoldsAFewMegabytes) {
    const TemporaryFolder folder;
    const auto stream = open_point_stream(large_ply(folder, 96), {}, 1);
    ASSERT_TRUE(stream);
    for (const std::size_t step : {std::size_t(1000), std::size_t(5000), std::size_t(100'000)})
        for (const unsigned threads : {1u, 2u}) {
            const std::vector<u32> rows = sparse_rows(*stream, step);
            const auto peak = peak_of([&] { stream->gather(rows, threads); });
            if (!peak) GTEST_SKIP() << "the system does not tell peaks of memory";
            EXPECT_LT(*peak, 16 * megabyte) << rows.size() << " rows, " << threads << " threads";
        }
}

void expect_short_pieces(const fs::path& path) {
    const auto stream = open_point_stream(path, {}, 2);
    ASSERT_TRUE(stream) << path;
    for (std::size_t piece = 0; piece + 1 < stream->pieces().size(); ++piece)
        ASSERT_LE(stream->pieces()[piece + 1] - stream->pieces()[piece], std::size_t(1) << 16) << path;
}

TEST(PointStreamMemory, Pieces_AreShortHoweverShortTheRows) {
    const TemporaryFolder folder;
    std::string rows, last_line;
    for (int i = 0; i < 300'000; ++i) rows += "1 2 3\n";
    expect_short_pieces(folder.write("short.xyz", rows));
    for (int i = 0; i < 60'000; ++i) last_line += "1 2 3\r";
    expect_short_pieces(folder.write("one_line.xyz", last_line));
    expect_short_pieces(large_ply(folder, 8));
}

}  // namespace
}  // namespace scanmill::test
