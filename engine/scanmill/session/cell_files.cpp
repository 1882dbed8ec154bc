// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/session/cell_files.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace scanmill {

namespace fs = std::filesystem;

bool is_written(const OutputRecord& output) { return output.outcome == Outcome::ok || !output.evidence.empty(); }

const std::string& path_of(const OutputRecord& output) {
    return output.evidence.empty() ? output.file : output.evidence;
}

CellRecords::CellRecords(const RunDetails& run) {
    for (const CellRecord& cell : run.cells) {
        exact_[{cell.workflow, cell.scan, cell.variant}] = &cell;
        by_name_[{cell.workflow, fs::path(cell.scan).filename().string(), cell.variant}].push_back(&cell);
    }
}

const CellRecord* CellRecords::of(const CellComparison& cell) const {
    if (const auto found = exact_.find({cell.workflow, cell.scan, cell.variant}); found != exact_.end())
        return found->second;
    // The scan may be written as a path from another folder.
    const auto found = by_name_.find({cell.workflow, fs::path(cell.scan).filename().string(), cell.variant});
    if (found == by_name_.end()) return nullptr;
    for (const CellRecord* record : found->second)
        if (fs::path(record->scan).lexically_normal().string().ends_with("/" + cell.scan)) return record;
    return nullptr;
}

double InspectionStep::number(const std::string& metric) const {
    const Metric* found = step->metrics.find(metric);
    return found ? found->value : std::nan("");
}

std::array<double, 2> InspectionStep::numbers(const std::vector<std::string>& metrics) const {
    return {number(metrics[0]), number(metrics[1])};
}

FileDeviation InspectionStep::deviation() const {
    return {inspects->column, numbers(inspects->range), numbers(inspects->tolerance)};
}

const StepRecord* CellFiles::step(std::size_t node) const {
    const auto found = steps_.find(node);
    return found == steps_.end() ? nullptr : found->second;
}

static LengthUnit declared_unit(const StepRecord& read) {
    const auto unit = std::ranges::find(read.authored, "unit", &std::pair<std::string, std::string>::first);
    return unit == read.authored.end() ? LengthUnit::unknown : length_unit(unit->second).value_or(LengthUnit::unknown);
}

CellFile CellFiles::scan() const {
    for (const std::size_t node : cell_.nodes)
        if (const StepRecord* read = step(node); read && read->filter.empty())
            return {from_base(read->file), declared_unit(*read)};
    return {};
}

std::string CellFiles::from_base(const std::string& file) const {
    return base_.empty() || fs::path(file).is_absolute() ? file : (base_ / file).lexically_normal().string();
}

CellFile CellFiles::file_of(const StepRecord& step, const std::string& port) const {
    const auto input = std::ranges::find(step.inputs, port, &InputRecord::port);
    if (input == step.inputs.end()) return {};
    if (const StepRecord* from = this->step(input->step); from && from->filter.empty())
        return {from_base(from->file), declared_unit(*from)};
    for (const OutputRecord& output : cell_.outputs)
        if (output.step == input->step && output.port == input->output && is_written(output))
            return {path_of(output), output.properties.unit};
    return {};
}

CellFile CellFiles::truth() const {
    for (const std::size_t node : cell_.nodes) {
        const StepRecord* step = this->step(node);
        const FilterSpec* filter = step ? library_.find(step->filter) : nullptr;
        if (!filter) continue;
        CellFile truth;
        if (filter->measures) truth = file_of(*step, filter->measures->truth);
        if (filter->inspects) truth = file_of(*step, filter->inspects->nominal);
        if (!truth.path.empty()) return truth;
    }
    return {};
}

const OutputRecord* CellFiles::mesh() const {
    for (const OutputRecord& output : cell_.outputs)
        if (output.kind == name_of(kind_of<TriangleMesh>()) && is_written(output)) return &output;
    return nullptr;
}

InspectionStep CellFiles::inspection() const {
    InspectionStep best;
    const auto rank = [](const StepRecord& step) {
        return step.outcome == Outcome::failed ? 2 : step.expected.empty() ? 0 : 1;
    };
    for (const std::size_t node : cell_.nodes) {
        const StepRecord* step = this->step(node);
        const FilterSpec* filter = step ? library_.find(step->filter) : nullptr;
        if (filter && filter->inspects && (!best || rank(*step) > rank(*best.step)))
            best = {step, &*filter->inspects, filter};
    }
    return best;
}

const OutputRecord* CellFiles::deviation_map(const InspectionStep& inspection) const {
    for (const std::string& port : inspection.inspects->outputs)
        for (const OutputRecord& output : cell_.outputs)
            if (output.step == inspection.step->node && output.port == port && is_written(output)) return &output;
    return nullptr;
}

std::vector<const OutputRecord*> CellFiles::pictures_of(const StepRecord& step) const {
    std::vector<const OutputRecord*> pictures;
    for (const OutputRecord& output : cell_.outputs) {
        const StepRecord* drawing = this->step(output.step);
        if (output.kind == name_of(kind_of<Picture>()) && is_written(output) && drawing &&
            std::ranges::find(drawing->inputs, step.node, &InputRecord::step) != drawing->inputs.end())
            pictures.push_back(&output);
    }
    return pictures;
}

}  // namespace scanmill
