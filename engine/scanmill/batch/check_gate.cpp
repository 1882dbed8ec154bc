// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/batch/check_gate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill {

namespace {

/// The properties of a metric that are needed to check a rule.
struct Gated {
    Unit unit;
    Better better;
};

class GateCheck {
public:
    GateCheck(const Batch& batch, std::span<const BatchPart> parts, const FilterLibrary& library,
              Diagnostics& diagnostics)
        : batch_(batch),
          library_(library),
          diagnostics_(diagnostics) {
        for (const BatchPart& part : parts) {
            for (const PlannedStep& step : part.plan->steps) steps_.push_back(&step);
            for (const PlannedVariant& variant : part.plan->variants)
                for (const PlannedOutput& output : variant.outputs)
                    for (PropertySpec& property : property_specs(kind_of(*part.plan, output.source)))
                        properties_.emplace(property.name, Gated{property.unit, property.better});
        }
    }

    void check() {
        for (const GateRule& rule : batch_.gate->rules) try {
                check(rule);
            } catch (const Error& error) {
                diagnostics_.error(rule.position, "{}: {}", rule.metric, error.sentence());
            }
        const auto is_of_cost = [](const GateRule& rule) { return is_cost(rule.metric); };
        if (batch_.gate->repeats > 1 && !batch_.gate->rules.empty() &&
            std::ranges::none_of(batch_.gate->rules, is_of_cost))
            diagnostics_.warning({},
                                 "`repeats` has no effect: the gate has no rule for seconds, cpu-seconds or memory");
    }

private:
    void check(const GateRule& rule) {
        if (is_cost(rule.metric)) {
            parse_cost_tolerance(rule.text);
        } else if (rule.metric == "outputs") {
            if (rule.text != "exact")
                throw Error("'{}' is not a rule for the bytes of output files; expected exact", rule.text);
        } else {
            const std::vector<Gated> metrics = metrics_of(rule);
            for (const Gated& gated : metrics) require_rule_fits(rule.text, gated.unit, gated.better);
            if (requires_truth(rule.text) && !metrics.empty()) require_truth_of(rule.metric);
        }
    }

    /// Throws Error if no step reports the value of the truth for this metric.
    void require_truth_of(const std::string& metric) const {
        const std::size_t dot = metric.find('.');
        const std::string name =
            std::string(truth_prefix) + (dot == std::string::npos ? metric : metric.substr(dot + 1));
        if (of_steps(name, [](const PlannedStep*) { return true; }).empty())
            throw Error(
                "'= truth' needs a metric '{}', which no step or measurement reports; expected exact, or "
                "`measure:` and scans with a truth",
                name);
    }

    /// The metrics to which the rule applies (see gate.hpp); empty after an error.
    std::vector<Gated> metrics_of(const GateRule& rule) {
        if (const std::size_t dot = rule.metric.find('.'); dot != std::string::npos)
            return of_step(rule, rule.metric.substr(0, dot), rule.metric.substr(dot + 1));
        std::vector<Gated> found =
            of_steps(rule.metric, [](const PlannedStep* step) { return is_measurement(step->label); });
        if (!found.empty()) return found;
        if (const auto property = properties_.find(rule.metric); property != properties_.end())
            return {property->second};
        found = of_steps(rule.metric, [](const PlannedStep*) { return true; });
        if (found.empty()) report_unknown(rule);
        return found;
    }

    template <class Which>
    std::vector<Gated> of_steps(const std::string& metric, const Which& which) const {
        std::vector<Gated> found;
        for (const PlannedStep* step : steps_)
            if (const MetricSpec* spec = which(step) ? step->spec.metric(metric) : nullptr)
                found.push_back({spec->unit, spec->better});
        return found;
    }

    std::vector<Gated> of_step(const GateRule& rule, const std::string& label, const std::string& metric) {
        const auto is_it = [&](const PlannedStep* step) { return step->label == label; };
        std::vector<Gated> found = of_steps(metric, is_it);
        if (!found.empty()) return found;
        if (const auto step = std::ranges::find_if(steps_, is_it); step != steps_.end()) {
            diagnostics_.error(rule.position, "the step '{}' has no metric '{}'; {}", label, metric,
                               it_has((*step)->spec.metrics, metric));
        } else {
            const std::vector<std::string> names = labels();
            diagnostics_.error(rule.position, "no workflow has a step '{}'; they have {}{}", label, enumerated(names),
                               did_you_mean(label, names));
        }
        return {};
    }

    std::vector<std::string> labels() const {
        std::set<std::string> names;
        for (const PlannedStep* step : steps_) names.insert(step->label);
        return {names.begin(), names.end()};
    }

    void report_unknown(const GateRule& rule) {
        const std::vector<std::string> names = labels();
        if (std::ranges::find(names, rule.metric) != names.end()) {
            diagnostics_.error(rule.position, "'{}' is a step; expected one of its metrics, as {}.NAME", rule.metric,
                               rule.metric);
            return;
        }
        for (const std::string& filter : library_.names())
            if (const FilterSpec& spec = *library_.find(filter); spec.measures && spec.metric(rule.metric)) {
                diagnostics_.error(
                    rule.position, "'{}' is measured by '{}', but {}", rule.metric, filter,
                    !batch_.measure ? "the batch has no `measure:`" : "no scan with a truth has a value to measure");
                return;
            }
        std::set<std::string> metrics{"seconds", "cpu-seconds", "memory", "outputs"};
        for (const auto& [name, gated] : properties_) metrics.insert(name);
        for (const PlannedStep* step : steps_)
            for (const MetricSpec& metric : step->spec.metrics) metrics.insert(metric.name);
        const std::vector<std::string> known(metrics.begin(), metrics.end());
        const std::string proposal = did_you_mean(rule.metric, known);
        diagnostics_.error(rule.position, "no step, measurement or output of the batch has a metric '{}'{}",
                           rule.metric,
                           proposal.empty() ? "; `scanmill show FILTER` lists a filter's metrics" : proposal);
    }

    const Batch& batch_;
    const FilterLibrary& library_;
    Diagnostics& diagnostics_;
    std::vector<const PlannedStep*> steps_;  // steps of all plans
    std::map<std::string, Gated> properties_;  // properties of the outputs
};

}  // namespace

void check_gate(const Batch& batch, std::span<const BatchPart> parts, const FilterLibrary& library,
                Diagnostics& diagnostics) {
    GateCheck(batch, parts, library, diagnostics).check();
}

}  // namespace scanmill
