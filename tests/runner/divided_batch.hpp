// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A batch of seven scans with two variants each, and of a workflow that takes all scans: 8 units with 15 cells. With
/// large voxels, some cells fail.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "support/folders.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {

class DividedBatch : public testing::Test {
protected:
    DividedBatch() {
        std::filesystem::create_directories(folder_ / "scans");
        for (int scan = 0; scan < 7; ++scan)
            folder_.write("scans/s" + std::to_string(scan) + ".xyz",
                          "0 0 0\n1 0 0\n0 2 0\n1 2 " + std::to_string(scan + 2) + "\n");
        folder_.write("w.yaml",
                      "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n"
                      "  - voxel-thin: {bin-size: {sweep: [0.1 u, 3 u]}}\n    expect: {points: '> 2'}\n"
                      "outputs: {'{scan}-{variant}.ply': voxel-thin}\n");
        folder_.write("all.yaml",
                      "scanmill: 1\nname: all\ninputs: {views: [points]}\nsteps:\n  - merge:\n"
                      "outputs: {'together.ply': merge}\n");
        write_batch("points: exact");
    }
    void write_batch(const std::string& gate) {
        folder_.write("b.yaml",
                      "scanmill: 1\nbatch: b\nscans: [\"scans/*.xyz\"]\nworkflows: [w.yaml, all.yaml]\n"
                      "gate: {" +
                          gate + "}\n");
    }
    ProgramOptions options() const {
        return {.folder = folder_.path(), .environment = environment_, .cache = folder_ / "home"};
    }
    ProgramResult scanmill(const std::vector<std::string>& arguments) { return scanmill_program(arguments, options()); }
    ProgramResult shard(const std::string& text, const std::string& out) {
        return scanmill({"batch", "b.yaml", "--shard", text, "-o", out, "-q"});
    }
    void run_shards(int count) {
        for (int number = 1; number <= count; ++number)
            shard(std::to_string(number) + "/" + std::to_string(count), "p" + std::to_string(number));
    }
    /// Merges the folders `prefix`1, `prefix`2, … in an order that the seed decides.
    ProgramResult merge_shuffled(const std::string& prefix, int count, unsigned seed, const std::string& out) {
        std::vector<std::string> folders;
        for (int number = 1; number <= count; ++number) folders.push_back(prefix + std::to_string(number));
        std::shuffle(folders.begin(), folders.end(), std::mt19937(seed));
        return merge(folders, out);
    }
    ProgramResult merge(const std::vector<std::string>& folders, const std::string& out = "whole") {
        std::vector<std::string> arguments{"runs", "merge"};
        arguments.insert(arguments.end(), folders.begin(), folders.end());
        arguments.insert(arguments.end(), {"-o", out});
        return scanmill(arguments);
    }
    /// By name, the bytes of the outputs below the folder and of their descriptions.
    std::map<std::string, std::string> outputs(const std::string& out) {
        std::map<std::string, std::string> files;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / out))
            if (entry.is_regular_file() && !entry.path().filename().string().starts_with("scanmill."))
                files[std::filesystem::relative(entry.path(), folder_ / out).string()] = content_of(entry.path());
        return files;
    }
    /// The names of files that only one of them has, or that have different bytes.
    static std::vector<std::string> differences(const std::map<std::string, std::string>& some,
                                                const std::map<std::string, std::string>& others) {
        std::vector<std::string> names;
        for (const auto& [name, bytes] : some)
            if (const auto other = others.find(name); other == others.end() || other->second != bytes)
                names.push_back(name);
        for (const auto& [name, bytes] : others)
            if (!some.contains(name)) names.push_back(name);
        return names;
    }
    /// What the report says, without clocks, costs and folders.
    nlohmann::json report(const std::string& out, const std::vector<std::string>& more = {}) {
        std::vector<std::string> arguments{"report", out, "--json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        nlohmann::json all = nlohmann::json::parse(scanmill(arguments).out)["report"];
        nlohmann::json cells = nlohmann::json::array();
        for (nlohmann::json cell : all["cells"]) {
            for (const char* member : {"seconds", "costs", "command"}) cell.erase(member);
            for (auto& reason : cell["reasons"]) reason = "";
            cells.push_back(cell);
        }
        return {{"cells", cells}, {"verdict", all["verdict"]}, {"counts", all["counts"]}, {"rules", all["rules"]}};
    }

    TemporaryFolder folder_;
    std::vector<std::string> environment_{"SCANMILL_PLUGIN_PATH=" + test_plugin_folder()};
};

}  // namespace scanmill::test
