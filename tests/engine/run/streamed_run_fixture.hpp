// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Runs over scans that are streamed, and the same runs over scans that are read whole.

#include <set>

#include "engine/run/run_fixture.hpp"
#include "support/folders.hpp"
#include "support/point_files.hpp"

namespace scanmill::test {

class StreamedRun : public Run {
protected:
    StreamedRun() {
        library_ = FilterLibrary({test::test_plugin_folder(), test::plugin_folder()});
        use_cache("cache");
        keep_ = KeepRule::Policy::always;
    }
    void use_cache(const std::string& name) {
        cache_ = std::make_unique<Cache>(folder_ / name);
        settings_.cache = cache_.get();
    }
    /// Runs the prepared graph; `whole`: as if nothing could be streamed.
    RunReport run_prepared(bool whole) {
        for (RunNode& node : graph_.nodes) {
            EXPECT_EQ(node.leaf.is_streamed, node.is_scan);
            if (whole) node.leaf.is_streamed = false;
        }
        return run_graph();
    }
    RunReport run_thin(const std::string& parameters, const std::string& file, bool whole = false,
                       const std::string& inputs = "{scan: points}") {
        prepare("  - voxel-thin: {" + parameters + "}\n    expect: {points: '> 0'}\n", {file},
                "outputs: {'{scan}.ply': voxel-thin}\n", inputs);
        return run_prepared(whole);
    }
    RunReport run_logging(const std::string& file, const std::string& parameters = "length: 1 %diag") {
        prepare("  - test-stream: {" + parameters + ", log: " + log() + "}\n", {file},
                "outputs: {'{scan}.ply': test-stream}\n");
        return run_graph();
    }
    std::string logged() const { return content_of(folder_ / "log"); }

    /// Everything that was remembered: names of all files, and what plans lead to.
    std::set<std::string> remembered(const std::string& cache) const {
        std::set<std::string> all;
        std::error_code absent;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / cache, absent)) {
            const std::string name = std::filesystem::relative(entry.path(), folder_ / cache).string();
            const bool is_leafs = name.find("/files/") != std::string::npos;
            if (!entry.is_regular_file() || is_leafs) continue;
            all.insert(name + (name.find("/plans/") != std::string::npos ? content_of(entry.path()) : ""));
        }
        return all;
    }
    static std::vector<Origin> origins(const RunReport& report) {
        std::vector<Origin> all;
        for (const NodeReport& node : report.nodes) {
            EXPECT_EQ(node.outcome, Outcome::ok) << node.failure.whole().what();
            all.push_back(node.origin);
        }
        return all;
    }
    static void expect_equal(const RunReport& streamed, const RunReport& whole) {
        ASSERT_EQ(streamed.nodes.size(), whole.nodes.size());
        for (std::size_t i = 0; i < whole.nodes.size(); ++i) {
            const NodeReport &a = streamed.nodes[i], &b = whole.nodes[i];
            EXPECT_EQ(a.outcome, b.outcome);
            EXPECT_STREQ(a.failure.whole().what(), b.failure.whole().what());
            EXPECT_EQ(a.metrics.values, b.metrics.values);
            EXPECT_EQ(a.properties.values, b.properties.values);
            EXPECT_EQ(a.warnings, b.warnings);
            ASSERT_EQ(a.resolved.values.size(), b.resolved.values.size());
            for (std::size_t p = 0; p < a.resolved.values.size(); ++p)
                EXPECT_EQ(text(a.resolved.values[p].second), text(b.resolved.values[p].second));
        }
        EXPECT_STREQ(streamed.cells[0].failure.whole().what(), whole.cells[0].failure.whole().what());
    }
    /// Thins the file both ways, each with a cache of its own.
    void expect_the_same(const std::string& file, const std::string& parameters,
                         const std::string& inputs = "{scan: points}") {
        keep_ = KeepRule::Policy::never;  // a scan's value is kept only by who has it
        std::vector<std::string> outputs, descriptions;
        std::vector<RunReport> reports;
        for (const bool whole : {false, true}) {
            std::filesystem::remove_all(folder_ / (whole ? "whole" : "streamed"));
            use_cache(whole ? "whole" : "streamed");
            reports.push_back(run_thin(parameters, file, whole, inputs));
            const std::string stem = std::filesystem::path(file).stem().string();
            outputs.push_back(content_of(folder_ / ("out/" + stem + ".ply")));
            descriptions.push_back(content_of(folder_ / ("out/" + stem + ".ply.json")));
            std::filesystem::remove_all(folder_ / "out");
        }
        expect_equal(reports[0], reports[1]);
        EXPECT_TRUE(outputs[0] == outputs[1]) << "the bytes differ";
        EXPECT_EQ(descriptions[0], descriptions[1]);
        EXPECT_EQ(remembered("streamed"), remembered("whole"));
        EXPECT_EQ(outputs[0].empty(), reports[1].outcome() == Outcome::failed);
    }

    std::unique_ptr<Cache> cache_;
};

}  // namespace scanmill::test
