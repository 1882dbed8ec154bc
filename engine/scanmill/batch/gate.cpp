// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/batch/gate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/plan/properties.hpp"
#include "scanmill/workflow/grammar.hpp"

namespace scanmill {

namespace {

/// Of a result against its truth, and of the work itself.
const std::vector<MetricSpec>& measured() {
    static const std::vector<MetricSpec> metrics{
        {"mean", Unit::length, "Mean distance from the result to the truth."},
        {"rms", Unit::length, "Root of the mean squared distance from the result to the truth."},
        {"p50", Unit::length, "Half of the distances to the truth are at most this."},
        {"p90", Unit::length, "90 % of the distances to the truth are at most this."},
        {"p95", Unit::length, "95 % of the distances to the truth are at most this."},
        {"p99", Unit::length, "99 % of the distances to the truth are at most this."},
        {"max", Unit::length, "Largest distance from the result to the truth."},
        {"hausdorff", Unit::length, "Largest distance in either direction."},
        {"chamfer", Unit::length, "Mean distance in both directions."},
        {"f-score", Unit::ratio, "Harmonic mean of precision and completeness; larger is better."},
        {"normal-consistency", Unit::ratio, "How well the normals agree; larger is better."},
        {"volume", Unit::volume, "The volume that the mesh encloses."},
        {"area", Unit::area, "The mesh's area."},
        {"self-intersections", Unit::count, "Pairs of triangles that cut each other."},
        {"seconds", Unit::seconds, "Time that the work took."},
        {"memory", Unit::number, "Most memory that the work held."}};
    return metrics;
}

bool costs(const std::string& metric) { return metric == "seconds" || metric == "memory"; }

bool takes_length(Unit unit) { return unit == Unit::length; }
/// Whether "3" of them is said without a unit.
bool takes_number(Unit unit) { return unit == Unit::count || unit == Unit::number || unit == Unit::ratio; }

std::string forms_of(const std::vector<Unit>& units, const std::string& metric) {
    std::string forms = costs(metric) ? "" : "exact, ";
    forms += "+1 %";
    if (std::ranges::any_of(units, takes_length)) forms += ", +0.2 mm, +0.1 %diag";
    if (std::ranges::any_of(units, takes_number) && !costs(metric))
        forms += std::ranges::find(units, Unit::ratio) != units.end() ? ", +0.01" : ", +3";
    return forms;
}

using Allowed = std::variant<Unchanged, Ratio, Length, double>;

/// Throws Error for what is no rule at all.
Allowed parse_allowed(const std::string& text) {
    if (text == "exact") return Unchanged{};
    double number = 0;
    if (parse_number(text, number)) return number;
    if (text.ends_with('%')) return Ratio::parse(text);
    return Length::parse(text);
}

double amount_of(const Allowed& allowed) {
    if (const auto* ratio = std::get_if<Ratio>(&allowed)) return ratio->value();
    if (const auto* length = std::get_if<Length>(&allowed)) return length->amount();
    if (const auto* number = std::get_if<double>(&allowed)) return *number;
    return 0;
}

bool fits(const Allowed& allowed, const std::vector<Unit>& units, const std::string& metric) {
    if (std::holds_alternative<Unchanged>(allowed)) return !costs(metric);
    if (std::holds_alternative<Length>(allowed)) return std::ranges::any_of(units, takes_length);
    if (std::holds_alternative<double>(allowed)) return !costs(metric) && std::ranges::any_of(units, takes_number);
    return true;
}

class GateParser {
public:
    GateParser(const FilterLibrary& library, Diagnostics& diagnostics)
        : metrics_(gate_metrics(library)),
          diagnostics_(diagnostics) {
        for (const MetricSpec& metric : metrics_) names_.push_back(metric.name);
        names_.erase(std::unique(names_.begin(), names_.end()), names_.end());
    }

    std::vector<GateRule> rules(const YamlNode& node) {
        std::vector<GateRule> rules;
        if (!require_map(node, "a map from metrics to what they may lose, as {hausdorff: +1 %, genus: exact}",
                         diagnostics_))
            return rules;
        for (const YamlEntry& entry : node.entries)
            if (auto rule = this->rule(entry)) rules.push_back(std::move(*rule));
        return rules;
    }

private:
    std::optional<GateRule> rule(const YamlEntry& entry) {
        std::vector<Unit> units;
        for (const MetricSpec& metric : metrics_)
            if (metric.name == entry.key) units.push_back(metric.unit);
        if (units.empty()) {
            diagnostics_.error(entry.position, fmt::format("nothing is measured as '{}'; a gate takes {}{}", entry.key,
                                                           enumerated(names_), did_you_mean(entry.key, names_)));
            return std::nullopt;
        }
        const std::string forms = forms_of(units, entry.key);
        const auto text =
            require_text(entry.value, fmt::format("what {} may lose: {}", entry.key, forms), diagnostics_);
        if (!text) return std::nullopt;
        const auto refuse = [&](const std::string& reason) {
            diagnostics_.error(entry.value.position, fmt::format("{}: {}; expected {}", entry.key, reason, forms));
            return std::nullopt;
        };
        try {
            GateRule rule{entry.key, entry.position, parse_allowed(*text), *text};
            const double amount = amount_of(rule.allowed);
            if (!fits(rule.allowed, units, entry.key)) return refuse(fmt::format("'{}' does not fit it", *text));
            if (!(amount >= 0) || !std::isfinite(amount)) return refuse(fmt::format("'{}' is out of range", *text));
            return rule;
        } catch (const Error&) {
            return refuse(fmt::format("'{}' is no rule", *text));
        }
    }

    std::vector<MetricSpec> metrics_;
    std::vector<std::string> names_;
    Diagnostics& diagnostics_;
};

}  // namespace

std::vector<MetricSpec> gate_metrics(const FilterLibrary& library) {
    std::vector<MetricSpec> all = measured();
    for (const MetricSpec& fact : fact_specs(Kind::mesh)) all.push_back(fact);
    for (const std::string& filter : library.names())
        for (const MetricSpec& metric : library.find(filter)->metrics) all.push_back(metric);
    std::vector<MetricSpec> unique;
    std::set<std::pair<std::string, Unit>> known;
    for (MetricSpec& metric : all)
        if (known.emplace(metric.name, metric.unit).second) unique.push_back(std::move(metric));
    // Rows of one name side by side; otherwise as they came.
    std::vector<std::string> order;
    for (const MetricSpec& metric : unique)
        if (std::ranges::find(order, metric.name) == order.end()) order.push_back(metric.name);
    std::ranges::stable_sort(
        unique, {}, [&](const MetricSpec& metric) { return std::ranges::find(order, metric.name) - order.begin(); });
    return unique;
}

std::vector<GateRule> parse_gate(const YamlNode& node, const FilterLibrary& library, Diagnostics& diagnostics) {
    return GateParser(library, diagnostics).rules(node);
}

}  // namespace scanmill
