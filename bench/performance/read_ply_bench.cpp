// SPDX-License-Identifier: GPL-3.0-or-later
/// Compares reading the points of a binary PLY file with reading its bytes: 3.5 million float points, from the page
/// cache, in turn, in one thread. "bytes" is read() into a buffer that is already mapped. "points" makes double
/// positions in new memory and computes their bounds.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "scanmill/formats/files.hpp"

namespace {

namespace fs = std::filesystem;
using namespace scanmill;

/// The file in a temporary folder, both removed at the end.
class PointFile {
public:
    PointFile() {
        std::string pattern = (fs::temp_directory_path() / "scanmill-bench-XXXXXX").string();
        if (!::mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder");
        folder_ = pattern;
        constexpr std::size_t count = 3'500'000;
        std::vector<float> numbers;
        numbers.reserve(3 * count);
        for (std::size_t i = 0; i < count; ++i) {
            const double turn = static_cast<double>(i) * 1e-3;
            for (double number : {std::cos(turn), std::sin(turn), turn}) numbers.push_back(static_cast<float>(number));
        }
        std::ofstream stream(path(), std::ios::binary);
        stream << "ply\nformat binary_little_endian 1.0\nelement vertex " << count
               << "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
        stream.write(reinterpret_cast<const char*>(numbers.data()),
                     static_cast<std::streamsize>(numbers.size() * sizeof(float)));
        if (!stream.flush()) throw std::runtime_error("the file could not be written");
    }
    ~PointFile() {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }
    PointFile(const PointFile&) = delete;
    PointFile& operator=(const PointFile&) = delete;

    fs::path path() const { return folder_ / "points.ply"; }

private:
    fs::path folder_;
};

double seconds_of(const std::function<void()>& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void read_bytes(const fs::path& path, std::vector<char>& buffer) {
    const int descriptor = ::open(path.c_str(), O_RDONLY);
    std::size_t at = 0;
    for (ssize_t got; at < buffer.size() && (got = ::read(descriptor, buffer.data() + at, buffer.size() - at)) > 0;)
        at += static_cast<std::size_t>(got);
    ::close(descriptor);
    if (at != buffer.size()) throw std::runtime_error("the file could not be read");
}

double median(std::vector<double> values) {
    std::ranges::sort(values);
    return values[values.size() / 2];
}

void print_row(const char* name, const std::vector<double>& seconds) {
    const auto [least, most] = std::ranges::minmax(seconds);
    fmt::print("{:<8} {:6.1f} ms  ({:.1f} to {:.1f})\n", name, 1e3 * median(seconds), 1e3 * least, 1e3 * most);
}

}  // namespace

int main() {
    constexpr int rounds = 15;
    const PointFile file;
    std::vector<char> buffer(fs::file_size(file.path()), 'x');
    std::vector<double> bytes, points, ratios;
    for (int round = 0; round < rounds; ++round) {
        bytes.push_back(seconds_of([&] { read_bytes(file.path(), buffer); }));
        points.push_back(seconds_of([&] { read_points(file.path()); }));
        ratios.push_back(points.back() / bytes.back());
    }
    const auto [least, most] = std::ranges::minmax(ratios);
    fmt::print("binary PLY, 3.5 million float points, {:.1f} MB\n", static_cast<double>(buffer.size()) / 1e6);
    print_row("bytes", bytes);
    print_row("points", points);
    fmt::print("points / bytes: {:.2f}  ({:.2f} to {:.2f})\n", median(ratios), least, most);
}
