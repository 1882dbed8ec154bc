// SPDX-License-Identifier: GPL-3.0-or-later
// What a bench has and gets: files read or opened, values found again.
#include <algorithm>

#include "scanmill/cache/streamed_content.hpp"
#include "scanmill/engine/streaming.hpp"
#include "scanmill/work/unchanged_file.hpp"
#include "scanmill/work/workbench.hpp"

namespace scanmill {

namespace {

/// For what is read again: what there is to be said was said when it was read first.
void said_before(std::string) {}

}  // namespace

void Workbench::read(const Job& job, const ReadWork& work, const JobListener& listener, JobReport& report) {
    const auto on_warning = [&](std::string text) {
        listener.on_warning(text);
        report.node.warnings.push_back(std::move(text));
    };
    if (work.leaf.is_streamed && read_as_stream(job, work, listener, on_warning, report)) return;
    report.was_read_whole = work.leaf.is_streamed;
    const auto start = std::chrono::steady_clock::now();
    std::optional<UnchangedWhileRead> check;
    if (uses_cache(work.memory)) check.emplace(work.leaf.file, work.leaf.content, job.threads > 1);
    Value value = read_leaf(work.leaf, on_warning);
    if (check) check->require();
    if (const auto* points = std::get_if<std::shared_ptr<const PointCloud>>(&value))
        report.node.facts.set("points", static_cast<double>((*points)->size()), Unit::count);
    else if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&value))
        report.node.facts.set("points", static_cast<double>((*mesh)->positions.size()), Unit::count);
    values_[job.node] = {{"", std::move(value)}};
    remember(job, work.memory, work.memory.plan_key, said_of(work.leaf.file), seconds_since(start), report);
}

/// The scan stays open in place of its value, and is known as the value would be. False when its file must be read as a
/// whole.
bool Workbench::read_as_stream(const Job& job, const ReadWork& work, const JobListener& listener,
                               const std::function<void(std::string)>& on_warning, JobReport& report) {
    const auto start = std::chrono::steady_clock::now();
    const JobMemory& memory = work.memory;
    std::optional<StepResult> known = uses_cache(memory) ? cache_->step(memory.plan_key) : std::nullopt;
    if (known && !known->output("")) known.reset();
    StreamedContent content;
    const bool learns = uses_cache(memory) && !known;
    const auto check_cancelled = [&] {
        if (listener.is_cancelled && listener.is_cancelled()) throw Cancelled{};
    };
    const auto look = [&](std::span<const Vec3> positions) {
        check_cancelled();
        if (learns) content.add_world(positions);
    };
    const auto scan = scans_.open(job.node, work.leaf, job.threads, uses_cache(memory), on_warning, look);
    if (!scan) return false;
    report.node.facts.set("points", static_cast<double>(scan->size()), Unit::count);
    std::vector<ResultOutput> outputs;
    if (known) {
        outputs = known->outputs;
    } else if (learns) {
        const ValueName name = content.of(*scan, job.threads, check_cancelled);
        outputs = {{"", Kind::points, name.content, name.bytes}};
    }
    scans_.require_unchanged(job.node);
    report.result.outputs = std::move(outputs);
    for (const ResultOutput& output : report.result.outputs)
        if (cache_->has_value(output.content, output.bytes)) report.kept.push_back(output.port);
    remember(job, memory, memory.plan_key, said_of(work.leaf.file), seconds_since(start), report);
    return true;
}

const Value* Workbench::find(std::size_t node, const std::string& port) const {
    const auto of_node = values_.find(node);
    if (of_node == values_.end()) return nullptr;
    const auto found = std::ranges::find(of_node->second, port, &StepInput::port);
    return found == of_node->second.end() ? nullptr : &found->value;
}

std::optional<Value> Workbench::at_hand(const JobInput& input) {
    if (const Value* value = find(input.node, input.from)) return *value;
    std::optional<Value> value = cache_ && !input.content.empty() ? cache_->value(input.content) : std::nullopt;
    if (value) values_[input.node].push_back({input.from, *value});
    return value;
}

std::shared_ptr<const PointStream> Workbench::stream_for(const StepWork& work, unsigned threads) {
    if (work.inputs.size() != 1 || !can_stream(*work.step)) return nullptr;
    const JobInput& input = work.inputs.front();
    if (!input.leaf || !input.leaf->is_streamed) return nullptr;
    if (const auto scan = scans_.find(input.node)) return scan;
    if (find(input.node, input.from)) return nullptr;  // its file had to be read as a whole
    return scans_.open(input.node, *input.leaf, threads, cache_ != nullptr, said_before);
}

std::optional<Value> Workbench::fetch(const JobInput& input, JobReport& report) {
    if (std::optional<Value> value = at_hand(input)) return value;
    std::optional<Value> value;
    if (input.leaf) {
        value = read_leaf(*input.leaf, said_before);
        if (cache_) require_unchanged(input.leaf->file, input.leaf->content);
    }
    if (value)
        values_[input.node].push_back({input.from, *value});
    else
        report.lost.push_back(input);
    return value;
}

std::string said_of(const std::filesystem::path& file) { return "'" + file.string() + "': "; }

}  // namespace scanmill
