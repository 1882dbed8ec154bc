// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/session/merge_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <map>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/session/output_lock.hpp"
#include "scanmill/session/shard.hpp"
#include "scanmill/worker/file_description.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

/// The last run in the folder of a shard.
struct ShardRun {
    fs::path folder;
    Shard shard;
    RunDetails run;
};

std::string name_of_shard(const ShardRun& run) {
    return fmt::format("shard {} in '{}'", run.shard.text(), run.folder.string());
}

/// Throws Error if the last run in the folder is not one of a shard, or has not ended.
ShardRun shard_in(const fs::path& folder) {
    const RunRecords records = RunRecords::read(folder / records_file);
    const std::vector<RunSummary> runs = records.runs();
    if (runs.empty())
        throw Error("'{}' has no runs", folder.string()).hint("name the folders into which shards were run");
    RunDetails run = records.run(runs.back().id);
    if (run.start.shard.empty())
        throw Error("the last run in '{}' is no shard: it has all cells of {}", folder.string(), run.start.workflow)
            .hint("only the folders of shards can be merged");
    if (const std::string outcome = run.summary.outcome.value_or("interrupted"); outcome == "interrupted") {
        const bool is_running = OutputLock::is_held(folder);
        throw Error("shard {} in '{}' is unfinished: its last run {}", run.start.shard, folder.string(),
                    is_running ? "has not ended yet" : "was interrupted or killed")
            .hint(is_running ? "wait until it has ended"
                             : "run the shard again; its cells that had finished are in the cache");
    }
    const Shard shard = Shard::parse(run.start.shard);
    return {folder, shard, std::move(run)};
}

/// Throws Error unless both shards are of one batch, as one program ran it.
void require_equal(const ShardRun& first, const ShardRun& other) {
    const RunStart &a = first.run.start, &b = other.run.start;
    const auto differ = [&](const std::string& what, const std::string& ours, const std::string& theirs) {
        if (ours != theirs)
            throw Error("{} and {} cannot be merged: the {} differs, '{}' and '{}'", name_of_shard(first),
                        name_of_shard(other), what, ours, theirs)
                .hint("run all shards of one batch with one program");
    };
    differ("batch", a.workflow, b.workflow);
    differ("number of shards", std::to_string(first.shard.count), std::to_string(other.shard.count));
    differ("version of Scanmill", a.version, b.version);
    differ("seed", std::to_string(a.seed), std::to_string(b.seed));
    const auto text_of_gate = [](const RunStart& start) {
        std::string text;
        for (const auto& [metric, rule] : start.gate) text += (text.empty() ? "" : ", ") + metric + " " + rule;
        return text;
    };
    differ("gate", text_of_gate(a), text_of_gate(b));
    if (a.key_of_cells != b.key_of_cells)
        throw Error("{} and {} cannot be merged: the batch's scans, workflows or values were changed between them",
                    name_of_shard(first), name_of_shard(other))
            .hint("run the shards anew");
}

/// Sorted by number. Throws Error if one is missing or given twice.
std::vector<ShardRun> shards_in(const std::vector<fs::path>& folders) {
    std::vector<ShardRun> shards;
    for (const fs::path& folder : folders) shards.push_back(shard_in(folder));
    for (const ShardRun& shard : shards) require_equal(shards.front(), shard);
    std::ranges::stable_sort(shards, {}, [](const ShardRun& run) { return run.shard.number; });
    for (std::size_t i = 1; i < shards.size(); ++i)
        if (shards[i].shard == shards[i - 1].shard)
            throw Error("shard {} is given twice: in '{}' and in '{}'", shards[i].shard.text(),
                        shards[i - 1].folder.string(), shards[i].folder.string())
                .hint("name one of the two folders");
    std::vector<std::string> missing;
    for (std::size_t number = 1, at = 0; number <= shards.front().shard.count; ++number)
        if (at < shards.size() && shards[at].shard.number == number)
            ++at;
        else
            missing.push_back(Shard{number, shards.front().shard.count}.text());
    if (!missing.empty())
        throw Error("{} missing: {}", count_text(missing.size(), "shard is", "shards are"), enumerated(missing))
            .hint("name the folders of all shards; run those that have none");
    return shards;
}

/// A file that goes from the folder of a shard to the target.
struct Move {
    fs::path from, to;
    bool is_done = false;
};

class Merge {
public:
    Merge(std::vector<ShardRun> shards, const fs::path& target) : shards_(std::move(shards)) {
        std::error_code ignored;
        target_ = fs::weakly_canonical(fs::absolute(target), ignored);
        for (ShardRun& shard : shards_) plan_moves(shard);
    }

    /// Moves the outputs and returns how many were moved and copied.
    void move_files(MergedRuns& merged) const {
        for (const Move& move : moves_) {
            if (move.is_done) continue;
            std::error_code trouble;
            fs::create_directories(move.to.parent_path(), trouble);
            if (!trouble) fs::rename(move.from, move.to, trouble);
            if (!trouble) {
                ++merged.moved;
                continue;
            }
            copy(move);
            ++merged.copied;
        }
    }

