// SPDX-License-Identifier: GPL-3.0-or-later
// What a worker is given to do a task.
#include <algorithm>

#include "scanmill/engine/duration.hpp"
#include "scanmill/engine/scheduler.hpp"
#include "scanmill/work/file_description.hpp"

namespace scanmill {

namespace {

/// The smaller of those that there are; 0 stands for none.
template <class Number>
Number smaller_limit(Number a, Number b) {
    return a > 0 && b > 0 ? std::min(a, b) : std::max(a, b);
}

}  // namespace

u64 Scheduler::memory_limit() const {
    return smaller_limit(settings_.limits.cell_memory, settings_.limits.step_memory);
}

/// What is left to the cell that has the most, and at most what a step may take.
void Scheduler::limit_time(const Task& task, Job& job) const {
    const Limits& limits = settings_.limits;
    job.seconds_limit = limits.step_seconds;
    job.limit_text = fmt::format("the limit of a step is {}", duration_text(limits.step_seconds));
    if (limits.cell_seconds <= 0) return;
    double left = 0.001;
    for (const std::size_t cell : cells_of(task))
        if (!cells_[cell].is_given_up) left = std::max(left, limits.cell_seconds - report_.cells[cell].seconds);
    if (limits.step_seconds > 0 && limits.step_seconds <= left) return;
    job.seconds_limit = left;
    job.limit_text = fmt::format("the limit of a cell is {}, of which {:.3f} s were spent before",
                                 duration_text(limits.cell_seconds), limits.cell_seconds - left);
}

JobInput Scheduler::input_from(const Source& source, const std::string& port) const {
    JobInput input{port, source.node, source.port, {}, {}};
    const RunNode& node = graph_.nodes[source.node];
    if (!node.step) input.leaf = node.leaf;
    if (const std::optional<StepResult>& known = foresight_[source.node].known)
        if (const ResultOutput* output = known->output(source.port)) input.content = output->content;
    return input;
}

std::vector<JobInput> Scheduler::inputs_of(const RunNode& node) const {
    std::vector<JobInput> inputs;
    for (const NodeInput& input : node.inputs) inputs.push_back(input_from({input.node, input.from}, input.port));
    return inputs;
}

JobMemory Scheduler::memory_of(std::size_t index, std::size_t worker) const {
    const RunNode& node = graph_.nodes[index];
    const NodeState& state = nodes_[index];
    JobMemory memory;
    memory.is_used = settings_.cache && !node.is_uncacheable;
    memory.plan_key = node.key;
    memory.code = node.code;
    memory.needed.assign(foresight_[index].needed.begin(), foresight_[index].needed.end());
    const bool is_away = components_[state.component].home != worker;
    memory.keep_always = settings_.shares_values && (is_away || state.uses_left > 1);
    for (const NodeInput& input : node.inputs) memory.inputs_cost += nodes_[input.node].cost;
    return memory;
}

std::string Scheduler::frame_of(std::size_t index) const {
    const RunNode& node = graph_.nodes[index];
    const PlannedStep* step = graph_.step(node);
    return step ? fmt::format("in step '{}' ({}:{}:{})", step->label, graph_.plans[node.plan]->workflow.file,
                              step->position.line, step->position.column)
                : fmt::format("while reading '{}'", node.leaf.file.string());
}

Job Scheduler::job(const Task& task, std::size_t worker) const {
    const RunNode& node = graph_.nodes[task.node];
    const auto step = [&] {
        return std::shared_ptr<const PlannedStep>(graph_.plans[node.plan], graph_.step(node));  // lives with its plan
    };
    Job job;
    job.node = task.node;
    job.threads = settings_.threads;
    job.seed = graph_.seed;
    job.memory_limit = memory_limit();
    limit_time(task, job);
    const std::string on_scan = fmt::format("on scan '{}'", graph_.scan_names[node.scan]);
    if (task.write > 0) {
        const Write& write = writes_[task.write - 1];
        job.work = WriteWork{write.file, made_how(graph_, write.cells, write.source.node, report_.nodes),
                             input_from(write.source, "")};
        job.frames = {fmt::format("while writing '{}'", write.file.string()),
                      fmt::format("on scan '{}'", graph_.scan_names[graph_.cells[write.cells.front()].scan])};
        return job;
    }
    if (!node.step) {
        job.work = ReadWork{node.leaf, memory_of(task.node, worker)};
        if (node.leaf.file != graph_.scan_names[node.scan]) job.frames = {on_scan};
        return job;
    }
    const PlannedStep& planned = *graph_.step(node);
    job.frames = {frame_of(task.node), on_scan};
    if (!foresight_[task.node].will_run) {
        const std::string& primary = planned.spec.outputs.front().name;
        job.work = ExpectWork{step(), foresight_[task.node].known->metrics, input_from({task.node, primary}, primary)};
        return job;
    }
    job.work = StepWork{step(), library_.build_id(planned.spec.name), inputs_of(node), node.parameter_files,
                        memory_of(task.node, worker)};
    return job;
}

}  // namespace scanmill
