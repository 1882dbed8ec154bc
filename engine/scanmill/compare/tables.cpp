// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/compare/tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "scanmill/base/text.hpp"

namespace scanmill {

namespace {

bool has_several_workflows(const Comparison& comparison) {
    return std::ranges::any_of(comparison.cells, [&](const CellComparison& cell) {
        return cell.workflow != comparison.cells.front().workflow;
    });
}

/// The variant's name, with the workflow's name before it if `with_workflow`.
std::string variant_text(const CellComparison& cell, bool with_workflow) {
    return with_workflow ? cell.workflow + ": " + cell.variant : cell.variant;
}

std::string cost_text(const std::string& cost, double amount) {
    return cost == "memory" ? byte_size_text(static_cast<std::uint64_t>(amount)) : fmt::format("{:.3g} s", amount);
}

std::string share_text(double share) { return fmt::format("{:+.3g} %", 100 * share); }

std::vector<std::string> row_of(const MetricChange& change) {
    const auto shown = [&](const std::optional<double>& value) {
        return value ? display(Metric{"", *value, change.unit}, change.lengths) : "-";
    };
    std::string difference;
    if (!change.accepted)
        difference = "new";
    else if (!change.found)
        difference = "gone";
    else if (std::isfinite(change.share) && change.unit != Unit::boolean)
        difference = share_text(change.share);
    else
        difference = "changed";
    return {change.metric, shown(change.accepted), shown(change.found), difference, change.rule};
}

std::vector<std::string> row_of(const OutputChange& change) {
    const auto shown = [](const std::string& hash) { return hash.empty() ? "-" : hash.substr(0, 8); };
    return {change.file, shown(change.accepted), shown(change.found),
            change.accepted.empty() ? "new"
            : change.found.empty()  ? "gone"
                                    : "changed",
            change.effect == Effect::listed ? "" : "exact"};
}

std::vector<std::string> row_of(const CostChange& change) {
    const std::string chance = change.probability ? fmt::format(", p {:.2g}", *change.probability) : "";
    return {change.cost, cost_text(change.cost, change.before), cost_text(change.cost, change.now),
            share_text(change.share) + chance, change.rule};
}

std::string effect_text(Effect effect) {
    return effect == Effect::regression ? "regressed" : effect == Effect::improvement ? "improved" : "";
}

bool has_regressed(const CellComparison& cell, const CellValue& value) {
    return std::ranges::any_of(cell.metrics,
                               [&](const MetricChange& change) {
                                   return change.effect == Effect::regression && change.metric == value.metric.name &&
                                          change.source == value.source;
                               }) ||
           std::ranges::any_of(cell.costs, [&](const CostChange& change) {
               return change.effect == Effect::regression && change.cost == value.metric.name && value.source.empty();
           });
}

bool is_trouble(Verdict verdict) {
    return verdict == Verdict::failed || verdict == Verdict::missing || verdict == Verdict::regressed ||
           verdict == Verdict::doubtful;
}

/// The values that one rule judges in the cells of one variant.
struct RuleRow {
    std::string metric, rule, variant;
    std::vector<double> values, shares;
    std::vector<CellValue> shown;  ///< the values with their units
    std::size_t regressed = 0;
};

/// The change of the cell's value against the accepted run, as a share; empty if there is nothing to compare with.
std::optional<double> share_of_change(const Comparison& comparison, const CellComparison& cell, const CellValue& value,
                                      const std::string& metric) {
    if (is_cost(metric)) {
        const auto cost = std::ranges::find(cell.costs, metric, &CostChange::cost);
        return cost == cell.costs.end() ? std::nullopt : std::optional(cost->share);
    }
    if (!comparison.accepted || cell.verdict == Verdict::is_new || cell.verdict == Verdict::failed) return std::nullopt;
    for (const MetricChange& change : cell.metrics)
        if (change.metric == value.metric.name && change.source == value.source)
            return change.accepted ? std::optional(change.share) : std::nullopt;
    return 0;
}

/// NaN does not count; of an even number of values, the mean of the two in the middle. Infinite if there are none.
double median_of(std::vector<double> values) {
    std::erase_if(values, [](double value) { return std::isnan(value); });
    if (values.empty()) return std::numeric_limits<double>::infinity();
    std::ranges::sort(values);
    const std::size_t middle = values.size() / 2;
    if (values.size() % 2 == 1 || values[middle - 1] == values[middle]) return values[middle];
    return (values[middle - 1] + values[middle]) / 2;
}

/// The names of the variants that share a row: three at most, and the number of the others.
class SharedNames {
public:
    void add(std::size_t row, const std::string& name) {
        if (names_.size() <= row) names_.resize(row + 1);
        names_[row].push_back(name);
    }
    std::string text(std::size_t row) const {
        constexpr std::size_t most = 3;
        const std::vector<std::string>& all = names_[row];
        const std::vector<std::string> shown(all.begin(),
                                             all.begin() + static_cast<std::ptrdiff_t>(std::min(all.size(), most)));
        return fmt::format("{}{}", fmt::join(shown, ", "),
                           all.size() > most ? fmt::format(" and {} more", all.size() - most) : "");
    }

private:
    std::vector<std::vector<std::string>> names_;
};

double median_share(const RuleRow& row) { return row.shares.empty() ? 0 : median_of(row.shares); }

/// The median value, with the unit if all cells share it.
std::string median_text(const RuleRow& row) {
    if (row.values.empty()) return "-";
    const double median = median_of(row.values);
    if (is_cost(row.metric)) return cost_text(row.metric, median);
    const CellValue& first = row.shown.front();
    const Metric metric{"", median, first.metric.unit};
    const bool has_one_unit =
        std::ranges::all_of(row.shown, [&](const CellValue& value) { return value.lengths == first.lengths; });
    return has_one_unit ? display(metric, first.lengths) : display(metric);
}

/// The rows of rule_table(), in the order of the rules and of the variants. Without `by_variant`, one row per rule.
std::vector<RuleRow> rule_rows(const Comparison& comparison, bool by_variant) {
    const bool with_workflow = has_several_workflows(comparison);
    std::vector<GateRule> rules;
    for (const GateRule& rule : comparison.gate.rules)
        if (rule.metric != "outputs") rules.push_back(rule);
    if (rules.empty()) rules.push_back({default_metric(comparison), "", {}});
    std::vector<RuleRow> rows;
    for (const GateRule& rule : rules) {
        std::map<std::string, std::size_t> row_of;  // by variant
        for (const CellComparison& cell : comparison.cells) {
            const std::string variant = by_variant ? variant_text(cell, with_workflow) : "all";
            const auto [found, is_new] = row_of.emplace(variant, rows.size());
            if (is_new) rows.push_back({rule.metric, rule.text, variant, {}, {}, {}, 0});
            RuleRow& row = rows[found->second];
            for (const MetricChange& change : cell.metrics)
                row.regressed += change.effect == Effect::regression && change.rule.starts_with(rule.text) &&
                                 (change.metric == rule.metric || change.source + "." + change.metric == rule.metric);
            for (const CostChange& change : cell.costs)
                row.regressed += change.effect == Effect::regression && change.cost == rule.metric;
            const auto value = number_of(cell, rule.metric);
            if (!value) continue;
            row.values.push_back(value->metric.value);
            row.shown.push_back(*value);
            if (const auto share = share_of_change(comparison, cell, *value, rule.metric)) row.shares.push_back(*share);
        }
    }
    return rows;
}

/// The scans or the variants of a matrix, in the order of the cells.
struct MatrixAxis {
    std::vector<std::string> names;
    std::vector<bool> has_trouble;  ///< whether one of its cells did not pass
    std::map<std::string, std::size_t> index;  ///< by name

