// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/compare/values.hpp"

#include <cmath>
#include <filesystem>

#include "scanmill/gate/gate.hpp"

namespace scanmill {

namespace {

double diagonal_of(const Metrics& metrics) {
    const Metric* found = metrics.find("diagonal");
    return found ? found->value : std::nan("");
}

void add(std::vector<CellValue>& values, CellValue::Of of, const std::string& source, const Metrics& metrics,
         const Metrics* already = nullptr) {
    for (const Metric& metric : metrics.values)
        if (!std::isnan(metric.value) && !(already && already->find(metric.name)))
            values.push_back({of, source, metric, metrics.unit, diagonal_of(metrics)});
}

}  // namespace

StepsByNode steps_by_node(const RunDetails& run) {
    StepsByNode steps;
    for (const StepRecord& step : run.steps) steps[step.node] = &step;
    return steps;
}

std::vector<CellValue> values_of(const CellRecord& cell, const StepsByNode& steps) {
    std::vector<CellValue> values;
    const auto add_steps = [&](bool measuring) {
        for (const std::size_t node : cell.nodes) {
            const auto found = steps.find(node);
            if (found == steps.end() || is_measurement(found->second->label) != measuring) continue;
            const StepRecord& step = *found->second;
            const CellValue::Of of = measuring ? CellValue::Of::measurement : CellValue::Of::step;
            add(values, of, step.label, step.metrics);
            add(values, of, step.label, step.properties, &step.metrics);
        }
    };
    add_steps(true);
    for (const OutputRecord& output : cell.outputs)
        add(values, CellValue::Of::output, std::filesystem::path(output.file).filename().string(), output.properties);
    add_steps(false);
    return values;
}

std::vector<const CellValue*> named(std::span<const CellValue> values, std::string_view name) {
    std::vector<const CellValue*> found;
    if (const std::size_t dot = name.find('.'); dot != std::string_view::npos) {
        for (const CellValue& value : values)
            if (value.of != CellValue::Of::output && value.source == name.substr(0, dot) &&
                value.metric.name == name.substr(dot + 1))
                found.push_back(&value);
        return found;
    }
    for (const auto of : {CellValue::Of::measurement, CellValue::Of::output, CellValue::Of::step}) {
        for (const CellValue& value : values)
            if (value.of == of && value.metric.name == name) found.push_back(&value);
        if (!found.empty()) break;
    }
    return found;
}

const CellValue* same_value(std::span<const CellValue> values, const CellValue& like, std::size_t hint) {
    const auto is_same = [&](const CellValue& value) {
        return value.of == like.of && value.metric.name == like.metric.name && value.source == like.source;
    };
    if (hint < values.size() && is_same(values[hint])) return &values[hint];
    for (const CellValue& value : values)
        if (is_same(value)) return &value;
    return nullptr;
}

}  // namespace scanmill
