// SPDX-License-Identifier: GPL-3.0-or-later
// What the commands print with --json is what their schemas say. Every other test of this program that runs a command
// with --json checks this too (tests/support/program.hpp).

#include "support/output_schemas.hpp"
#include "support/folders.hpp"

#include <filesystem>
#include <functional>
#include <set>

#include "runner/batch_fixture.hpp"
#include "scanmill/describe/output_schemas.hpp"

namespace scanmill::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

/// Small scans, a workflow, a batch that ends in every way that it can, and what every command says of them.
class OutputSchemas : public Batch {
protected:
    OutputSchemas() {
        write_workflow("{sweep: [1, 2]}");
        write_scans("a", 1);
        write_scans("b", 1);
        write_batch("scans/a_*.xyz, {path: scans/b_01.xyz, set: {mode: doubt}}, " + more_scans(),
                    "gate: {points: exact, seconds: +20 %, outputs: exact, repeats: 2}\n");
        folder_.write("bad.yaml", "scanmill: 1\ninputs: {scan: points}\nsteps:\n  - voxel-thinn:\n");
        folder_.write("points.xyz", "0 0 0\n1 0 0\n0 1 0\n0 0 1\n");
        folder_.write("corner.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n");
        folder_.write("stray.xyz", stray_points());
        folder_.write("features.json",
                      R"({"scanmill": 1, "unit": null, "features": {"polylines": [], "corners": []}})");
    }
    std::string more_scans() {
        std::string all;
        for (const char* mode : {"fail", "throw", "crash", "exit", "warn", "write", "empty"}) {
            write_scans(mode, 1);
            all += fmt::format("{{path: scans/{}_01.xyz, set: {{mode: {}}}}}, ", mode, mode);
        }
        return all;
    }
    static std::string stray_points() {
        std::string all = "1e6 0 0\n";
        for (int i = 0; i < 1000; ++i) all += fmt::format("{} {} {}\n", i % 10, i / 10 % 10, i / 100);
        return all;
    }
    /// Every document that the commands print, by schema.
    std::map<std::string, std::vector<json>> all_documents() {
        std::map<std::string, std::vector<json>> all;
        const auto add = [&](std::vector<std::string> arguments) {
            arguments.push_back("--json");
            const ProgramResult ran = scanmill(arguments);
            for (OutputDocument& printed : output_documents(arguments, ran.out))
                all[printed.schema].push_back(std::move(printed.document));
        };
        add({"list"});
        for (const char* name : {"test-step", "measure", "crop", "voxel-thin"}) add({"show", name});
        add({"show", "measure", "--example"});
        add({"show", "nothing"});
        add({"check", "w.yaml", "b.yaml", "bad.yaml", "absent.yaml", "--plan"});
        add({"run", "w.yaml", "scans/a_01.xyz", "scans/b_01.xyz", "--dry-run"});
        add({"batch", "b.yaml", "--dry-run"});
        add({"run", "w.yaml", "scans/a_01.xyz", "absent.xyz", "-o", "out"});
        add({"run", "w.yaml", "scans/a_01.xyz", "-o", "out"});
        for (const char* mode : {"warn", "doubt", "fail", "crash", "exit", "write"})
            add({"run", "w.yaml", "scans/a_01.xyz", "-o", "out", "--set", fmt::format("mode={}", mode)});
        add({"run", "bad.yaml", "scans/a_01.xyz"});
        add({"batch", "b.yaml", "-o", "out"});
        add({"report", "out"});
        scanmill({"report", "out", "--accept", "--who", "ann", "--why", "it is good"});
        add({"batch", "b.yaml", "-o", "out", "--no-cache", "-j", "2"});
        add({"report", "out"});
        add({"runs", "out"});
        for (int run = 1; run <= 10; ++run) add({"runs", "out", "show", std::to_string(run)});
        add({"runs", "out", "--prune", "--keep", "2", "--dry-run"});
        add({"batch", "b.yaml", "--shard", "1/1", "-o", "part"});
        add({"runs", "merge", "part", "-o", "whole"});
        add({"export", "slurm", "b.yaml", "-o", "cluster"});
        add({"batch", "--status", "cluster"});
        add({"info", "points.xyz", "corner.off", "stray.xyz", "absent.ply", "features.json"});
        add({"measure", "corner.off", "points.xyz"});
        add({"measure", "corner.off", "corner.off", "--certify", "--unit", "mm"});
        add({"cache", "info"});
        add({"cache", "clear"});
        return all;
    }
};

