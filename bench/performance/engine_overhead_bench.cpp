// SPDX-License-Identifier: GPL-3.0-or-later
/// Measures the overhead of the engine: compares `scanmill run workflows/quickstart.yaml` with a program that only
/// calls the same filters one after the other.
///
/// Equal: the scans, the filters' modules, their parameters, the threads, the STL files written, and one process
/// started per run; all in turn. Not equal: the engine also starts a worker process, checks the workflow, hashes the
/// scans, computes cache keys, checks the expectations, and writes its records and a description of every file. The
/// cost per run matters less with more scans.
///
/// usage: engine_overhead_bench [rounds = 11]

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "scanmill/formats/files.hpp"
#include "scanmill/kinds/length_scale.hpp"
#include "scanmill/plugin/library.hpp"

namespace {

namespace fs = std::filesystem;

using scanmill::Value;

/// Runs one filter from its module, with the given parameters and defaults for the others.
Value run_filter(scanmill::FilterLibrary& library, const std::string& name, const std::string& port, Value input,
                 const scanmill::ParameterSet& given, scanmill::Context& context) {
    const scanmill::FilterDeclaration& filter = library.load(name);
    scanmill::ParameterSet parameters;
    for (const scanmill::ParameterSpec& parameter : filter.spec.parameters) {
        const scanmill::ParameterValue* value = given.find(parameter.name);
        parameters.values.emplace_back(parameter.name, value ? *value : parameter.default_value);
    }
    scanmill::Inputs inputs;
    inputs.add(port, std::move(input));
    return *filter.run(inputs, parameters, context).find(filter.spec.outputs.front().name);
}

void run_filters(scanmill::FilterLibrary& library, scanmill::Context& context, double percent, const fs::path& scan,
                 const fs::path& output) {
    using namespace scanmill;
    const Value points = read_points(scan);
    ParameterSet thinning;
    thinning.values.emplace_back("bin-size",
                                 ParameterScalar(Length::percent_of_diagonal(percent).resolved(length_scale(points))));
    const Value thin = run_filter(library, "voxel-thin", "points", points, thinning, context);
    const Value tets = run_filter(library, "delaunay", "points", thin, {}, context);
    write_file(output, run_filter(library, "alpha-solid", "tets", tets, {}, context));
}

/// The quickstart workflow as a C++ program, with the code of the filters' modules.
int run_filters(double percent, const fs::path& folder, const std::vector<fs::path>& scans) {
    fs::create_directories(folder);
    scanmill::ContextOptions options;
    options.threads = std::max(1u, std::thread::hardware_concurrency());
    scanmill::Context context(std::move(options));
    scanmill::FilterLibrary library(scanmill::plugin_folders());
    for (const fs::path& scan : scans)
        run_filters(library, context, percent, scan, folder / scan.stem().concat(".stl"));
    return 0;
}

double seconds_of(const std::vector<std::string>& command) {
    std::vector<char*> arguments;
    for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t quiet;
    ::posix_spawn_file_actions_init(&quiet);
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO})
        ::posix_spawn_file_actions_addopen(&quiet, stream, "/dev/null", O_WRONLY, 0);
    const auto start = std::chrono::steady_clock::now();
    pid_t process = 0;
    const int trouble = ::posix_spawn(&process, arguments[0], &quiet, nullptr, arguments.data(), environ);
    ::posix_spawn_file_actions_destroy(&quiet);
    if (trouble != 0) throw std::runtime_error(command[0] + " cannot be started");
    int status = 0;
    ::waitpid(process, &status, 0);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) throw std::runtime_error(command[0] + " failed");
    return seconds.count();
}

struct Contender {
    std::string name;
    std::vector<std::string> command;
    std::function<void()> prepare = [] {};
    std::vector<double> seconds = {};
};

double median(std::vector<double> numbers) {
    std::ranges::sort(numbers);
    return numbers[numbers.size() / 2];
}

void compare(double percent, const std::vector<std::string>& scans, const fs::path& programs, const fs::path& folder,
             int rounds) {
    const std::string out = (folder / "out").string(), cache = (folder / "cache").string();
    const auto with_scans = [&](std::vector<std::string> command) {
        command.insert(command.end(), scans.begin(), scans.end());
        return command;
    };
    const auto run = [&](std::vector<std::string> more) {
        std::vector<std::string> command{
            (programs / "scanmill").string(),         "run", "workflows/quickstart.yaml", "-q", "-o", out, "--set",
            fmt::format("bin-size={} %diag", percent)};
        command.insert(command.end(), more.begin(), more.end());
        return with_scans(std::move(command));
    };
    const auto without_cache = [&] { fs::remove_all(cache); };
    std::vector<Contender> contenders{
        {"the filters alone", with_scans({(programs / "engine_overhead_bench").string(), "--filters",
                                          fmt::format("{}", percent), (folder / "alone").string()})},
        {"no cache", run({"--no-cache"})},
        {"no cache, in one process", run({"--no-cache", "-j", "0"})},
        {"a warm cache, nothing to store", run({"--cache", cache + "-never", "--keep", "never"})},
        {"an empty cache, values worth storing", run({"--cache", cache}), without_cache},
        {"an empty cache, every value", run({"--cache", cache, "--keep", "always"}), without_cache},
        {"everything cached", run({"--cache", cache + "-full", "--keep", "always"})},
    };
    for (int round = 0; round <= rounds; ++round)  // the first round is a warm-up
        for (Contender& contender : contenders) {
            contender.prepare();
            const double seconds = seconds_of(contender.command);
            if (round > 0) contender.seconds.push_back(seconds);
        }
    for (const std::string& scan : scans) fmt::print("{}, ", fs::path(scan).filename().string());
    fmt::print("voxel size {} % of the diagonal\n", percent);
    for (const Contender& contender : contenders) {
        std::vector<double> ratios;
        for (std::size_t i = 0; i < contender.seconds.size(); ++i)
            ratios.push_back(contender.seconds[i] / contenders.front().seconds[i]);
        const auto [least, most] = std::ranges::minmax(ratios);
        fmt::print("  {:<34} {:7.1f} ms   {:.3f} of the filters alone ({:.3f} to {:.3f})\n", contender.name,
                   1e3 * median(contender.seconds), median(ratios), least, most);
    }
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc > 4 && std::strcmp(argv[1], "--filters") == 0)
        return run_filters(std::strtod(argv[2], nullptr), argv[3], {argv + 4, argv + argc});
    const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 11;
    const fs::path programs = fs::canonical("/proc/self/exe").parent_path();
    const fs::path folder = fs::temp_directory_path() / fmt::format("engine-overhead-{}", ::getpid());
    fs::create_directories(folder);
    const std::string data = "build/data/", bunny = data + "meshes/bunny00.off";
    const std::vector<std::string> demo{data + "points_3/kitten.xyz", data + "points_3/ball.ply", bunny,
                                        data + "meshes/fandisk_large.off"};
    const std::string dragon = data + "dragon/dragon_vrip.ply";
    for (const auto& [percent, scans] : {std::pair(0.5, std::vector{bunny}), std::pair(0.5, std::vector{dragon}),
                                         std::pair(0.5, demo), std::pair(0.25, std::vector{dragon})}) {
        for (const std::string& scan : scans)
            if (!fs::exists(scan)) throw std::runtime_error(scan + " is missing; make data fetches it");
        compare(percent, scans, programs, folder, rounds);
    }
    fs::remove_all(folder);
    return 0;
} catch (const std::exception& error) {
    fmt::print("failed: {}\n", error.what());
    return 1;
}