    void add(const std::string& name, bool trouble) {
        const auto [found, is_new] = index.emplace(name, names.size());
        if (is_new) {
            names.push_back(name);
            has_trouble.push_back(false);
        }
        if (trouble) has_trouble[found->second] = true;
    }
};

}  // namespace

std::string length_unit_text(const Metric& metric, LengthUnit lengths) {
    const std::string with_unit = display(metric, lengths), bare = display(metric);
    return with_unit.size() > bare.size() ? with_unit.substr(bare.size() + 1) : "";
}

std::string counts_text(const Comparison& comparison) {
    std::vector<std::string> counts;
    for (const Verdict verdict : all_verdicts)
        if (comparison.count(verdict) > 0)
            counts.push_back(fmt::format("{} {}", comparison.count(verdict), name_of(verdict)));
    const std::size_t known = comparison.known();
    return fmt::format("{}: {}{}", count_text(comparison.cells.size(), "cell", "cells"), fmt::join(counts, ", "),
                       known > 0 ? fmt::format("; the doubts of {} are known", known) : "");
}

std::string runs_text(const Comparison& comparison) {
    std::string text = fmt::format("run {} of {}", comparison.run.id, comparison.run.started);
    if (!comparison.accepted) return text + "; no run was accepted yet";
    const RunFacts& accepted = *comparison.accepted;
    if (accepted.id == comparison.run.id && comparison.accepted_folder.empty())
        text += ", which is the accepted run";
    else
        text += fmt::format(" against run {} of {}", accepted.id, accepted.started);
    if (!comparison.accepted_folder.empty()) text += fmt::format(" in {}", comparison.accepted_folder);
    if (comparison.acceptance)
        text += fmt::format(", accepted by {}: {}", comparison.acceptance->who, comparison.acceptance->why);
    return text;
}

std::vector<std::pair<std::string, std::string>> facts_of(const Comparison& comparison) {
    std::vector<std::pair<std::string, std::string>> facts;
    facts.emplace_back("version", "Scanmill " + comparison.run.version);
    facts.emplace_back("machine", comparison.run.machine);
    std::vector<std::string> rules;
    for (const GateRule& rule : comparison.gate.rules) rules.push_back(rule.metric + " " + rule.text);
    if (!rules.empty()) facts.emplace_back("gate", fmt::format("{}", fmt::join(rules, ", ")));
    if (!comparison.filters.empty())
        facts.emplace_back("filters", fmt::format("{}", fmt::join(comparison.filters, ", ")));
    for (const std::string& note : comparison.notes) facts.emplace_back("note", note);
    return facts;
}

ReportTable rule_table(const Comparison& comparison, std::size_t most) {
    std::vector<RuleRow> rows = rule_rows(comparison, true);
    if (rows.size() > most) rows = rule_rows(comparison, false);
    const std::size_t left_out = rows.size() - std::min(rows.size(), most);
    rows.resize(rows.size() - left_out);
    ReportTable table{{"metric", "rule", "variant", "cells", "median", "median change", "regressed"}, {}, {}};
    for (const RuleRow& row : rows) {
        const double share = median_share(row);
        table.rows.push_back({row.metric, row.rule.empty() ? "-" : row.rule, row.variant,
                              std::to_string(row.values.size()), median_text(row),
                              row.shares.empty()     ? "-"
                              : std::isfinite(share) ? share_text(share)
                                                     : "changed",
                              std::to_string(row.regressed)});
    }
    if (left_out > 0) table.rest = fmt::format("and {}", count_text(left_out, "more rule", "more rules"));
    return table;
}

ReportTable change_table(const Comparison& comparison, std::size_t most) {
    ReportTable table{{"scan", "variant", "what", "accepted", "now", "change", "rule", ""}, {}, {}};
    const bool with_workflow = has_several_workflows(comparison);
    std::map<std::vector<std::string>, std::size_t> row_of_change;  // by the cells of the row except the variant
    SharedNames names;
    std::size_t left_out = 0;
    for (const RankedChange& change : what_changed(comparison)) {
        std::vector<std::string> row{change.cell->scan, ""};
        const std::vector<std::string> what = change.metric   ? row_of(*change.metric)
                                              : change.output ? row_of(*change.output)
                                                              : row_of(*change.cost);
        row.insert(row.end(), what.begin(), what.end());
        row.push_back(effect_text(change.effect()));
        const std::string variant = variant_text(*change.cell, with_workflow);
        if (const auto known = row_of_change.find(row); known != row_of_change.end()) {
            names.add(known->second, variant);
        } else if (table.rows.size() == most) {
            ++left_out;
        } else {
            row_of_change.emplace(row, table.rows.size());
            names.add(table.rows.size(), variant);
            table.rows.push_back(std::move(row));
        }
    }
    for (std::size_t row = 0; row < table.rows.size(); ++row) table.rows[row][1] = names.text(row);
    if (left_out > 0) table.rest = fmt::format("and {} more", left_out);
    return table;
}

ReportTable reason_table(const Comparison& comparison, std::size_t most) {
    ReportTable table{{"verdict", "scan", "variant", "why"}, {}, {}};
    const bool with_workflow = has_several_workflows(comparison);
    std::map<std::tuple<std::string, std::string, std::string>, std::size_t> row_of_reason;
    SharedNames names;
    std::size_t left_out = 0;
    for (const Verdict verdict : all_verdicts) {
        if (!is_trouble(verdict)) continue;
        for (const CellComparison& cell : comparison.cells) {
            if (cell.verdict != verdict) continue;
            // The reasons of a regressed cell are changes, which are in the table of changes.
            std::vector<std::string> why = cell.causes;
            if (verdict != Verdict::regressed || why.empty())
                why.insert(why.begin(), cell.reasons.begin(), cell.reasons.end());
            if (!cell.moved.empty()) why.emplace_back("the earlier outputs were renamed to *.previous");
            const std::string text = fmt::format("{}", fmt::join(why, "; "));
            const std::string variant = variant_text(cell, with_workflow);
            const auto known = row_of_reason.find({std::string(name_of(verdict)), cell.scan, text});
            if (known != row_of_reason.end()) {
                names.add(known->second, variant);
            } else if (table.rows.size() == most) {
                ++left_out;
            } else {
                row_of_reason[{std::string(name_of(verdict)), cell.scan, text}] = table.rows.size();
                names.add(table.rows.size(), variant);
                table.rows.push_back({std::string(name_of(verdict)), cell.scan, "", text});
            }
        }
    }
    for (std::size_t row = 0; row < table.rows.size(); ++row) table.rows[row][2] = names.text(row);
    if (left_out > 0) table.rest = fmt::format("and {}", count_text(left_out, "more cell", "more cells"));
    return table;
}

ReportTable known_table(const Comparison& comparison, std::size_t most) {
    ReportTable table{{"scan", "variant", "known to", "since", "why"}, {}, {}};
    const bool with_workflow = has_several_workflows(comparison);
    for (const CellComparison& cell : comparison.cells) {
        if (!cell.known || table.rows.size() == most) continue;
        table.rows.push_back({cell.scan, variant_text(cell, with_workflow), cell.known->who,
                              cell.known->at.substr(0, 10), cell.known->why});
    }
    if (comparison.known() > table.rows.size())
        table.rest =
            fmt::format("and {}", count_text(comparison.known() - table.rows.size(), "more cell", "more cells"));
    return table;
}

ReportTable matrix(const Comparison& comparison, const std::string& metric, std::size_t most) {
    const bool with_workflow = has_several_workflows(comparison);
    MatrixAxis scans, variants;
    std::set<std::string> units;
    for (const CellComparison& cell : comparison.cells) {
        scans.add(cell.scan, is_trouble(cell.verdict));
        variants.add(variant_text(cell, with_workflow), is_trouble(cell.verdict));
        if (const auto value = number_of(cell, metric)) units.insert(length_unit_text(value->metric, value->lengths));
    }
    const bool one_unit = units.size() == 1;
    const bool by_variant = scans.names.size() == 1 && variants.names.size() > 1;
    const MatrixAxis& down = by_variant ? variants : scans;
    const MatrixAxis& across = by_variant ? scans : variants;
    std::vector<std::vector<std::string>> rows(down.names.size(),
                                               std::vector<std::string>(across.names.size() + 1, "-"));
    for (std::size_t row = 0; row < rows.size(); ++row) rows[row][0] = down.names[row];
    for (const CellComparison& cell : comparison.cells) {
        const std::size_t scan = scans.index.at(cell.scan);
        const std::size_t variant = variants.index.at(variant_text(cell, with_workflow));
        std::string& text = by_variant ? rows[variant][1 + scan] : rows[scan][1 + variant];
        const auto value = number_of(cell, metric);
        if (!value) {
            text = is_trouble(cell.verdict) ? name_of(cell.verdict) : "-";
            continue;
        }
        text = is_cost(metric) ? cost_text(metric, value->metric.value)
               : one_unit      ? display(value->metric)
                               : display(value->metric, value->lengths);
        if (cell.verdict == Verdict::failed) text = "failed";
        if (has_regressed(cell, *value)) text += " !";
        if (cell.verdict == Verdict::doubtful) text += " ?";
    }
    const std::string unit = one_unit && !is_cost(metric) ? *units.begin() : "";
    ReportTable table{{unit.empty() ? metric : fmt::format("{} ({})", metric, unit)}, {}, {}};
    table.headers.insert(table.headers.end(), across.names.begin(), across.names.end());
    if (rows.size() <= most) {
        table.rows = std::move(rows);
        return table;
    }
    for (const bool trouble : {true, false})
        for (std::size_t row = 0; row < rows.size() && table.rows.size() < most; ++row)
            if (down.has_trouble[row] == trouble) table.rows.push_back(rows[row]);
    table.rest = fmt::format("and {} more {}", rows.size() - table.rows.size(), by_variant ? "variants" : "scans");
    return table;
}

std::vector<std::string> commands_of(const Comparison& comparison) {
    std::vector<std::string> commands;
    std::set<std::string> seen;
    for (const Verdict verdict : {Verdict::regressed, Verdict::failed})
        for (const CellComparison& cell : comparison.cells)
            if (cell.verdict == verdict && !cell.command.empty() && seen.insert(cell.command).second)
                commands.push_back(cell.command);
    return commands;
}

}  // namespace scanmill
