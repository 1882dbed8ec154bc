// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Workflows of test-steps, run over small scans in a folder of their own.

#include <gtest/gtest.h>

#include <algorithm>

#include "scanmill/run/run.hpp"
#include "scanmill/worker/workers.hpp"
#include "support/folders.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {

/// Four points whose bounding box has the diagonal 3.
inline const std::string small_scan = "0 0 0\n1 0 0\n0 2 0\n1 2 2\n";

class Run : public testing::Test {
protected:
    /// Runs the workflow over the scans; `steps` is the text below `steps:`, `tail` what follows it.
    RunReport run(const std::string& steps, const std::vector<std::string>& scans, const std::string& tail = "",
                  const std::string& inputs = "{scan: points}") {
        prepare(steps, scans, tail, inputs);
        return run_graph();
    }
    RunReport run_graph() {
        RunObserver none;
        return run_graph(none);
    }
    /// In this process.
    RunReport run_graph(RunObserver& observer) {
        InProcessWorker worker(library_, settings_.cache, keep_, settings_.is_cancelled);
        return scanmill::run(library_, graph_, worker, settings_, {&observer});
    }
    /// All of it but running.
    void prepare(const std::string& steps, const std::vector<std::string>& scans, const std::string& tail = "",
                 const std::string& inputs = "{scan: points}") {
        Diagnostics diagnostics("w.yaml");
        plan_ = make_plan(
            parse_workflow("scanmill: 1\nname: w\ninputs: " + inputs + "\nsteps:\n" + steps + tail, diagnostics),
            library_, {}, diagnostics);
        for (const Diagnostic& diagnostic : diagnostics.sorted())
            if (diagnostic.severity == Diagnostic::Severity::error) ADD_FAILURE() << text(diagnostic, "w.yaml");
        request_.scans.clear();
        for (const std::string& scan : scans) request_.scans.emplace_back(scan);
        request_.output_folder = folder_ / "out";
        graph_ = make_graph(plan_, library_, request_);
    }
    std::string scan(const std::string& name, const std::string& content = small_scan) {
        return folder_.write(name, content).string();
    }
    std::string log() const { return (folder_ / "log").string(); }
    std::size_t runs_logged() const {
        const std::string text = content_of(folder_ / "log");
        return static_cast<std::size_t>(std::ranges::count(text, '\n'));
    }

    TemporaryFolder folder_;
    FilterLibrary library_{{test::test_plugin_folder()}};
    Plan plan_;
    RunRequest request_;
    RunSettings settings_;
    KeepRule::Policy keep_ = KeepRule::Policy::worth;
    RunGraph graph_;
};

}  // namespace scanmill::test
