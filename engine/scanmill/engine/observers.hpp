// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Several observers of one run.

#include <vector>

#include "scanmill/engine/run.hpp"

namespace scanmill {

/// Tells each of them everything, in the order given. They must outlive it.
class Observers : public RunObserver {
public:
    explicit Observers(std::vector<RunObserver*> all) : all_(std::move(all)) {}

    void node_started(const RunNode& node, std::size_t worker) override {
        for (RunObserver* one : all_) one->node_started(node, worker);
    }
    void node_progress(const RunNode& node, double fraction) override {
        for (RunObserver* one : all_) one->node_progress(node, fraction);
    }
    void node_warning(const RunNode& node, std::string_view text) override {
        for (RunObserver* one : all_) one->node_warning(node, text);
    }
    void node_ended(const RunNode& node, const NodeReport& report) override {
        for (RunObserver* one : all_) one->node_ended(node, report);
    }
    void output_started(const RunCell& cell, const RunOutput& output, std::size_t worker) override {
        for (RunObserver* one : all_) one->output_started(cell, output, worker);
    }
    void output_written(const RunCell& cell, const OutputReport& report) override {
        for (RunObserver* one : all_) one->output_written(cell, report);
    }
    void cell_ended(const RunCell& cell, const CellReport& report) override {
        for (RunObserver* one : all_) one->cell_ended(cell, report);
    }
    void time_passed() override {
        for (RunObserver* one : all_) one->time_passed();
    }

private:
    std::vector<RunObserver*> all_;
};

}  // namespace scanmill
