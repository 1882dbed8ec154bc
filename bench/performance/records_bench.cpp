// SPDX-License-Identifier: GPL-3.0-or-later
// Records of many nights: how fast runs are listed and read, and what a night's costs are compared with. Prints
// seconds.
//
// records_bench [NIGHTS [CELLS [FOLDER]]]: with a folder, the records stay there, for `scanmill runs FOLDER`.

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "scanmill/records/run_records.hpp"

using namespace scanmill;

namespace {

constexpr std::size_t steps_per_cell = 5, metrics_per_step = 12, properties_per_output = 6;

RunStart start() {
    RunStart start;
    start.workflow = "nightly";
    start.file = "nightly.yaml";
    start.arguments = {"scanmill", "batch", "nightly.yaml", "-o", "out", "--no-cache"};
    start.jobs = 2;
    start.version = "0.1.0";
    start.machine = "a processor, 2 cores, 16 GiB, Linux x86_64";
    start.libraries = "Eigen 3.4.0, oneTBB 2021.8, glibc 2.36, GCC 12.2.0";
    start.gate = {{"hausdorff", "+1 %"}};
    return start;
}

double noise(std::size_t a, std::size_t b) { return static_cast<double>((a * 2654435761u + b * 40503u) % 1000) / 1e3; }

void add_night(RunRecords& records, std::size_t cells) {
    const std::int64_t run = records.begin(start());
    std::vector<StepRecord> steps;
    std::vector<CellRecord> ended;
    for (std::size_t cell = 0; cell < cells; ++cell) {
        CellRecord record;
        record.workflow = "reconstruction";
        record.scan = fmt::format("scans/part_{:04}.ply", cell / 2);
        record.variant = fmt::format("alpha={}", cell % 2);
        record.outcome = Outcome::ok;
        record.seconds = 1;
        for (std::size_t i = 0; i < steps_per_cell; ++i) {
            StepRecord step;
            step.node = cell * steps_per_cell + i;
            step.workflow = record.workflow;
            step.label = step.filter = fmt::format("filter-{}", i);
            step.filter_version = 1;
            step.scan = record.scan;
            step.plan_key = std::string(64, 'k');
            step.build = std::string(32, 'b');
            step.origin = Origin::ran;
            step.why = "there is no cache";
            step.outcome = Outcome::ok;
            step.effort.seconds = step.effort.cpu_seconds = noise(cell, i);
            step.effort.peak_memory = 100'000'000;
            step.attempts = 1;
            step.authored = {{"bin-size", "1 %diag"}, {"sharp-angle", "40 deg"}, {"smoothing", "0.5"}};
            step.resolved = {{"bin-size", "0.0123 u"}, {"sharp-angle", "40 deg"}, {"smoothing", "0.5"}};
            for (std::size_t metric = 0; metric < metrics_per_step; ++metric)
                step.metrics.set(fmt::format("metric-number-{}", metric), noise(cell, metric), Unit::length);
            record.nodes.push_back(step.node);
            steps.push_back(std::move(step));
        }
        record.costs = {{noise(cell, 1), noise(cell, 2), 100'000'000}};
        OutputRecord output;
        output.file = fmt::format("/nightly/out/part_{:04}.ply", cell);
        output.kind = "mesh";
        output.outcome = Outcome::ok;
        output.sha256 = std::string(64, 'a');
        output.bytes = 123'456;
        for (std::size_t property = 0; property < properties_per_output; ++property)
            output.properties.set(fmt::format("property-{}", property), noise(cell, property), Unit::count);
        record.outputs = {std::move(output)};
        ended.push_back(std::move(record));
        if (ended.size() < 100) continue;
        records.add(run, steps, ended);
        steps.clear();
        ended.clear();
    }
    records.end(run, steps, ended, "ok", 1000);
}

template <class Action>
double seconds(Action&& action) {
    const auto begin = std::chrono::steady_clock::now();
    action();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

int main(int count, char** arguments) {
    const std::size_t nights = count > 1 ? std::strtoul(arguments[1], nullptr, 10) : 30;
    const std::size_t cells = count > 2 ? std::strtoul(arguments[2], nullptr, 10) : 2000;
    const bool is_kept = count > 3;
    const std::filesystem::path folder =
        is_kept ? std::filesystem::path(arguments[3])
                : std::filesystem::temp_directory_path() / fmt::format("records_bench_{}", ::getpid());
    std::filesystem::create_directories(folder);
    const std::filesystem::path file = folder / records_file;
    if (!std::filesystem::exists(file)) {
        RunRecords records = RunRecords::append_to(file);
        for (std::size_t night = 0; night < nights; ++night) add_night(records, cells);
        records.accept(1, "ann", "the first night");
    }
    fmt::print("records of {} nights of {} cells: {:.0f} MB\n", nights, cells,
               static_cast<double>(std::filesystem::file_size(file)) / 1e6);
    const RunRecords records = RunRecords::read(file);
    const auto last = static_cast<std::int64_t>(nights);
    fmt::print("  list all runs          {:.4f} s\n", seconds([&] { records.runs(); }));
    fmt::print("  read the last run      {:.3f} s\n", seconds([&] { records.run(last); }));
    fmt::print("  read the first run     {:.3f} s\n", seconds([&] { records.run(1); }));
    fmt::print("  find the baseline      {:.4f} s\n", seconds([&] { records.baseline("nightly"); }));
    fmt::print("  costs since acceptance {:.3f} s\n", seconds([&] { records.past_costs(start(), 1, last); }));
    if (!is_kept) std::filesystem::remove_all(folder);
}
