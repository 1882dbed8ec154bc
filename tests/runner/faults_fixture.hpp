// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Batches of three scans, the second of which misbehaves.

#include <chrono>
#include <initializer_list>
#include <thread>

#include "runner/batch_fixture.hpp"

namespace scanmill::test {

class FaultyBatch : public Batch {
protected:
    /// Runs a batch of three scans, of which the second would never end, and sends the signals while it runs.
    ProgramResult interrupted_batch(std::initializer_list<int> signals) {
        write_workflow("1");
        write_scans("scan", 3);
        write_batch("scans/scan_01.xyz, {path: scans/scan_02.xyz, set: {mode: loop}}, scans/scan_03.xyz");
        RunningProgram batch({"batch", "b.yaml", "-o", "out", "-j", "1"}, options());
        while (!batch.has_ended() && batch.err().find("scan_02.xyz: shared") == std::string::npos)
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        for (const int signal : signals) {
            batch.signal(signal);
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
        }
        return batch.wait();
    }

    /// Runs such a batch; returns the record of its step.
    Json poisoned(const std::string& mode, const std::string& limits = "", std::vector<std::string> more = {}) {
        write_workflow("{sweep: [1, 2]}");
        write_scans("a", 1);
        write_scans("b", 1);
        write_scans("c", 1);
        write_batch("scans/a_*.xyz, {path: scans/b_01.xyz, set: {mode: " + mode + "}}, scans/c_*.xyz", limits);
        more.insert(more.end(), {"-j", "1"});
        result_ = run_batch(more);
        run_ = recorded(1);
        EXPECT_EQ(run_["cells"].size(), 6u) << result_.err;
        for (const Json& cell : run_["cells"])
            if (cell["scan"] != "scans/b_01.xyz") {
                EXPECT_EQ(cell["outcome"], "ok") << cell;
            }
        for (const Json& step : run_["steps"])
            if (step["scan"] == "scans/b_01.xyz" && step["step"] == "last") return step;
        return {};
    }
    void expect_failure() const {
        EXPECT_EQ(result_.exit_code, 1);
        EXPECT_EQ(count(run_["cells"], "outcome", "failed"), 2u);
        EXPECT_THAT(result_.err, testing::AllOf(testing::HasSubstr("in step 'last' ("),
                                                testing::HasSubstr("on scan 'scans/b_01.xyz'")));
    }

    ProgramResult result_;
    Json run_;
};

}  // namespace scanmill::test
