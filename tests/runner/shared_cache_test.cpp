// SPDX-License-Identifier: GPL-3.0-or-later
// One cache for several machines, on a slow network file system that loses answers. The file system and the names of
// the machines are simulated by a library that is preloaded (tests/modules/network_files).

#include "runner/divided_batch.hpp"

#include <fmt/format.h>

#include <fstream>
#include <memory>

namespace scanmill::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class SharedCache : public DividedBatch {
protected:
    void SetUp() override {
#ifdef __SANITIZE_ADDRESS__
        GTEST_SKIP() << "the library of AddressSanitizer must be the first to be loaded";
#endif
    }
    ProgramOptions on_host(const std::string& host) const {
        ProgramOptions own = options();
        own.environment.push_back("LD_PRELOAD=" + build_folder() +
                                  "/lib/scanmill/test-preload/scanmill-network-files.so");
        own.environment.push_back("SCANMILL_TEST_NETWORK=" + (folder_ / "shared").string());
        own.environment.push_back("SCANMILL_TEST_HOST=" + host);
        return own;
    }
    std::vector<std::string> batch(const std::string& out, const std::vector<std::string>& more = {}) const {
        std::vector<std::string> arguments{"batch",
                                           "b.yaml",
                                           "-o",
                                           out,
                                           "-j",
                                           "2",
                                           "-q",
                                           "--keep",
                                           "always",
                                           "--cache",
                                           (folder_ / "shared").string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return arguments;
    }
    /// The files of the cache without hashes of scans, which it stores for scans that are older than two seconds.
    std::vector<std::string> cache_files() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::recursive_directory_iterator(folder_ / "shared"))
            if (entry.is_regular_file() && entry.path().string().find("/files/") == std::string::npos)
                names.push_back(entry.path().filename().string());
        return names;
    }
    std::vector<std::string> leftovers() const {
        std::vector<std::string> names = cache_files();
        std::erase_if(names, [](const std::string& name) { return !name.starts_with('.'); });
        return names;
    }
    /// The first line that warns.
    static std::string warnings(const std::string& err) {
        const std::size_t begin = std::min(err.find("warning"), err.size());
        return err.substr(begin, err.find('\n', begin) - begin);
    }
};

TEST_F(SharedCache, ManyMachines_ThatWriteTheSameKeysAtOnce_AgreeAndLeaveNothing) {
    scanmill({"batch", "b.yaml", "-o", "one", "-q", "--no-cache"});
    std::size_t stored = 0;
    for (int round = 0; round < 3; ++round) {
        SCOPED_TRACE(round);
        fs::remove_all(folder_ / "shared");
        std::vector<std::unique_ptr<RunningProgram>> machines;
        for (int number = 1; number <= 4; ++number)
            machines.push_back(std::make_unique<RunningProgram>(batch(fmt::format("m{}", number)),
                                                                on_host(fmt::format("node{}", number))));
        for (int number = 1; number <= 4; ++number) {
            const ProgramResult result = machines[static_cast<std::size_t>(number - 1)]->wait();
            EXPECT_EQ(result.exit_code, 1) << result.err << "cells with two points fail, as in one run";
            EXPECT_EQ(warnings(result.err), "");
            const std::string out = fmt::format("m{}", number);
            EXPECT_THAT(differences(outputs(out), outputs("one")), IsEmpty());
            EXPECT_EQ(report(out), report("one"));
            fs::remove_all(folder_ / out);
        }
        EXPECT_THAT(leftovers(), IsEmpty());
        if (round == 0) stored = cache_files().size();
        EXPECT_EQ(cache_files().size(), stored);
    }
    const ProgramResult again = scanmill(batch("again"));
    EXPECT_EQ(warnings(again.err), "") << "all entries are whole";
    const json run = json::parse(scanmill({"runs", "again", "show", "1", "--json"}).out);
    for (const json& step : run["steps"]) EXPECT_EQ(step["origin"], "cached") << step;
}

TEST_F(SharedCache, ShardsOfManyMachines_MergeToOneRun) {
    scanmill({"batch", "b.yaml", "-o", "one", "-q", "--no-cache"});
    std::vector<std::unique_ptr<RunningProgram>> machines;
    for (int number = 1; number <= 4; ++number)
        machines.push_back(std::make_unique<RunningProgram>(
            batch(fmt::format("p{}", number), {"--shard", fmt::format("{}/4", number)}),
            on_host(fmt::format("node{}", number))));
    for (const auto& machine : machines) EXPECT_EQ(warnings(machine->wait().err), "");
    EXPECT_EQ(merge_shuffled("p", 4, 2, "whole").exit_code, 1);
    EXPECT_THAT(differences(outputs("whole"), outputs("one")), IsEmpty());
    EXPECT_EQ(report("whole"), report("one"));
    EXPECT_THAT(leftovers(), IsEmpty());
}

TEST_F(SharedCache, BeyondItsLimit_KeepsWhatOtherMachinesMayHaveMapped) {
    EXPECT_EQ(scanmill_program(batch("m1", {"--cache-limit", "1 kB"}), on_host("node1")).exit_code, 1);
    const auto in_use = cache_files();
    EXPECT_GT(in_use.size(), 20u) << "it was used within the last hour";
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / "shared"))
        if (entry.is_regular_file())
            fs::last_write_time(entry.path(), fs::file_time_type::clock::now() - std::chrono::hours(2));
    folder_.write("b2.yaml", "scanmill: 1\nbatch: b\nscans: [\"scans/s1.xyz\"]\nworkflows: [all.yaml]\n");
    scanmill_program(
        {"batch", "b2.yaml", "-o", "m2", "-q", "--cache", (folder_ / "shared").string(), "--cache-limit", "1 kB"},
        on_host("node2"));
    EXPECT_LT(cache_files().size(), in_use.size());
}

TEST_F(SharedCache, PartsOfAKilledMachine_AreRemovedWithinADay) {
    scanmill(batch("m1"));
    const std::string name = ".scanmill-node9-4711-0.part";
    const fs::path part = folder_.write("shared/v1/values/aa/" + name, "half a value");
    scanmill(batch("m1"));
    EXPECT_THAT(leftovers(), testing::ElementsAre(name)) << "its machine may be writing it";
    fs::last_write_time(part, fs::file_time_type::clock::now() - std::chrono::hours(25));
    scanmill(batch("m1"));
    EXPECT_THAT(leftovers(), IsEmpty());
}

}  // namespace
}  // namespace scanmill::test
