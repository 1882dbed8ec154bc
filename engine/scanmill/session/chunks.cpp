// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/session/chunks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/compare/comparison.hpp"
#include "scanmill/io/mapped_file.hpp"
#include "scanmill/record/json.hpp"
#include "scanmill/session/output_lock.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_runs = 20;

/// The runs of a unit and the number of its cells.
struct UnitCells {
    std::vector<std::pair<std::string, std::string>> runs;  ///< workflow and scan, relative to the batch's folder
    std::size_t cells = 0;
    u64 bytes = 0;
};

u64 size_of(const fs::path& file) {
    std::error_code missing;
    const std::uintmax_t bytes = fs::file_size(file, missing);
    return missing ? 0 : bytes;
}

u64 size_of(const BatchScan& scan) {
    u64 bytes = scan.is_object() ? 0 : size_of(scan.file);
    for (const fs::path& view : scan.views) bytes += size_of(view);
    return bytes;
}

std::vector<UnitCells> cells_of_units(const CheckedBatch& checked) {
    std::vector<UnitCells> all(units(checked));
    std::size_t next = checked.batch.scans.size();
    for (const BatchPart& part : checked.parts) {
        const std::string workflow = workflow_name(*part.plan);
        if (!checked.has_run_per_scan(part)) {
            UnitCells& unit = all[next++];
            unit.runs.emplace_back(workflow, workflow);
            unit.cells += part.plan->variants.size();
            for (const std::size_t scan : part.scans) unit.bytes += size_of(checked.batch.scans[scan]);
            continue;
        }
        for (const std::size_t scan : part.scans) {
            UnitCells& unit = all[scan];
            unit.runs.emplace_back(workflow,
                                   scan_in_batch(checked.batch.scans[scan].file.string(), checked.batch.file));
            unit.cells += part.plan->variants.size();
            unit.bytes = size_of(checked.batch.scans[scan]);
        }
    }
    return all;
}

/// The costs of runs by workflow and scan: the sum over the steps of its cells, each step once.
std::map<std::pair<std::string, std::string>, UnitCost> recorded_costs(const RunDetails& run) {
    std::map<std::size_t, const StepRecord*> steps;
    for (const StepRecord& step : run.steps) steps[step.node] = &step;
    std::map<std::pair<std::string, std::string>, std::set<std::size_t>> nodes;
    for (const CellRecord& cell : run.cells) {
        const std::string scan = cell.scan == cell.workflow ? cell.scan : scan_in_batch(cell.scan, run.start.file);
        nodes[{cell.workflow, scan}].insert(cell.nodes.begin(), cell.nodes.end());
    }
    std::map<std::pair<std::string, std::string>, UnitCost> costs;
    for (const auto& [names, all] : nodes)
        for (const std::size_t node : all)
            if (const auto found = steps.find(node); found != steps.end() && found->second->origin == Origin::ran) {
                UnitCost& cost = costs[names];
                cost.seconds += found->second->effort.seconds;
                cost.memory = std::max(cost.memory, found->second->effort.peak_memory);
                cost.is_recorded = true;
            }
    return costs;
}

}  // namespace

ChunkFile read_chunk(const fs::path& file) {
    ChunkFile chunk;
    try {
        read_json(Json::parse(MappedFile(file).bytes()), chunk);
    } catch (const Json::exception& error) {
        throw Error("'{}' is not the file of a chunk: {}", file.string(), error.what())
            .hint("an export of the batch writes such files");
    } catch (const Error& error) {
        throw Error("the chunk '{}' cannot be read: {}", file.string(), error.sentence())
            .hint("an export of the batch writes such files");
    }
    return chunk;
}

