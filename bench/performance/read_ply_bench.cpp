// SPDX-License-Identifier: GPL-3.0-or-later
// How much longer does it take to read the points of a binary PLY file than to read its bytes? Both from the page
// cache, 3.5 million float points, one thread: the second benchmark over the first is the figure to quote. "Bytes" is
// read() into a buffer that was touched before; "points" makes the double positions in fresh memory, bounds included.
#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "scanmill/formats/files.hpp"

namespace {

namespace fs = std::filesystem;
using namespace scanmill;

/// The file, in a temporary folder that goes with it.
class PointFile {
public:
    PointFile() {
        std::string pattern = (fs::temp_directory_path() / "scanmill-bench-XXXXXX").string();
        if (!::mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder");
        folder_ = pattern;
        constexpr std::size_t count = 3'500'000;
        Array<Vec3> positions(count);
        for (std::size_t i = 0; i < count; ++i) {
            const double turn = static_cast<double>(i) * 1e-3;
            const auto rounded = [](double value) { return static_cast<double>(static_cast<float>(value)); };
            positions[i] = {rounded(std::cos(turn)), rounded(std::sin(turn)), rounded(turn)};
        }
        PointCloud cloud;
        cloud.positions = std::move(positions);
        write_file(path(), std::make_shared<const PointCloud>(std::move(cloud)));
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

const PointFile& point_file() {
    static const PointFile file;
    return file;
}

void read_the_bytes(benchmark::State& state) {
    const fs::path path = point_file().path();
    std::vector<char> buffer(fs::file_size(path), 'x');
    for (auto _ : state) {
        const int descriptor = ::open(path.c_str(), O_RDONLY);
        std::size_t at = 0;
        for (ssize_t got; at < buffer.size() && (got = ::read(descriptor, buffer.data() + at, buffer.size() - at)) > 0;)
            at += static_cast<std::size_t>(got);
        ::close(descriptor);
        if (at != buffer.size()) state.SkipWithError("the file could not be read");
        benchmark::DoNotOptimize(buffer.data());
    }
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * buffer.size()));
}

void read_the_points(benchmark::State& state) {
    const fs::path path = point_file().path();
    const auto size = fs::file_size(path);
    for (auto _ : state) {
        const auto cloud = read_points(path);
        benchmark::DoNotOptimize(cloud->positions.data());
    }
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * size));
}

BENCHMARK(read_the_bytes)->Unit(benchmark::kMillisecond);
BENCHMARK(read_the_points)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
