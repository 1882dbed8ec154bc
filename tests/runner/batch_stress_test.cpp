// SPDX-License-Identifier: GPL-3.0-or-later
// Random batches: however many workers there are, whatever the cache keeps, has lost or holds damaged, the same files
// come out, with the same descriptions, and the same cells fail for the same reasons.

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <random>

#include "runner/batch_fixture.hpp"

namespace scanmill::test {
namespace {

class Stress : public Batch, public testing::WithParamInterface<unsigned> {
protected:
    struct Result {
        int exit_code;
        std::map<std::string, std::string> files;
        std::map<std::string, std::string> cells;  ///< scan and variant → outcome and cause
    };

    int number(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
    bool chance(int percent) { return number(1, 100) <= percent; }
    const char* one_of(std::initializer_list<const char*> words) {
        return words.begin()[number(0, static_cast<int>(words.size()) - 1)];
    }

    /// Up to five steps that read the scan or one another; some sweep, some expect, some misbehave, by a parameter.
    void write_random_workflow() {
        std::string steps, outputs, parameters;
        for (int i = 0; i < steps_; ++i) {
            const std::string from = i == 0 || chance(30) ? "scan" : fmt::format("t{}.points", number(0, i - 1));
            const std::string factor = chance(35) ? "{sweep: [1, 3]}" : one_of({"1", "2", "0.5"});
            steps += fmt::format("  - id: t{0}\n    test-step: {{mode: $m{0}, factor: {1}}}\n    in: {{points: {2}", i,
                                 factor, from);
            if (i > 0 && chance(30)) steps += fmt::format(", more: [t{}.points]", number(0, i - 1));
            steps += "}\n";
            if (chance(40)) steps += fmt::format("    expect: {{points: {}}}\n", one_of({"5", "5", "5", "6"}));
            parameters += fmt::format("{}m{}: pass", i > 0 ? ", " : "", i);
            if (i + 1 == steps_ || chance(50))
                outputs += fmt::format("  '{{scan}}.{{variant}}.{0}.ply': t{0}.{1}\n", i, one_of({"points", "mesh"}));
        }
        folder_.write("w.yaml", "scanmill: 1\nname: w\ninputs: {scan: points}\nparameters: {" + parameters +
                                    "}\nsteps:\n" + steps + "outputs:\n" + outputs);
    }
    void write_random_batch() {
        std::string entries;
        const int scans = number(1, 5);
        for (int i = 0; i < scans; ++i) {
            const int content = chance(25) ? 0 : i;  // some are equal
            folder_.write(fmt::format("scans/s{}.xyz", i),
                          fmt::format("{0} 0 0\n{1} 0 0\n{0} 2 0\n{1} 2 2\n{0} 1 {0}\n", content, content + 1));
            std::string set;
            for (int step = 0; step < steps_; ++step)
                if (chance(40))
                    set +=
                        fmt::format("{}m{}: {}", set.empty() ? "" : ", ", step,
                                    chance(60) ? one_of({"slow", "warn", "write", "leak", "change-folder"})
                                               : one_of({"crash", "abort", "exit", "throw-number", "fail", "throw"}));
            entries += fmt::format("{}{{path: scans/s{}.xyz, set: {{{}}}}}", i > 0 ? ", " : "", i, set);
        }
        write_batch(entries, chance(30) ? "limits: {retries: 1, time: 1 min}\n" : "");
    }

    Result run(const std::vector<std::string>& more) {
        std::filesystem::remove_all(folder_ / "out");
        std::vector<std::string> arguments{"--json", "-q"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const ProgramResult program = run_batch(arguments);
        Result result{program.exit_code, outputs("out", true), {}};
        std::istringstream stream(program.out);
        std::string last;
        for (std::string line; std::getline(stream, line);) {
            const Json event = Json::parse(line);
            last = event["event"];
            if (last != "cell-ended") continue;
            const std::string cell = event["scan"].get<std::string>() + " " + event["variant"].get<std::string>();
            EXPECT_FALSE(result.cells.contains(cell)) << "ended twice: " << cell;
            result.cells[cell] = event["outcome"].get<std::string>() + " " + event.value("cause", "");
            EXPECT_NE(event["outcome"], "skipped") << line;
        }
        EXPECT_EQ(last, "run-ended") << program.err;
        return result;
    }

    /// Removes some files of the cache and spoils others.
    void damage_cache() {
        std::vector<std::filesystem::path> files;
        if (std::filesystem::exists(folder_ / "home"))
            for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "home"))
                if (entry.is_regular_file()) files.push_back(entry.path());
        std::ranges::sort(files);
        for (const auto& file : files) {
            if (chance(20)) std::filesystem::remove(file);
            if (chance(5)) std::ofstream(file) << "spoilt";
        }
    }

    std::mt19937 random_{GetParam()};
    int steps_ = number(2, 5);
};

TEST_P(Stress, EveryWayOfRunning_GivesTheSame) {
    write_random_workflow();
    write_random_batch();
    const Result expected = run({"-j", "1", "--no-cache"});
    ASSERT_FALSE(expected.cells.empty());
    for (int round = 0; round < 4; ++round) {
        std::vector<std::string> how{"-j", one_of({"1", "2", "4"})};
        if (chance(20))
            how.emplace_back("--no-cache");
        else
            how.insert(how.end(), {"--keep", one_of({"worth", "always", "never"})});
        SCOPED_TRACE(fmt::format("round {}: {}", round, fmt::join(how, " ")));
        const Result result = run(how);
        EXPECT_EQ(result.exit_code, expected.exit_code);
        EXPECT_EQ(result.cells, expected.cells);
        ASSERT_EQ(result.files.size(), expected.files.size());
        for (const auto& [name, bytes] : expected.files) EXPECT_EQ(result.files.at(name), bytes) << name;
        if (chance(60)) damage_cache();
    }
}

INSTANTIATE_TEST_SUITE_P(Seeds, Stress, testing::Range(1u, 25u));

}  // namespace
}  // namespace scanmill::test