std::vector<UnitCost> unit_costs(const CheckedBatch& checked, const RunRecords* records) {
    std::map<std::pair<std::string, std::string>, UnitCost> recorded;
    if (records) {
        std::size_t seen = 0;
        const std::vector<RunSummary> runs = records->runs();
        for (auto run = runs.rbegin(); run != runs.rend() && seen < most_runs; ++run) {
            if (run->workflow != checked.batch.name || !run->outcome || run->ran == 0) continue;
            ++seen;
            for (const auto& [names, cost] : recorded_costs(records->run(run->id))) {
                UnitCost& most = recorded[names];
                most.seconds = std::max(most.seconds, cost.seconds);
                most.memory = std::max(most.memory, cost.memory);
                most.is_recorded = true;
            }
        }
    }
    std::vector<UnitCost> costs;
    for (const UnitCells& unit : cells_of_units(checked)) {
        UnitCost& cost = costs.emplace_back();
        cost.is_recorded = true;
        for (const auto& run : unit.runs) {
            const auto found = recorded.find(run);
            cost.is_recorded = cost.is_recorded && found != recorded.end();
            if (found == recorded.end()) continue;
            cost.seconds += found->second.seconds;
            cost.memory = std::max(cost.memory, found->second.memory);
        }
        if (cost.is_recorded) continue;
        const double megabytes = std::max(1.0, static_cast<double>(unit.bytes) / 1e6);
        cost.seconds = megabytes * static_cast<double>(unit.cells);
        cost.memory = 100 * unit.bytes;
    }
    return costs;
}

std::vector<Chunk> chunks_of(const CheckedBatch& checked, const std::vector<UnitCost>& costs, double seconds) {
    const std::vector<UnitCells> cells = cells_of_units(checked);
    std::vector<Chunk> chunks;
    for (std::size_t unit = 0; unit < costs.size(); ++unit) {
        if (cells[unit].runs.empty()) continue;  // a scan that no workflow takes
        if (chunks.empty() || chunks.back().seconds >= seconds) chunks.emplace_back();
        Chunk& chunk = chunks.back();
        chunk.file.units.push_back(unit);
        chunk.seconds += costs[unit].seconds;
        chunk.longest = std::max(chunk.longest, costs[unit].seconds);
        chunk.memory = std::max(chunk.memory, costs[unit].memory);
    }
    const std::string key = key_of_cells(checked);
    for (std::size_t number = 0; number < chunks.size(); ++number) {
        chunks[number].file.shard = Shard{number + 1, chunks.size()}.text();
        chunks[number].file.key_of_cells = key;
    }
    return chunks;
}

fs::path part_of_chunk(const fs::path& folder, std::size_t number) {
    return folder / fmt::format("parts/{:04}", number);
}
fs::path file_of_chunk(const fs::path& folder, std::size_t number) {
    return folder / fmt::format("chunks/{:04}.json", number);
}

static bool has_machine_failure(const RunRecords& records, const RunSummary& run) {
    return run.failed > 0 && std::ranges::any_of(records.run(run.id).cells,
                                                 [](const CellRecord& cell) { return cell.failure.is_of_machine; });
}

static ChunkStatus status_of(const fs::path& folder, std::size_t number) {
    ChunkStatus status;
    status.chunk = number;
    const fs::path part = part_of_chunk(folder, number);
    std::error_code ignored;
    if (OutputLock::is_held(part)) {
        status.state = ChunkState::running;
        return status;
    }
    if (!fs::exists(part, ignored)) return status;
    status.state = ChunkState::failed;
    if (!fs::exists(part / records_file, ignored)) return status;  // the job ended before it recorded a run
    try {
        const RunRecords records = RunRecords::read(part / records_file);
        const std::vector<RunSummary> runs = records.runs();
        if (runs.empty()) return status;
        status.cells = runs.back().cells;
        status.failed_cells = runs.back().failed;
        const bool has_ended = runs.back().outcome && *runs.back().outcome != "interrupted";
        if (has_ended && !has_machine_failure(records, runs.back())) status.state = ChunkState::done;
    } catch (const Error&) {  // the records cannot be read
    }
    return status;
}

std::vector<ChunkStatus> chunk_states(const fs::path& folder) {
    std::vector<ChunkStatus> states;
    std::error_code ignored;
    while (fs::exists(file_of_chunk(folder, states.size() + 1), ignored))
        states.push_back(status_of(folder, states.size() + 1));
    if (states.empty())
        throw Error("'{}' has no chunks", folder.string()).hint("name the folder that an export of the batch wrote");
    return states;
}

}  // namespace scanmill
