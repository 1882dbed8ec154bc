// SPDX-License-Identifier: GPL-3.0-or-later
/// Compares delaunay and alpha-solid together with CGAL::Delaunay_triangulation_3 alone, in turn, in one process.
///
/// Equal: the points in memory and the kernel (exact predicates). Not equal: CGAL makes a triangulation in its own
/// structure and order, in one thread, and its destruction is not measured. Our time includes everything from the cloud
/// to the boundary mesh, with canonical order and clean-up. Peak memory is that of a process that does nothing else,
/// including its points.
///
/// usage: delaunay_alpha_bench [rounds = 5] [--large] [file…]
/// --large adds 3.5 million points; files replace the scans of build/data.

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "alpha_solid/alpha_solid.hpp"
#include "delaunay/delaunay.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/formats/files.hpp"
#include "support/point_sets.hpp"

namespace {

using scanmill::PointCloud;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Bare = CGAL::Delaunay_triangulation_3<Kernel>;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

struct Input {
    std::string name;
    std::shared_ptr<const PointCloud> cloud;
};

struct Contender {
    std::string name;
    /// Returns the seconds of one run.
    std::function<double()> run;
    std::vector<double> seconds = {};
};

double run_bare(const std::vector<Kernel::Point_3>& points) {
    const auto begin = Clock::now();
    const Bare triangulation(points.begin(), points.end());
    const double seconds = seconds_since(begin);
    if (triangulation.dimension() != 3) fmt::print("flat\n");
    return seconds;
}

double run_ours(const PointCloud& cloud, unsigned threads, std::string* summary) {
    scanmill::ContextOptions options;
    options.threads = threads;
    scanmill::Context context(options);
    const auto begin = Clock::now();
    double delaunay_seconds = 0, seconds = 0;
    std::size_t cells = 0;
    {
        scanmill::AlphaSolidResult solid;
        {
            const scanmill::DelaunayResult tets = scanmill::delaunay(cloud, {}, context);
            delaunay_seconds = seconds_since(begin);
            cells = tets.tets.cells.size();
            solid = scanmill::alpha_solid(tets.tets, {}, context);
        }
        seconds = seconds_since(begin);
        if (!summary) return seconds;
        const scanmill::MeshTopology facts = scanmill::topology(solid.mesh);
        *summary = fmt::format(
            "{} cells, delaunay {:.0f} % of the time; alpha {:.5g}, alpha_cover {:.5g}, {} triangles, {}, {} "
            "components, "
            "genus {}, {} interior points, {} left out",
            cells, 100 * delaunay_seconds / seconds, solid.alpha, solid.alpha_cover, solid.mesh.triangles.size(),
            facts.closed ? "closed" : "open", facts.components, facts.genus.value_or(-1), solid.interior_points.size(),
            solid.uncovered_points.size());
    }
    return seconds;
}

std::vector<Kernel::Point_3> cgal_points(const PointCloud& cloud) {
    std::vector<Kernel::Point_3> points;
    points.reserve(cloud.size());
    for (const scanmill::Vec3& p : cloud.positions) points.emplace_back(p.x(), p.y(), p.z());
    return points;
}

/// Peak memory of `work` in a child process. Pre: no thread was started before.
double peak_mebibytes(const std::function<void()>& work) {
    const pid_t child = fork();
    if (child == 0) {
        work();
        _exit(0);
    }
    int status = 0;
    rusage usage{};
    wait4(child, &status, 0, &usage);
    if (status != 0) throw scanmill::Error("the run that measures peak memory ended with status {}", status);
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

void print_memory(const Input& input) {
    const double points = peak_mebibytes([] {});
    const double bare = peak_mebibytes([&] { run_bare(cgal_points(*input.cloud)); });
    const double one = peak_mebibytes([&] { run_ours(*input.cloud, 1, nullptr); });
    const double two = peak_mebibytes([&] { run_ours(*input.cloud, 2, nullptr); });
    fmt::print(
        "{:<16} peak memory: before {:.0f} MiB, bare CGAL {:.0f}, ours with 1 thread {:.0f}, with 2 threads {:.0f}\n",
        input.name, points, bare, one, two);
}

double median(std::vector<double> values) {
    std::ranges::sort(values);
    return values[values.size() / 2];
}

void compare(const Input& input, int rounds) {
    const std::vector<Kernel::Point_3> points = cgal_points(*input.cloud);
    std::string summary;
    std::vector<Contender> contenders;
    contenders.push_back({"CGAL Delaunay alone", [&] { return run_bare(points); }});
    contenders.push_back({"ours, 1 thread", [&] { return run_ours(*input.cloud, 1, &summary); }});
    contenders.push_back({"ours, 2 threads", [&] { return run_ours(*input.cloud, 2, &summary); }});
    for (int round = 0; round < rounds; ++round)
        for (Contender& contender : contenders) contender.seconds.push_back(contender.run());

    fmt::print("\n{}: {} points, {}\n", input.name, points.size(), summary);
    for (const Contender& contender : contenders) {
        const auto [least, most] = std::ranges::minmax(contender.seconds);
        std::vector<double> ratios;
        for (int round = 0; round < rounds; ++round)
            ratios.push_back(contender.seconds[round] / contenders[0].seconds[round]);
        fmt::print("  {:<20} {:7.3f} s  ({:.3f} to {:.3f})  {:.2f} of CGAL\n", contender.name,
                   median(contender.seconds), least, most, median(ratios));
    }
}

}  // namespace

int main(int argc, char** argv) {
    int rounds = 5;
    bool large = false;
    std::vector<std::string> files;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (argument == "--large")
            large = true;
        else if (argument.find_first_not_of("0123456789") == std::string::npos)
            rounds = std::max(1, std::stoi(argument));
        else
            files.push_back(argument);
    }
    if (files.empty())
        for (const char* fetched : {"build/data/meshes/bunny00.off", "build/data/dragon/dragon_vrip.ply"}) {
            if (std::filesystem::exists(fetched))
                files.push_back(fetched);
            else
                fmt::print("{} is missing and is left out\n", fetched);
        }

    std::vector<Input> inputs;
    try {
        for (const std::string& file : files)
            inputs.push_back({file.substr(file.rfind('/') + 1), scanmill::read_points(file)});
    } catch (const scanmill::Error& error) {
        fmt::print(stderr, "error: {}\n", error.what());
        return 1;
    }
    const auto torus = [](double distance, std::size_t count) {
        return std::make_shared<const PointCloud>(scanmill::test::poisson_torus(distance, 0.4, 1u << 20, 1, count));
    };
    inputs.push_back({"torus", torus(0.0052, 350'000)});
    if (large) inputs.push_back({"large torus", torus(0.00164, 3'500'000)});

    for (const Input& input : inputs) print_memory(input);
    for (const Input& input : inputs) compare(input, rounds);
}
