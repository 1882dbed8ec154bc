// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/session/shard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/base/hash.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

bool read_number(std::string_view text, std::size_t& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() && end == text.data() + text.size();
}

/// Keeps the units for which `is_chosen`.
template <class IsChosen>
void keep(CheckedBatch& checked, const IsChosen& is_chosen) {
    std::vector<BatchPart> parts;
    std::size_t next = checked.batch.scans.size();
    for (BatchPart& part : checked.parts) {
        if (checked.has_run_per_scan(part)) {
            std::erase_if(part.scans, [&](std::size_t scan) { return !is_chosen(scan); });
            if (part.scans.empty()) continue;
        } else if (!is_chosen(next++)) {
            continue;
        }
        parts.push_back(std::move(part));
    }
    checked.parts = std::move(parts);
}

}  // namespace

Shard Shard::parse(std::string_view text) {
    Shard shard;
    const std::size_t slash = text.find('/');
    if (slash == std::string_view::npos || !read_number(text.substr(0, slash), shard.number) ||
        !read_number(text.substr(slash + 1), shard.count))
        throw Error("'{}' is not a shard; expected two numbers, as 3/7", text);
    if (shard.number < 1 || shard.number > shard.count)
        throw Error("there is no shard {}: shards are numbered from 1 to {}", text, shard.count)
            .hint(shard.count > 0 ? fmt::format("the last shard is {0}/{0}", shard.count) : "the first shard is 1/1");
    return shard;
}

std::string Shard::text() const { return fmt::format("{}/{}", number, count); }

std::size_t units(const CheckedBatch& checked) {
    return checked.batch.scans.size() +
           static_cast<std::size_t>(std::ranges::count_if(
               checked.parts, [&](const BatchPart& part) { return !checked.has_run_per_scan(part); }));
}

std::string key_of_cells(const CheckedBatch& checked) {
    const fs::path folder = fs::path(checked.batch.file).parent_path();
    KeyBuilder key;
    key.field("batch", checked.batch.name);
    for (const BatchScan& scan : checked.batch.scans)
        key.field("scan", scan.file.lexically_proximate(folder).generic_string());
    for (const BatchPart& part : checked.parts) {
        key.field("workflow", workflow_name(*part.plan));
        for (const PlannedVariant& variant : part.plan->variants) {
            key.field("variant", variant.name);
            for (const std::size_t step : variant.steps) key.field("step", part.plan->steps[step].structure_key);
            for (const PlannedOutput& output : variant.outputs) key.field("output", output.file);
        }
        std::string scans;
        for (const std::size_t scan : part.scans) scans += fmt::format("{} ", scan);
        key.field("scans", scans);
    }
    return key.key();
}

CellPlaces::CellPlaces(const CheckedBatch& checked) {
    std::size_t count = 0;
    for (const BatchPart& part : checked.parts) {
        const std::string workflow = workflow_name(*part.plan);
        const auto add = [&](const std::string& scan) {
            first_.try_emplace({workflow, scan}, count);
            count += part.plan->variants.size();
        };
        if (checked.has_run_per_scan(part))
            for (const std::size_t scan : part.scans) add(checked.batch.scans[scan].file.string());
        else
            add(workflow);
    }
}

void CellPlaces::set(RunGraph& graph) const {
    for (RunCell& cell : graph.cells)
        if (const auto found = first_.find({graph.workflow(cell), graph.scan_names[cell.scan]}); found != first_.end())
            cell.place = found->second + cell.variant;
}

void choose(CheckedBatch& checked, const Shard& shard) {
    const std::size_t count = units(checked);
    keep(checked, [&](std::size_t unit) { return unit % shard.count == shard.number - 1; });
    if (checked.parts.empty())
        throw Error("shard {} has no cells: the batch can be divided into at most {}", shard.text(),
                    count_text(count, "shard", "shards"))
            .hint("divide it into fewer shards");
}

void choose(CheckedBatch& checked, const std::vector<std::size_t>& chosen) {
    const std::size_t count = units(checked);
    const std::set<std::size_t> all(chosen.begin(), chosen.end());
    if (all.empty() || *all.rbegin() >= count)
        throw Error("the batch has no unit {}; it has {}", all.empty() ? 0 : *all.rbegin(),
                    count_text(count, "unit", "units"));
    keep(checked, [&](std::size_t unit) { return all.contains(unit); });
}

}  // namespace scanmill
