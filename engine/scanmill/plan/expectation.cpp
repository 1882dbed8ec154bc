// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plan/expectation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/kinds/value.hpp"
#include "scanmill/workflow/sizes.hpp"

namespace scanmill {

ParameterSpec written_as(Unit unit) {
    ParameterSpec spec;
    spec.type = power_of_length(unit) > 0 ? ParameterType::length
                : unit == Unit::boolean   ? ParameterType::boolean
                : unit == Unit::angle     ? ParameterType::angle
                : unit == Unit::ratio     ? ParameterType::ratio
                                          : ParameterType::number;
    return spec;
}

std::vector<MetricSpec> expectable(const FilterSpec& spec) {
    std::vector<MetricSpec> all = spec.metrics;
    for (const PropertySpec& property : property_specs(spec.outputs.front().kind))
        if (!spec.metric(property.name)) all.push_back({property.name, property.unit, property.help});
    return all;
}

namespace {

ParameterValue parse_end(Unit unit, const std::string& text) {
    const int power = power_of_length(unit);
    if (power > 1) return ParameterScalar(parse_length_power(text, power));
    return parse(written_as(unit), {{text}, false});
}

/// The number in the unit of a metric: powers of the scan's unit, radians, fractions, or 0 and 1 for booleans.
double number_of(const ParameterValue& value, Unit unit, const LengthScale& scale) {
    const ParameterScalar& scalar = std::get<ParameterScalar>(value);
    if (const auto* flag = std::get_if<bool>(&scalar)) return *flag ? 1 : 0;
    if (const auto* length = std::get_if<Length>(&scalar)) {
        const int power = power_of_length(unit);
        return power > 1 ? resolved_length_power(*length, power, scale) : length->resolved(scale).value();
    }
    if (const auto* angle = std::get_if<Angle>(&scalar)) return angle->in_radians();
    if (const auto* ratio = std::get_if<Ratio>(&scalar)) return ratio->value();
    return std::get<double>(scalar);
}

bool is_met(const PlannedExpectation& expectation, double found, const LengthScale& scale) {
    const auto number = [&](const ParameterValue& end) { return number_of(end, expectation.unit, scale); };
    const double low = number(expectation.low);
    switch (expectation.relation) {
        case Expectation::Relation::equal: return found == low;
        case Expectation::Relation::below: return found < low;
        case Expectation::Relation::above: return found > low;
        case Expectation::Relation::between: return found >= low && found <= number(expectation.high);
    }
    return false;
}

/// Whether the range is empty on every scan. Lengths in different units are compared only when both are absolute.
bool is_backwards(const PlannedExpectation& expectation) {
    if (expectation.relation != Expectation::Relation::between) return false;
    if (power_of_length(expectation.unit) == 0)
        return number_of(expectation.low, expectation.unit, {}) > number_of(expectation.high, expectation.unit, {});
    const auto length = [](const ParameterValue& end) { return std::get<Length>(std::get<ParameterScalar>(end)); };
    const Length low = length(expectation.low), high = length(expectation.high);
    if (low.in() == high.in()) return low.amount() > high.amount();
    if (!is_absolute(low) || !is_absolute(high)) return false;
    const LengthScale any{LengthUnit::millimetre, {}, {}};
    return number_of(expectation.low, expectation.unit, any) > number_of(expectation.high, expectation.unit, any);
}

/// Throws Error for an expectation that no number can meet.
void require_possible(const PlannedExpectation& expectation) {
    const bool equal = expectation.relation == Expectation::Relation::equal;
    if (expectation.unit == Unit::count && equal)
        if (const double wanted = number_of(expectation.low, Unit::count, {}); wanted != std::floor(wanted))
            throw Error("a count is never {}; expected a whole number", number_text(wanted));
    if (is_backwards(expectation))
        throw Error("the range {} is empty; expected the lower end first",
                    expectation.text.substr(expectation.text.find('[')));
}

std::string expectation_text(const Expectation& written) {
    switch (written.relation) {
        case Expectation::Relation::equal: return fmt::format("{}: {}", written.name, written.value);
        case Expectation::Relation::below: return fmt::format("{} < {}", written.name, written.value);
        case Expectation::Relation::above: return fmt::format("{} > {}", written.name, written.value);
        case Expectation::Relation::between:
            return fmt::format("{} in [{}, {}]", written.name, written.value, written.high);
    }
    return "";
}

}  // namespace

std::optional<PlannedExpectation> plan_expectation(const Expectation& written, const FilterSpec& spec,
                                                   Diagnostics& diagnostics) {
    const std::vector<MetricSpec> metrics = expectable(spec);
    const MetricSpec* declared = spec.metric(written.name);
    const auto found = std::ranges::find(metrics, declared ? declared->name : written.name, &MetricSpec::name);
    if (found == metrics.end()) {
        std::vector<std::string> names;
        for (const MetricSpec& metric : metrics) names.push_back(metric.name);
        diagnostics.error(written.position, "{} has no metric or property '{}'; expect accepts {}{}", spec.name,
                          written.name, enumerated(names), did_you_mean(written.name, names));
        return std::nullopt;
    }
    PlannedExpectation planned{written.name, written.position,         written.relation, found->unit, {},
                               {},           expectation_text(written)};
    try {
        planned.low = parse_end(found->unit, written.value);
        if (written.relation == Expectation::Relation::between) planned.high = parse_end(found->unit, written.high);
        require_possible(planned);
    } catch (const Error& error) {
        diagnostics.error(written.position, "expect {}: {}", written.name, error.sentence());
        return std::nullopt;
    }
    return planned;
}

void require_met(const std::vector<PlannedExpectation>& expectations, const Metrics& found, const LengthScale& scale) {
    std::string unmet;
    for (const PlannedExpectation& expectation : expectations) {
        const Metric* metric = found.find(expectation.name);
        if (metric && is_met(expectation, metric->value, scale)) continue;
        unmet += fmt::format("{}expected {}, found {}", unmet.empty() ? "" : "; ", expectation.text,
                             metric ? display(*metric, scale.unit) : "no such value");
    }
    if (!unmet.empty()) throw Error(unmet);
}

}  // namespace scanmill
