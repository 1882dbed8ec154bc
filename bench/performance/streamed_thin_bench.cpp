// SPDX-License-Identifier: GPL-3.0-or-later
/// Compares thinning a file in chunks with reading it whole and thinning it, in turn, in one process: points per second
/// and memory.
///
/// The input is a sphere with noise, scanned line by line, as binary PLY of floats and as text, in the page cache.
/// Equal: file, voxel size, threads; the results have the same bytes. Memory is the peak resident memory above that
/// before the run. It is measured at two voxel sizes: the difference in memory over the difference in kept points is
/// the memory per kept point, and the rest is buffers. A third voxel size keeps few points, far from each other in the
/// file.
///
/// usage: streamed_thin_bench [millions of points = 20] [rounds = 5]

#include <fcntl.h>
#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "scanmill/base/random.hpp"
#include "scanmill/formats/files.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace {

namespace fs = std::filesystem;
using namespace scanmill;

/// A temporary folder, removed with its content at the end.
class Folder {
public:
    Folder() {
        std::string pattern = (fs::temp_directory_path() / "scanmill-bench-XXXXXX").string();
        if (!::mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder");
        path_ = pattern;
    }
    ~Folder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    fs::path operator/(const char* name) const { return path_ / name; }

private:
    fs::path path_;
};

/// Point `row` of `count`, on a sphere of radius 100.
std::array<float, 3> scanned(std::size_t row, std::size_t count, Random& random) {
    const auto line = static_cast<std::size_t>(std::sqrt(static_cast<double>(count)));
    const double angle = 2 * std::numbers::pi * static_cast<double>(row % line) / static_cast<double>(line);
    const double z = 2 * static_cast<double>(row) / static_cast<double>(count) - 1, ring = std::sqrt(1 - z * z);
    const double radius = 100 + 0.01 * random.uniform();
    return {static_cast<float>(radius * ring * std::cos(angle)), static_cast<float>(radius * ring * std::sin(angle)),
            static_cast<float>(radius * z)};
}

/// Writes in large blocks, as scanner software does. The system then also maps the file in large blocks.
class LargeFile {
public:
    explicit LargeFile(const fs::path& path) {
        stream_.rdbuf()->pubsetbuf(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
        stream_.open(path, std::ios::binary);
    }
    std::ofstream& stream() { return stream_; }

private:
    std::vector<char> buffer_ = std::vector<char>(std::size_t(1) << 22);
    std::ofstream stream_;
};

void write_ply(const fs::path& path, std::size_t count) {
    LargeFile large(path);
    std::ofstream& file = large.stream();
    file << "ply\nformat binary_little_endian 1.0\nelement vertex " << count
         << "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    Random random(1);
    for (std::size_t row = 0; row < count; ++row) {
        const std::array<float, 3> point = scanned(row, count, random);
        file.write(reinterpret_cast<const char*>(point.data()), sizeof point);
    }
    if (!file.flush()) throw std::runtime_error("the file could not be written");
}

void write_text(const fs::path& path, std::size_t count) {
    LargeFile large(path);
    std::ofstream& file = large.stream();
    Random random(1);
    for (std::size_t row = 0; row < count; ++row) {
        std::array<char, 100> line;
        char* end = line.data();
        for (const float number : scanned(row, count, random)) {
            end = std::to_chars(end, line.data() + line.size(), number).ptr;
            *end++ = ' ';
        }
        end[-1] = '\n';
        file.write(line.data(), end - line.data());
    }
    if (!file.flush()) throw std::runtime_error("the file could not be written");
}

double resident_megabytes(const char* line_begins) {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with(line_begins)) return std::stod(line.substr(line.find_first_of("0123456789"))) / 1024;
    throw std::runtime_error("the system does not report the resident memory");
}

struct Cost {
    double seconds = 0, megabytes = 0;
    std::size_t kept = 0;
};

Cost cost_of(const std::function<std::size_t()>& thin) {
    ::malloc_trim(0);
    if (std::ofstream peak("/proc/self/clear_refs"); !(peak << 5).flush())  // resets the peak
        throw std::runtime_error("the peak memory cannot be reset");
    const double before = resident_megabytes("VmRSS");
    const auto begin = std::chrono::steady_clock::now();
    Cost cost;
    cost.kept = thin();
    cost.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    cost.megabytes = resident_megabytes("VmHWM") - before;
    return cost;
}

ContextOptions with(unsigned threads) {
    ContextOptions options;
    options.threads = threads;
    return options;
}

std::size_t thin_stream(const fs::path& path, double bin_size, unsigned threads) {
    Context context(with(threads));
    VoxelThinParams params;
    params.bin_size = bin_size;
    const auto stream = open_point_stream(path, {}, threads);
    if (!stream) throw std::runtime_error("the file cannot be read in chunks");
    return voxel_thin(*stream, params, context).points.size();
}

std::size_t thin_whole(const fs::path& path, double bin_size, unsigned threads) {
    Context context(with(threads));
    VoxelThinParams params;
    params.bin_size = bin_size;
    return voxel_thin(*read_points(path), params, context).points.size();
}

double median(std::vector<double> values) {
    std::ranges::sort(values);
    return values[values.size() / 2];
}

void compare(const fs::path& path, std::size_t points, int rounds) {
    struct Contender {
        std::string name;
        std::size_t (*thin)(const fs::path&, double, unsigned);
        unsigned threads;
        std::vector<double> seconds = {};
        Cost sparse = {}, coarse = {}, fine = {};
    };
    std::vector<Contender> contenders{{"streamed, 1 thread", thin_stream, 1},
                                      {"streamed, 2 threads", thin_stream, 2},
                                      {"whole, 2 threads", thin_whole, 2}};
    constexpr double sparse = 20, coarse = 2, fine = 0.2;
    for (int round = 0; round < rounds; ++round)
        for (Contender& each : contenders) {
            each.sparse = cost_of([&] { return each.thin(path, sparse, each.threads); });
            each.coarse = cost_of([&] { return each.thin(path, coarse, each.threads); });
            each.fine = cost_of([&] { return each.thin(path, fine, each.threads); });
            each.seconds.push_back(each.coarse.seconds);
        }
    fmt::print("\n{}: {:.0f} MB, {} points, {} kept in voxels of {}, {} in voxels of {}\n", path.filename().string(),
               static_cast<double>(fs::file_size(path)) / 1e6, points, contenders.front().coarse.kept, coarse,
               contenders.front().fine.kept, fine);
    for (const Contender& each : contenders) {
        const auto [least, most] = std::ranges::minmax(each.seconds);
        const double megabytes_more = each.fine.megabytes - each.coarse.megabytes;
        const double bytes = megabytes_more * 1048576 / static_cast<double>(each.fine.kept - each.coarse.kept);
        const double buffers = each.coarse.megabytes - bytes * static_cast<double>(each.coarse.kept) / 1048576;
        fmt::print(
            "  {:<20} {:6.2f} million points/s  ({:.2f} to {:.2f} s)  {:4.0f} bytes per kept point and {:.0f} MB; "
            "{:.0f} MB when {} are kept\n",
            each.name, static_cast<double>(points) / 1e6 / median(each.seconds), least, most, bytes, buffers,
            each.sparse.megabytes, each.sparse.kept);
    }
}

}  // namespace

int main(int argc, char** argv) {
    const std::size_t points = std::size_t(1'000'000) * (argc > 1 ? std::stoul(argv[1]) : 20);
    const int rounds = argc > 2 ? std::max(1, std::stoi(argv[2])) : 5;
    const Folder folder;
    write_ply(folder / "scan.ply", points);
    compare(folder / "scan.ply", points, rounds);
    write_text(folder / "scan.xyz", points);
    compare(folder / "scan.xyz", points, rounds);
}
