// SPDX-License-Identifier: GPL-3.0-or-later
// What a bench and the cache know from each other: results remembered and recalled, values kept.
#include "scanmill/engine/path_parameters.hpp"
#include "scanmill/work/workbench.hpp"

namespace scanmill {

/// What the cache knows under the run key, if all values that are needed were kept.
std::optional<Outputs> Workbench::recalled(const StepWork& work, const std::string& run_key,
                                           const JobListener& listener, JobReport& report) const {
    std::optional<StepResult> result = cache_->step(run_key);
    if (!result) return std::nullopt;
    Outputs outputs;
    for (const std::string& port : work.memory.needed) {
        const ResultOutput* output = result->output(port);
        std::optional<Value> value = output ? cache_->value(output->content) : std::nullopt;
        if (!value) return std::nullopt;
        outputs.set(port, std::move(*value));
    }
    cache_->keep_run_key(work.memory.plan_key, run_key);
    adopt(*result, work.step.get(), "", report.node);
    report.node.origin = Origin::same_inputs;
    for (const std::string& warning : report.node.warnings) listener.on_warning(warning);
    for (const ResultOutput& output : result->outputs)
        if (cache_->has_value(output.content, output.bytes)) report.kept.push_back(output.port);
    report.result = std::move(*result);
    return outputs;
}

/// Hands the result to the cache, and its values where that is worth it.
void Workbench::remember(const Job& job, const JobMemory& memory, const std::string& run_key,
                         const std::string& said_of, double seconds, JobReport& report) {
    if (!uses_cache(memory)) return;
    StepResult& result = report.result;
    const auto* work = std::get_if<StepWork>(&job.work);
    for (const auto& [name, value] : report.node.resolved.values)
        if (!std::holds_alternative<std::monostate>(value) && !names_files(work->step->spec, name))
            result.resolved.emplace_back(name, written(value));
    result.metrics = report.node.metrics;
    result.facts = report.node.facts;
    // Equal files of other names share the result: what is said of reading begins with the name.
    for (const std::string& warning : report.node.warnings)
        result.warnings.push_back(warning.starts_with(said_of) ? warning.substr(said_of.size()) : warning);
    result.seconds = seconds;
    keep_values(job.node, memory, memory.inputs_cost + seconds, report);
    if (cache_->keep_step(run_key, result)) cache_->keep_run_key(memory.plan_key, run_key);
}

void Workbench::keep_values(std::size_t node, const JobMemory& memory, double cost, JobReport& report) {
    for (const auto& [port, value] : values_[node]) {
        const EncodedValue encoded(value);
        bool kept = cache_->has_value(encoded.content(), encoded.size());
        if (!kept && (memory.keep_always || rule_.is_worth(cost, encoded.size()))) {
            const auto start = std::chrono::steady_clock::now();
            kept = cache_->keep_value(encoded);
            if (kept) rule_.wrote(encoded.size(), seconds_since(start));
        }
        if (kept) report.kept.push_back(port);
        report.result.outputs.push_back({port, kind_of(value), encoded.content(), encoded.size()});
    }
}

void adopt(const StepResult& result, const PlannedStep* step, const std::string& said_of, NodeReport& report) {
    report.metrics = result.metrics;
    report.facts = result.facts;
    report.warnings.clear();
    for (const std::string& warning : result.warnings) report.warnings.push_back(said_of + warning);
    if (!step) return;
    report.resolved = {};
    for (const auto& [name, value] : step->parameters.values)
        if (names_files(step->spec, name)) report.resolved.values.emplace_back(name, value);
    for (const auto& [name, text] : result.resolved)
        report.resolved.values.emplace_back(name, parse(*step->spec.parameter(name), text));
}

}  // namespace scanmill