TEST_F(OutputSchemas, EveryDocument_IsAsItsSchemaSays) {
    const auto documents = all_documents();
    std::set<std::string> seen;
    for (const auto& [name, all] : documents) {
        seen.insert(name);
        for (const json& document : all) EXPECT_THAT(schema_errors(name, document), IsEmpty()) << document.dump();
    }
    std::set<std::string> known(output_names().begin(), output_names().end());
    EXPECT_EQ(seen, known) << "every schema has a document";
    std::set<std::string> events;
    for (const json& event : documents.at("batch-event")) events.insert(event["event"]);
    EXPECT_EQ(events.size(), 10u);
}

/// Calls `changed` with every member of every object renamed in turn, to a name that no schema has.
void with_each_member_renamed(json& part, const std::function<void()>& changed) {
    if (part.is_array())
        for (json& item : part) with_each_member_renamed(item, changed);
    if (!part.is_object()) return;
    const json before = part;
    for (const auto& [key, value] : before.items()) {
        with_each_member_renamed(part[key], changed);
        part.erase(key);
        part["no-such-" + key] = value;
        changed();
        part.erase("no-such-" + key);
        part[key] = value;
    }
}

TEST_F(OutputSchemas, MissingAndUnknownMembers_AreErrors) {
    for (const auto& [name, all] : all_documents()) {
        json document = all.back();
        for (const auto& [key, value] : all.back().items()) {
            json without = document;
            without.erase(key);
            // `run` is missing if the records could not be written.
            if (key != "run" || name != "batch-event") {
                EXPECT_THAT(schema_errors(name, without), HasSubstr(key)) << name;
            }
            json changed = document;
            changed[key] = json::array({json::object()});
            EXPECT_NE(schema_errors(name, changed), "") << name << ' ' << key;
        }
        document["no-such-member"] = 1;
        EXPECT_THAT(schema_errors(name, document), HasSubstr("no-such-member")) << name;
    }
}

TEST_F(OutputSchemas, RenamedMembersBelow_AreErrors) {
    for (auto& [name, all] : all_documents()) {
        std::size_t unnoticed = 0, members = 0;
        with_each_member_renamed(all.front(), [&] {
            ++members;
            unnoticed += schema_errors(name, all.front()).empty();
        });
        EXPECT_GT(members, 0u);
        // Metrics, parameters, ports and files of outputs have names of their own.
        const bool has_maps =
            std::set<std::string>{"run", "runs-show", "check", "measure", "info", "report"}.contains(name);
        if (!has_maps) {
            EXPECT_EQ(unnoticed, 0u) << name;
        }
        EXPECT_LT(unnoticed, members) << name;
    }
}

TEST_F(OutputSchemas, Command_PrintsAndWritesThem) {
    ASSERT_EQ(scanmill({"schema", "-o", "schemas"}).exit_code, 0);
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "schemas/output"))
        names.insert(entry.path().filename().string());
    EXPECT_EQ(names.size(), output_names().size());
    for (const std::string& name : output_names()) {
        const std::string file = "output/" + name + ".schema.json";
        const std::string text = scanmill({"schema", name}).out;
        EXPECT_EQ(content_of(folder_ / "schemas" / file), text);
        EXPECT_EQ(content_of(test::source_folder() + "/schemas/" + file), text) << "run: make generate";
        EXPECT_EQ(json::parse(text)["$schema"], "http://json-schema.org/draft-07/schema#");
    }
    EXPECT_TRUE(std::filesystem::is_regular_file(folder_ / "schemas/documents/patches.schema.json"));
}

}  // namespace
}  // namespace scanmill::test
