// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Batches of small scans in a folder of their own, run by the built command.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "support/folders.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {

class Batch : public testing::Test {
protected:
    using Json = nlohmann::json;

    /// Scans `<name>_01.xyz` … below scans/, no two alike.
    void write_scans(const std::string& name, int count) {
        for (int i = 1; i <= count; ++i) {
            const double shift = static_cast<double>(++scans_);
            folder_.write(fmt::format("scans/{}_{:02}.xyz", name, i),
                          fmt::format("{0} 0 0\n{1} 0 0\n{0} 2 0\n{1} 2 2\n{0} 1 {0}\n", shift, shift + 1));
        }
    }
    /// Two test-steps: `shared`, then `last` for every factor; `last` misbehaves as the parameter `mode` says.
    void write_workflow(const std::string& factors = "{sweep: [1, 2, 3, 4]}") {
        folder_.write("w.yaml",
                      "scanmill: 1\nname: w\ninputs: {scan: points}\nparameters: {mode: pass, first: pass}\nsteps:\n"
                      "  - id: shared\n    test-step: {mode: $first, factor: 0.5}\n"
                      "  - id: last\n    test-step: {mode: $mode, factor: " +
                          factors + "}\n    in: {points: shared.points}\noutputs: {'{scan}.{variant}.ply': last}\n");
    }
    /// `scans`: the list's entries; `rest`: what follows.
    void write_batch(const std::string& scans, const std::string& rest = "") {
        folder_.write("b.yaml", "scanmill: 1\nbatch: b\nscans: [" + scans + "]\nworkflows: w.yaml\n" + rest);
    }
    ProgramOptions options() const {
        return {.folder = folder_.path(),
                .environment = {"SCANMILL_PLUGIN_PATH=" + test::test_plugin_folder(),
                                // The signals are what is tested here, not what a sanitizer makes of them.
                                "ASAN_OPTIONS=handle_segv=0:handle_abort=0:allocator_may_return_null=0"},
                .cache = folder_ / "home"};
    }
    ProgramResult scanmill(const std::vector<std::string>& arguments) { return scanmill_program(arguments, options()); }
    ProgramResult run_batch(const std::vector<std::string>& more = {}) {
        std::vector<std::string> arguments{"batch", "b.yaml", "-o", "out"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return scanmill(arguments);
    }
    Json recorded(int run) {
        return Json::parse(scanmill({"runs", "out", "show", std::to_string(run), "--json"}).out, nullptr, false);
    }
    static std::size_t count(const Json& rows, const std::string& key, const Json& value) {
        return static_cast<std::size_t>(
            std::count_if(rows.begin(), rows.end(), [&](const Json& row) { return row.value(key, Json()) == value; }));
    }
    static std::vector<Json> of_step(const Json& run, const std::string& label) {
        std::vector<Json> found;
        for (const Json& step : run["steps"])
            if (step["step"] == label) found.push_back(step);
        return found;
    }
    /// Everything in the output folder but the records, their lock, descriptions and what a killed process left under a
    /// temporary name, which later runs remove: name → bytes.
    std::map<std::string, std::string> outputs(const std::string& folder = "out", bool descriptions = false) const {
        std::map<std::string, std::string> all;
        for (const auto& entry : std::filesystem::directory_iterator(folder_ / folder))
            if (const std::string name = entry.path().filename().string(); !name.starts_with("scanmill.") &&
                                                                           !name.starts_with(".scanmill-") &&
                                                                           (descriptions || !name.ends_with(".json")))
                all[entry.path().filename().string()] = content_of(entry.path());
        return all;
    }

    TemporaryFolder folder_;
    int scans_ = 0;
};

}  // namespace scanmill::test
