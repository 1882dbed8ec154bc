// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/compare/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/compare/costs.hpp"

namespace scanmill {

namespace fs = std::filesystem;

std::string scan_in_batch(const std::string& scan, const std::string& file) {
    const fs::path folder = fs::path(file).lexically_normal().parent_path(), path = fs::path(scan).lexically_normal();
    if (scan.empty() || folder.empty() || folder == ".") return scan;
    if (path.is_absolute() != folder.is_absolute()) return scan;
    const fs::path inside = path.lexically_relative(folder);
    const bool leaves = inside.empty() || *inside.begin() == "..";
    return path.is_absolute() && leaves ? scan : inside.empty() ? scan : inside.string();
}

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

RunFacts facts_of(const RunDetails& run) {
    return {run.summary.id,    run.summary.started, run.summary.outcome.value_or("unfinished"),
            run.start.version, run.start.machine,   run.start.threads,
            run.start.jobs,    run.summary.seconds};
}

/// Identifies a cell in all runs of its batch by workflow, scan and variant. The number distinguishes cells with the
/// same names.
using CellKey = std::tuple<std::string, std::string, std::string, std::size_t>;

/// The cells of a run by their key.
class CellTable {
public:
    explicit CellTable(const RunDetails& run) {
        for (const CellRecord& cell : run.cells) {
            // If the workflow takes a list of scans, or no scan, the cell's scan is the name of the workflow.
            const std::string scan = cell.scan == cell.workflow ? cell.scan : scan_in_batch(cell.scan, run.start.file);
            const std::size_t again = repeats_[{cell.workflow, scan, cell.variant}]++;
            keys_.emplace_back(cell.workflow, scan, cell.variant, again);
            by_key_.emplace(keys_.back(), &cell);
        }
    }
    /// The key of the cell with this index in the run.
    const CellKey& key(std::size_t cell) const { return keys_[cell]; }
    const CellRecord* find(const CellKey& key) const {
        const auto found = by_key_.find(key);
        return found == by_key_.end() ? nullptr : found->second;
    }

private:
    std::vector<CellKey> keys_;
    std::map<CellKey, const CellRecord*> by_key_;
    std::map<std::tuple<std::string, std::string, std::string>, std::size_t> repeats_;
};

/// Indices of the cells in the order of the plan: scan by scan, and variant by variant within a scan. Cells are
/// recorded in the order in which they end, but their nodes are numbered in the order of the plan.
std::vector<std::size_t> in_plan_order(const std::vector<CellRecord>& cells) {
    const auto place_of = [&](std::size_t cell) {
        const std::vector<std::size_t>& nodes = cells[cell].nodes;
        return std::pair(nodes.empty() ? std::numeric_limits<std::size_t>::max() : std::ranges::max(nodes),
                         std::string_view(cells[cell].scan));
    };
    std::vector<std::size_t> order(cells.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::stable_sort(order, {}, place_of);
    return order;
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

std::string shown(double value, Unit unit, LengthUnit lengths) { return display(Metric{"", value, unit}, lengths); }

/// The effect of a change under the tolerance of its rule. Pre: the values differ.
Effect effect_of(const Tolerance& tolerance, double accepted, double found) {
    const double rise = found - accepted;
    double limit = tolerance.is_relative ? tolerance.amount * std::abs(accepted) : tolerance.amount;
    if (!std::isfinite(limit)) limit = 0;
    // A value exactly on the limit is allowed, so rounding errors are added to the limit. `exact` has no rounding
    // errors.
    if (limit > 0 && std::isfinite(rise)) limit += 1e-12 * std::max(std::abs(accepted), std::abs(found));
    if (std::abs(rise) <= limit) return Effect::listed;
    return (rise > 0 ? tolerance.may_rise : tolerance.may_fall) ? Effect::improvement : Effect::regression;
}

double cost_of(const CostRecord& pass, std::string_view cost) {
    return cost == "seconds"       ? pass.seconds
           : cost == "cpu-seconds" ? pass.cpu_seconds
                                   : static_cast<double>(pass.peak_memory);
}
constexpr std::array<std::string_view, 3> all_costs{"seconds", "cpu-seconds", "memory"};

/// The last known costs, one per pass, at most most_ranked.
std::vector<double> costs_of(const std::vector<CostRecord>& passes, std::string_view cost) {
    std::vector<double> costs;
    for (const CostRecord& pass : passes)
        if (const double one = cost_of(pass, cost); one > 0) costs.push_back(one);
    if (costs.size() > most_ranked) costs.erase(costs.begin(), costs.end() - most_ranked);
    return costs;
}

/// Possible causes of differences between two runs of a cell: changed files, filters and parameters.
std::vector<std::string> causes_of(const CellRecord& cell, const StepsByNode& steps, const CellRecord& before,
                                   const StepsByNode& steps_before) {
    using Occurrence = std::pair<std::string, std::size_t>;  // label and its number in the cell
    const auto by_label = [](const CellRecord& record, const StepsByNode& all) {
        std::vector<std::pair<Occurrence, const StepRecord*>> found;
        std::map<std::string, std::size_t> seen;
        for (const std::size_t node : record.nodes)
            if (const auto step = all.find(node); step != all.end())
                found.emplace_back(Occurrence{step->second->label, seen[step->second->label]++}, step->second);
        return found;
    };
    const auto now = by_label(cell, steps), then = by_label(before, steps_before);
    const std::map<Occurrence, const StepRecord*> old(then.begin(), then.end()), current(now.begin(), now.end());
    std::vector<std::string> causes;
    for (const auto& [label, step] : now) {
        const auto found = old.find(label);
        if (found == old.end()) {
            causes.push_back(fmt::format("the step {} is new", step->label));
            continue;
        }
        const StepRecord& was = *found->second;
        if (step->filter != was.filter)
            causes.push_back(fmt::format("{} is {}; it was {}", step->label, step->filter, was.filter));
        else if (step->filter_version != was.filter_version)
            causes.push_back(fmt::format("{} {} → {}", step->filter, was.filter_version, step->filter_version));
        std::map<std::string, std::string> values(was.authored.begin(), was.authored.end());
        for (const auto& [name, value] : step->authored) {
            const std::string old_value = std::exchange(values[name], value);
            if (old_value != value)
                causes.push_back(
                    fmt::format("{}: {} {} → {}", step->label, name, old_value.empty() ? "auto" : old_value, value));
        }
        if (step->filter.empty() && step->plan_key != was.plan_key && step->authored == was.authored)
            causes.push_back(fmt::format("{}: the file changed", step->label));
    }
    for (const auto& [label, step] : then)
        if (!current.contains(label)) causes.push_back(fmt::format("the step {} is gone", step->label));
    return causes;
}

/// "decimate 2 → 3" for a filter whose version differs; "decimate 2: another build" if only its build differs.
std::vector<std::string> changed_filters(const RunDetails& run, const RunDetails& before) {
    const auto versions = [](const RunDetails& details) {
        std::map<std::string, std::pair<int, std::string>> found;
        for (const StepRecord& step : details.steps)
            if (!step.filter.empty()) found[step.filter] = {step.filter_version, step.build};
        return found;
    };
    const auto then = versions(before);
    std::vector<std::string> changed;
    for (const auto& [filter, version] : versions(run)) {
        const auto was = then.find(filter);
        if (was == then.end() || was->second == version) continue;
        changed.push_back(was->second.first != version.first
                              ? fmt::format("{} {} → {}", filter, was->second.first, version.first)
                              : fmt::format("{} {}: another build", filter, version.first));
    }
    return changed;
}

/// Judges one cell.
class CellJudge {
public:
    CellJudge(const Gate& gate, const CellRecord& cell, const StepsByNode& steps) : gate_(gate), cell_(cell) {
        result_.workflow = cell.workflow;
        result_.variant = cell.variant;
        result_.outcome = name_of(cell.outcome);
        result_.seconds = cell.seconds;
        result_.passes = cell.costs;
        result_.doubts = cell.doubts;
        result_.values = values_of(cell, steps);
        for (const OutputRecord& output : cell.outputs)
            if (!output.moved_to.empty()) result_.moved.push_back(fs::path(output.moved_to).filename().string());
    }

    /// The verdict. `accepted` is null if the accepted run does not have the cell. `past` are costs of earlier passes.
    /// `known`: acknowledgements of the cell.
    CellComparison judged(const CellRecord* accepted, const StepsByNode& accepted_steps,
                          const std::vector<CostRecord>& past, const std::vector<const Acknowledgement*>& known) {
        find_known(known);
        if (cell_.outcome == Outcome::failed) {
            result_.reasons.push_back(failure_text(cell_.failure));
            if (accepted && accepted->outcome == Outcome::failed)
                result_.reasons.emplace_back("the cell failed in the accepted run, too");
            result_.verdict = Verdict::failed;
            return std::move(result_);
        }
        if (cell_.outcome == Outcome::skipped) {
            result_.reasons.emplace_back("the cell did not run");
            result_.verdict = Verdict::missing;
            return std::move(result_);
        }
        const bool is_comparable =
            accepted && (accepted->outcome == Outcome::ok || accepted->outcome == Outcome::doubtful);
        const std::vector<CellValue> before =
            is_comparable ? values_of(*accepted, accepted_steps) : std::vector<CellValue>();
        for (const GateRule& rule : gate_.rules)
            if (!is_cost(rule.metric) && rule.metric != "outputs") apply(rule, is_comparable, before);
        if (is_comparable) {
            list_ungated(before);
            compare_outputs(*accepted);
        }
        compare_costs(past);
        std::ranges::stable_sort(result_.metrics, [](const MetricChange& a, const MetricChange& b) {
            if (a.effect != b.effect) return a.effect < b.effect;
            if (a.rule.empty() != b.rule.empty()) return b.rule.empty();
            return std::abs(a.share) > std::abs(b.share);
        });
        decide(accepted, is_comparable);
        return std::move(result_);
    }

private:
    /// Sets `known` if the acknowledgements have all doubts of the cell.
    void find_known(const std::vector<const Acknowledgement*>& all) {
        if (result_.doubts.empty() || cell_.outcome != Outcome::doubtful) return;
        const Acknowledgement* last = nullptr;  // that has one of the doubts
        for (const Acknowledgement* each : all)
            if (std::ranges::find_first_of(each->doubts, result_.doubts) != each->doubts.end()) last = each;
        const auto is_known = [&](const std::string& doubt) {
            return std::ranges::any_of(all, [&](const Acknowledgement* each) {
                return std::ranges::find(each->doubts, doubt) != each->doubts.end();
            });
        };
        if (std::ranges::all_of(result_.doubts, is_known)) result_.known = KnownDoubts{last->who, last->why, last->at};
    }

    static std::string failure_text(const FailureRecord& failure) {
        std::string text = first_line(failure.error);
        if (text.empty()) text = "the cell failed";
        return text;
    }

    /// The tolerance of a rule in the unit of this value. If the rule cannot be applied, adds a reason to inapplicable_
    /// and returns nothing.
    std::optional<Tolerance> tolerance_for(const GateRule& rule, const CellValue& value) {
        try {
            return parse_tolerance(rule.text, value.metric.unit, value.lengths, value.diagonal);
        } catch (const Error& error) {
            inapplicable_.push_back(
                fmt::format("the rule {}: {} cannot be applied: {}", rule.metric, rule.text, error.sentence()));
            return std::nullopt;
        }
    }

    /// The value of the cell's truth for this value, in the same unit. A metric of the same source comes first.
    std::optional<double> truth_of(const CellValue& value) const {
        const std::string name = std::string(truth_prefix) + value.metric.name;
        const CellValue* found = nullptr;
        for (const CellValue& other : result_.values)
            if (other.metric.name == name &&
                (!found || (found->source != value.source && other.source == value.source)))
                found = &other;
        if (!found || !are_comparable(*found, value)) return std::nullopt;
        return *change_of(found, &value).accepted;
    }

    static bool is_nearer(const MetricChange& change, double truth) {
        return change.accepted && change.found && std::abs(*change.found - truth) < std::abs(*change.accepted - truth);
    }

    /// Judges the rule `= truth`. A value that differs from the truth is a regression, unless it has moved towards it.
    void apply_truth(const GateRule& rule, const std::vector<CellValue>& before) {
        const std::vector<const CellValue*> values = named(result_.values, rule.metric);
        const std::vector<const CellValue*> earlier = named(before, rule.metric);
        if (values.empty() && earlier.empty())
            inapplicable_.push_back(
                fmt::format("the rule {}: {} cannot be applied: the cell has no such value", rule.metric, rule.text));
        for (const CellValue* is : values) {
            judged_.insert(is->full_name());
            const std::optional<double> truth = truth_of(*is);
            if (!truth) {
                inapplicable_.push_back(fmt::format("the rule {}: {} cannot be applied: the cell has no metric {}{}",
                                                    rule.metric, rule.text, truth_prefix, is->metric.name));
                continue;
            }
            const CellValue* was = same_value(before, *is);
            MetricChange change = change_of(was && are_comparable(*was, *is) ? was : nullptr, is);
            change.rule = fmt::format("{} ({})", rule.text, shown(*truth, change.unit, change.lengths));
            if (*change.found != *truth)
                change.effect = is_nearer(change, *truth) ? Effect::improvement : Effect::regression;
            else if (change.accepted && *change.accepted != *change.found)
                change.effect = Effect::improvement;
            else
                continue;
            result_.metrics.push_back(std::move(change));
        }
        for (const CellValue* was : earlier) {
            if (same_value(result_.values, *was)) continue;
            judged_.insert(was->full_name());
            MetricChange change = change_of(was, nullptr);
            change.rule = rule.text;
            change.effect = Effect::regression;
            result_.metrics.push_back(std::move(change));
        }
    }

    void apply(const GateRule& rule, bool is_comparable, const std::vector<CellValue>& before) {
        if (requires_truth(rule.text)) return apply_truth(rule, before);
        std::vector<const CellValue*> now = named(result_.values, rule.metric);
        for (const CellValue* was : named(before, rule.metric)) {
            const CellValue* is = same_value(result_.values, *was);
            std::erase(now, is);
            judged_.insert(was->full_name());
            const std::optional<Tolerance> tolerance = tolerance_for(rule, is ? *is : *was);
            if (!tolerance) continue;
            MetricChange change = change_of(was, is);
            change.rule = rule.text;
            if (!is)
                change.effect = Effect::regression;
            else if (!are_comparable(*was, *is)) {
                inapplicable_.push_back(
                    fmt::format("the rule {}: {} cannot be applied: the unit of lengths is {}, and "
                                "was {}",
                                rule.metric, rule.text, symbol(is->lengths), symbol(was->lengths)));
                continue;
            } else if (*change.accepted == *change.found)
                continue;
            else {
                change.effect = effect_of(*tolerance, *change.accepted, *change.found);
                const std::optional<double> truth = truth_of(*is);
                if (change.effect == Effect::regression && truth && is_nearer(change, *truth))
                    change.effect = Effect::improvement;
            }
            result_.metrics.push_back(std::move(change));
        }
        for (const CellValue* is : now) {
            judged_.insert(is->full_name());
            tolerance_for(rule, *is);
            if (!is_comparable) continue;
            MetricChange change = change_of(nullptr, is);
            change.rule = rule.text;
            result_.metrics.push_back(std::move(change));
        }
    }

    static bool are_comparable(const CellValue& a, const CellValue& b) {
        const bool has_lengths =
            a.metric.unit == Unit::length || a.metric.unit == Unit::area || a.metric.unit == Unit::volume;
        return !has_lengths || a.lengths == b.lengths ||
               (a.lengths != LengthUnit::unknown && b.lengths != LengthUnit::unknown);
    }

    static double power_of(Unit unit) {
        return unit == Unit::length ? 1 : unit == Unit::area ? 2 : unit == Unit::volume ? 3 : 0;
    }

    static double share_of(const std::optional<double>& accepted, const std::optional<double>& found) {
        if (!accepted || !found) return infinite;
        if (*accepted == *found) return 0;
        const double share = (*found - *accepted) / std::abs(*accepted);
        return std::isnan(share) ? infinite : share;
    }

    /// The change from `was` to `is`, in the unit of `is`. One of the two may be null.
    static MetricChange change_of(const CellValue* was, const CellValue* is) {
        const CellValue& either = is ? *is : *was;
        MetricChange change;
        change.source = either.source;
        change.metric = either.metric.name;
        change.unit = either.metric.unit;
        change.lengths = either.lengths;
        if (is) change.found = is->metric.value;
        if (was) change.accepted = was->metric.value;
        if (is && was && is->lengths != was->lengths && are_comparable(*was, *is))
            for (int power = 0; power < power_of(either.metric.unit); ++power)
                change.accepted = in_unit(*change.accepted, was->lengths, is->lengths);
        change.share = share_of(change.accepted, change.found);
        return change;
    }

    /// Lists differences to which no rule applies. Several sources may repeat a value, for example a step and its
    /// output; it is listed once.
    void list_ungated(const std::vector<CellValue>& before) {
        const auto list = [&](const CellValue* was, const CellValue* is) {
            if (judged_.contains((is ? is : was)->full_name())) return;
            MetricChange change = change_of(was, is);
            if (change.accepted == change.found) return;
            const bool is_repeated = std::ranges::any_of(result_.metrics, [&](const MetricChange& other) {
                return other.metric == change.metric && other.accepted == change.accepted &&
                       other.found == change.found;
            });
            if (!is_repeated) result_.metrics.push_back(std::move(change));
        };
        for (std::size_t i = 0; i < result_.values.size(); ++i)
            list(same_value(before, result_.values[i], i), &result_.values[i]);
        for (std::size_t i = 0; i < before.size(); ++i)
            if (!same_value(result_.values, before[i], i)) list(&before[i], nullptr);
    }

    void compare_outputs(const CellRecord& accepted) {
        const auto rule = std::ranges::find(gate_.rules, "outputs", &GateRule::metric);
        const bool is_gated = rule != gate_.rules.end();
        const auto name = [](const OutputRecord& output) { return fs::path(output.file).filename().string(); };
        const auto find = [&](const CellRecord& cell, const std::string& file) {
            const auto found = std::ranges::find_if(cell.outputs, [&](const auto& each) { return name(each) == file; });
            return found == cell.outputs.end() ? nullptr : &*found;
        };
        const auto is_written = [](const OutputRecord& output) { return output.outcome == Outcome::ok; };
        bool lacks_hash = false;
        for (const OutputRecord& is : cell_.outputs) {
            const OutputRecord* was = find(accepted, name(is));
            const bool was_written = was && is_written(*was);
            lacks_hash = lacks_hash || (is_written(is) && is.sha256.empty()) || (was_written && was->sha256.empty());
            const std::string before = was_written ? was->sha256 : "", now = is_written(is) ? is.sha256 : "";
            if (was_written == is_written(is) && (before == now || before.empty() || now.empty())) continue;
            // A file that only this run has is not a regression.
            const Effect effect = is_gated && was_written ? Effect::regression : Effect::listed;
            result_.outputs.push_back({name(is), before, now, effect});
        }
        for (const OutputRecord& was : accepted.outputs)
            if (is_written(was) && !find(cell_, name(was)))
                result_.outputs.push_back({name(was), was.sha256, "", is_gated ? Effect::regression : Effect::listed});
        if (is_gated && lacks_hash)
            inapplicable_.emplace_back(
                "the rule outputs: exact cannot be applied: one of the runs recorded no hashes of its files");
    }

    void compare_costs(const std::vector<CostRecord>& past) {
        for (const std::string_view cost : all_costs) {
            const std::vector<double> before = costs_of(past, cost), now = costs_of(cell_.costs, cost);
            if (before.empty() || now.empty()) continue;
            const auto rule = std::ranges::find(gate_.rules, cost, &GateRule::metric);
            CostChange change;
            change.cost = cost;
            change.passes_before = before.size();
            change.passes = now.size();
            const bool is_gated = rule != gate_.rules.end();
            const double tolerance = is_gated ? parse_cost_tolerance(rule->text).amount : infinite;
            const bool is_confirmed = cost != "seconds" || used_more_processor(past, tolerance);
            const CostKind kind = cost == "memory" ? CostKind::other
                                  : is_confirmed   ? CostKind::time
                                                   : CostKind::unconfirmed_time;
            const CostJudgement judgement = judge_costs(before, now, tolerance, kind);
            change.before = judgement.before;
            change.now = judgement.now;
            change.share = judgement.now / judgement.before - 1;
            change.probability = judgement.probability;
            if (is_gated) change.rule = rule->text;
            if (judgement.is_worse) change.effect = Effect::regression;
            if (judgement.is_better) change.effect = Effect::improvement;
            result_.costs.push_back(std::move(change));
        }
    }

    /// Whether the processor time rose by more than the tolerance. Also true if the processor time is unknown.
    bool used_more_processor(const std::vector<CostRecord>& past, double tolerance) const {
        const std::vector<double> before = costs_of(past, "cpu-seconds"), now = costs_of(cell_.costs, "cpu-seconds");
        return before.empty() || now.empty() || all_rise(before, now, tolerance);
    }

    void decide(const CellRecord* accepted, bool is_comparable) {
        for (const MetricChange& change : result_.metrics)
            if (change.effect != Effect::listed) add_reason(change.effect, reason(change));
        for (const OutputChange& change : result_.outputs)
            if (change.effect != Effect::listed)
                add_reason(change.effect,
                           fmt::format("the output {} {}", change.file, change.found.empty() ? "is gone" : "changed"));
        for (const CostChange& change : result_.costs)
            if (change.effect != Effect::listed) add_reason(change.effect, reason(change));
        if (!regressions_.empty()) {
            result_.verdict = Verdict::regressed;
            result_.reasons = std::move(regressions_);
            std::ranges::move(inapplicable_, std::back_inserter(result_.reasons));
        } else if (!inapplicable_.empty()) {
            result_.verdict = Verdict::failed;
            result_.reasons = std::move(inapplicable_);
        } else if (cell_.outcome == Outcome::doubtful && !result_.known) {
            result_.verdict = Verdict::doubtful;
            result_.reasons = cell_.doubts;
        } else if (!improvements_.empty()) {
            result_.verdict = Verdict::improved;
            result_.reasons = std::move(improvements_);
        } else if (accepted && !is_comparable) {
            result_.verdict = Verdict::improved;
            result_.reasons.push_back(fmt::format("the cell {} in the accepted run",
                                                  accepted->outcome == Outcome::failed ? "failed" : "did not run"));
        } else {
            result_.verdict = accepted ? Verdict::passed : Verdict::is_new;
        }
    }

    void add_reason(Effect effect, std::string text) {
        (effect == Effect::regression ? regressions_ : improvements_).push_back(std::move(text));
    }

    static std::string reason(const MetricChange& change) {
        if (!change.found)
            return fmt::format("{} is gone; it was {}", change.metric,
                               shown(*change.accepted, change.unit, change.lengths));
        if (!change.accepted)
            return fmt::format("{} is {} ({})", change.metric, shown(*change.found, change.unit, change.lengths),
                               change.rule);
        return fmt::format("{} {} → {} ({})", change.metric, shown(*change.accepted, change.unit, change.lengths),
                           shown(*change.found, change.unit, change.lengths), change.rule);
    }

    static std::string reason(const CostChange& change) {
        const std::string chance = change.probability ? fmt::format(", p = {:.2g}", *change.probability) : "";
        return fmt::format("{} is {:.2f} times the median of {} earlier passes ({}{})", change.cost,
                           change.now / change.before, change.passes_before, change.rule, chance);
    }

    const Gate& gate_;
    const CellRecord& cell_;
    CellComparison result_;
    std::set<std::string> judged_;  // full names of the values to which a rule applies
    std::vector<std::string> inapplicable_, regressions_, improvements_;
};

Verdict verdict_of(const Comparison& comparison) {
    for (const Verdict verdict : {Verdict::regressed, Verdict::missing, Verdict::failed, Verdict::doubtful})
        if (comparison.count(verdict) > 0) return verdict;
    if (!comparison.accepted) return Verdict::is_new;
    return comparison.count(Verdict::improved) > 0 ? Verdict::improved : Verdict::passed;
}

/// The costs of earlier passes by cell. Scans are named by their paths relative to the batch's folder.
class Pools {
public:
    Pools(const std::vector<PastCosts>& all, const std::string& file) {
        for (const PastCosts& past : all) {
            const std::string scan = past.scan == past.workflow ? past.scan : scan_in_batch(past.scan, file);
            auto& pool = pools_[{past.workflow, scan, past.variant}];
            pool.insert(pool.end(), past.costs.begin(), past.costs.end());
        }
    }
    const std::vector<CostRecord>& of(const CellKey& key) const {
        static const std::vector<CostRecord> none;
        const auto found = pools_.find({std::get<0>(key), std::get<1>(key), std::get<2>(key)});
        return found == pools_.end() ? none : found->second;
    }

private:
    std::map<std::tuple<std::string, std::string, std::string>, std::vector<CostRecord>> pools_;
};

void add_notes(Comparison& comparison, const RunDetails& run, const Baseline* baseline) {
    const bool gates_costs = std::ranges::any_of(comparison.gate.rules, is_cost, &GateRule::metric);
    if (run.summary.outcome == "interrupted") comparison.notes.emplace_back("the run was interrupted");
    const bool has_costs = std::ranges::any_of(run.cells, [](const CellRecord& cell) { return !cell.costs.empty(); });
    if (gates_costs && !has_costs)
        comparison.notes.emplace_back(
            "costs were not compared, because no cell ran all of its steps; run without the cache to compare them");
    if (!baseline) return;
    const RunStart &now = run.start, &then = baseline->run.start;
    if (now.machine != then.machine)
        comparison.notes.push_back(
            fmt::format("the machine changed, so costs have a new baseline; the machine was {}", then.machine));
    else if (now.threads != then.threads || now.jobs != then.jobs)
        comparison.notes.push_back(fmt::format("costs have a new baseline: threads {} → {}, jobs {} → {}", then.threads,
                                               now.threads, then.jobs, now.jobs));
    if (now.version != then.version)
        comparison.notes.push_back(fmt::format("Scanmill {} → {}", then.version, now.version));
    if (now.seed != then.seed) comparison.notes.push_back(fmt::format("the seed changed {} → {}", then.seed, now.seed));
    if (then.gate != now.gate || then.repeats != now.repeats)
        comparison.notes.emplace_back("the gate differs from the gate of the accepted run");
}

}  // namespace

Comparison compare(const RunDetails& run, const Baseline* baseline, const CommandFor& command,
                   const std::vector<Acknowledgement>& acknowledged) {
    Comparison comparison;
    comparison.batch = run.start.workflow;
    comparison.file = run.start.file;
    comparison.run = facts_of(run);
    for (const auto& [metric, text] : run.start.gate) comparison.gate.rules.push_back({metric, text, {}});
    comparison.gate.repeats = run.start.repeats;
    if (baseline) {
        comparison.accepted = facts_of(baseline->run);
        comparison.acceptance = baseline->acceptance;
        comparison.accepted_folder = baseline->folder;
        comparison.filters = changed_filters(run, baseline->run);
    }
    add_notes(comparison, run, baseline);
    const RunDetails none;
    const RunDetails& accepted_run = baseline ? baseline->run : none;
    const StepsByNode steps = steps_by_node(run), accepted_steps = steps_by_node(accepted_run);
    const CellTable cells(run), accepted_cells(accepted_run);
    const Pools pools(baseline ? baseline->costs : std::vector<PastCosts>(), run.start.file);
    std::map<std::tuple<std::string, std::string, std::string>, std::vector<const Acknowledgement*>> known;  // by cell
    for (const Acknowledgement& each : acknowledged) known[{each.workflow, each.scan, each.variant}].push_back(&each);
    for (const std::size_t i : in_plan_order(run.cells)) {
        const CellRecord& cell = run.cells[i];
        const CellRecord* accepted = accepted_cells.find(cells.key(i));
        CellComparison& judged =
            comparison.cells.emplace_back(CellJudge(comparison.gate, cell, steps)
                                              .judged(accepted, accepted_steps, pools.of(cells.key(i)),
                                                      known[{cell.workflow, std::get<1>(cells.key(i)), cell.variant}]));
        judged.scan = std::get<1>(cells.key(i));
        const bool is_fine = judged.verdict == Verdict::passed || judged.verdict == Verdict::is_new;
        if (accepted && !is_fine) judged.causes = causes_of(cell, steps, *accepted, accepted_steps);
        if (!is_fine && command) judged.command = command(run, cell, judged.scan);
    }
    for (const std::size_t i : in_plan_order(accepted_run.cells)) {
        if (cells.find(accepted_cells.key(i))) continue;
        CellComparison& missing = comparison.cells.emplace_back();
        missing.workflow = accepted_run.cells[i].workflow;
        missing.variant = accepted_run.cells[i].variant;
        missing.scan = std::get<1>(accepted_cells.key(i));
        missing.verdict = Verdict::missing;
        missing.reasons.emplace_back("the cell is absent; the accepted run has it");
    }
    for (const CellComparison& cell : comparison.cells) ++comparison.counts[static_cast<std::size_t>(cell.verdict)];
    comparison.verdict = verdict_of(comparison);
    return comparison;
}

Effect RankedChange::effect() const { return metric ? metric->effect : output ? output->effect : cost->effect; }

double RankedChange::share() const { return metric ? metric->share : output ? infinite : cost->share; }

double RankedChange::confidence() const { return cost ? 1 - cost->probability.value_or(0.5) : 1; }

std::vector<RankedChange> what_changed(const Comparison& comparison) {
    std::vector<RankedChange> changes;
    for (const CellComparison& cell : comparison.cells) {
        for (const MetricChange& change : cell.metrics) changes.push_back({&cell, &change, nullptr, nullptr});
        for (const OutputChange& change : cell.outputs) changes.push_back({&cell, nullptr, &change, nullptr});
        for (const CostChange& change : cell.costs)
            if (change.effect != Effect::listed) changes.push_back({&cell, nullptr, nullptr, &change});
    }
    std::ranges::stable_sort(changes, [](const RankedChange& a, const RankedChange& b) {
        if (a.effect() != b.effect()) return a.effect() < b.effect();
        if (const double size = std::abs(a.share()), other = std::abs(b.share()); size != other) return size > other;
        return a.confidence() > b.confidence();
    });
    return changes;
}

std::vector<std::string> metric_names(const Comparison& comparison) {
    std::vector<std::string> names(all_costs.begin(), all_costs.end());
    std::set<std::string> seen(names.begin(), names.end());
    for (const CellComparison& cell : comparison.cells)
        for (const CellValue& value : cell.values) {
            if (seen.insert(value.metric.name).second) names.push_back(value.metric.name);
            if (value.of != CellValue::Of::output && seen.insert(value.full_name()).second)
                names.push_back(value.full_name());
        }
    return names;
}

std::string default_metric(const Comparison& comparison) {
    for (const GateRule& rule : comparison.gate.rules)
        if (!is_cost(rule.metric) && rule.metric != "outputs") return rule.metric;
    for (const CellComparison& cell : comparison.cells)
        if (!cell.values.empty() && cell.values.front().of == CellValue::Of::measurement)
            return cell.values.front().metric.name;
    return "seconds";
}

std::optional<CellValue> number_of(const CellComparison& cell, std::string_view metric) {
    if (is_cost(metric)) {
        const std::vector<double> costs = costs_of(cell.passes, metric);
        CellValue value{CellValue::Of::step, "", {std::string(metric), cell.seconds, Unit::seconds}, {}, 0};
        if (!costs.empty()) value.metric.value = median(costs);
        if (costs.empty() && (metric != "seconds" || cell.seconds == 0)) return std::nullopt;
        if (metric == "memory") value.metric.unit = Unit::count;
        return value;
    }
    const std::vector<const CellValue*> found = named(cell.values, metric);
    if (found.empty()) return std::nullopt;
    return *found.front();
}

}  // namespace scanmill