    std::int64_t record(RunRecords& records) {
        RunStart start = shards_.front().run.start;
        start.shard.clear();
        start.folder = target_.string();
        std::set<std::string> machines;
        std::string started = shards_.front().run.summary.started, outcome;
        double seconds = 0;
        Outcome worst = Outcome::ok;
        for (const ShardRun& shard : shards_) {
            machines.insert(shard.run.start.machine);
            started = std::min(started, shard.run.summary.started);
            seconds = std::max(seconds, shard.run.summary.seconds);
            if (const auto found = value_named<Outcome>(shard.run.summary.outcome.value_or("")))
                worst = std::max(worst, *found);
        }
        start.machine.clear();
        for (const std::string& machine : machines) start.machine += (start.machine.empty() ? "" : "; ") + machine;
        std::vector<StepRecord> steps;
        std::vector<CellRecord> cells;
        number_anew(steps, cells, machines.size() > 1);
        const std::int64_t run = records.begin(start, started);
        records.end(run, steps, cells, std::string(name_of(worst)), seconds);
        return run;
    }

    std::size_t cells() const {
        std::size_t count = 0;
        for (const ShardRun& shard : shards_) count += shard.run.cells.size();
        return count;
    }

private:
    /// The file in the target for a file that the shard wrote.
    fs::path place_of(const ShardRun& shard, const std::string& file) const {
        return target_ / fs::path(file).lexically_relative(shard.run.start.folder);
    }

    /// Plans the move of every written file, checks its bytes, and sets its path in the record.
    void plan_moves(ShardRun& shard) {
        const auto add = [&](std::string& file, const std::string& sha256) {
            const fs::path relative = fs::path(file).lexically_relative(shard.run.start.folder);
            if (relative.empty() || *relative.begin() == "..")
                throw Error("{} wrote '{}', which is outside its folder", name_of_shard(shard), file)
                    .hint("give the batch outputs inside its output folder");
            const Move move{shard.folder / relative, target_ / relative};
            file = move.to.string();
            if (sha256.empty()) return;
            // A file is shared by the cells that name it.
            if (!planned_.insert(move.to.string()).second) return;
            if (sha256_of(move.from) == sha256)
                moves_.push_back(move);
            else if (sha256_of(move.to) != sha256)
                throw Error("the output '{}' of {} is missing or has changed", move.from.string(), name_of_shard(shard))
                    .hint("run the shard again");
            std::error_code ignored;
            const fs::path description = description_of(move.from);
            if (fs::is_regular_file(description, ignored) && planned_.insert(description_of(move.to)).second)
                moves_.push_back({description, description_of(move.to)});
        };
        for (CellRecord& cell : shard.run.cells)
            for (OutputRecord& output : cell.outputs) {
                const bool is_evidence = !output.evidence.empty();
                if (is_evidence) add(output.evidence, output.sha256);
                add(output.file, is_evidence ? "" : output.sha256);
            }
    }

    static void copy(const Move& move) {
        const fs::path part = fs::path(move.to).concat(".merging");
        try {
            fs::copy_file(move.from, part, fs::copy_options::overwrite_existing);
            fs::rename(part, move.to);
        } catch (const fs::filesystem_error& error) {
            std::error_code ignored;
            fs::remove(part, ignored);
            throw Error("'{}' cannot be written: {}", move.to.string(), error.code().message())
                .hint("nothing is lost: repeat the command when there is room");
        }
        std::error_code ignored;
        fs::remove(move.from, ignored);
    }

    /// Numbers the nodes of all shards so that the cells are in the order of the batch.
    void number_anew(std::vector<StepRecord>& steps, std::vector<CellRecord>& cells, bool several_machines) {
        std::vector<std::pair<const ShardRun*, const CellRecord*>> order;
        for (const ShardRun& shard : shards_)
            for (const CellRecord& cell : shard.run.cells) order.emplace_back(&shard, &cell);
        std::ranges::stable_sort(order, {}, [](const auto& pair) { return pair.second->place; });
        std::map<std::pair<const ShardRun*, std::size_t>, std::size_t> numbers;
        const auto number = [&](const ShardRun* shard, std::size_t node) {
            return numbers.try_emplace({shard, node}, numbers.size()).first->second;
        };
        for (const auto& [shard, record] : order) {
            CellRecord& cell = cells.emplace_back(*record);
            for (std::size_t& node : cell.nodes) node = number(shard, node);
            for (OutputRecord& output : cell.outputs) output.step = number(shard, output.step);
            cell.place = 0;
            if (several_machines) cell.machine = shard->run.start.machine;
        }
        for (const ShardRun& shard : shards_)
            for (const StepRecord& record : shard.run.steps) {
                StepRecord& step = steps.emplace_back(record);
                step.node = number(&shard, step.node);
                for (InputRecord& input : step.inputs) input.step = number(&shard, input.step);
            }
        std::ranges::stable_sort(steps, {}, &StepRecord::node);
    }

    std::vector<ShardRun> shards_;
    fs::path target_;
    std::vector<Move> moves_;
    std::set<std::string> planned_;  // targets
};

}  // namespace

MergedRuns merge_runs(const std::vector<fs::path>& folders, const fs::path& target,
                      const std::vector<std::string>& command_line, const std::function<void(std::string)>& warn) {
    Merge merge(shards_in(folders), target);
    std::error_code trouble;
    fs::create_directories(target, trouble);
    if (trouble) throw Error("'{}' cannot be created: {}", target.string(), trouble.message());
    std::deque<OutputLock> locks;
    for (const fs::path& folder : folders) {
        std::error_code ignored;
        if (!fs::equivalent(folder, target, ignored)) locks.emplace_back(folder, command_line, warn);
    }
    locks.emplace_back(target, command_line, warn);
    MergedRuns merged;
    merged.shards = folders.size();
    merged.cells = merge.cells();
    merge.move_files(merged);
    RunRecords records = RunRecords::append_to(target / records_file);
    merged.run = merge.record(records);
    return merged;
}

}  // namespace scanmill
