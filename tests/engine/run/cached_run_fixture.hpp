// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Runs of test-steps with a cache that keeps everything.

#include "engine/run/run_fixture.hpp"
#include "scanmill/formats/files.hpp"

namespace scanmill::test {

class CachedRun : public Run {
protected:
    CachedRun() {
        settings_.cache = &cache_;
        keep_ = KeepRule::Policy::always;
    }
    std::vector<Origin> origins(const RunReport& report) {
        std::vector<Origin> all;
        for (const NodeReport& node : report.nodes) {
            EXPECT_EQ(node.outcome, Outcome::ok) << node.failure.whole().what();
            all.push_back(node.origin);
        }
        return all;
    }
    /// Two steps, one after the other: reading is node 0, `first` 1, `second` 2.
    RunReport run_two(const std::string& first, const std::string& second, const std::string& scan_name = "a.xyz") {
        return run("  - id: first\n    test-step: {" + first + "}\n  - id: second\n    test-step: {" + second + "}\n",
                   {scan(scan_name)}, "outputs: {'{scan}.ply': second.points}\n");
    }
    Vec3 world_of_second_point() {
        const auto written = read_points(folder_ / "out/a.ply");
        return written->frame.origin + written->positions[1];
    }
    std::vector<std::filesystem::path> values() {
        std::vector<std::filesystem::path> files;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "cache/v1/values"))
            if (entry.is_regular_file()) files.push_back(entry.path());
        return files;
    }

    std::vector<std::string> told_;
    Cache cache_{folder_ / "cache", Cache::largest_default_limit,
                 [this](std::string text) { told_.push_back(std::move(text)); }};
};

}  // namespace scanmill::test
