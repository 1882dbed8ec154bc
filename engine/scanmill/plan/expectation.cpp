// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plan/expectation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/kinds/value.hpp"
#include "scanmill/workflow/length_power.hpp"

namespace scanmill {

ParameterSpec written_as(Unit unit) {
    ParameterSpec spec;
    switch (unit) {
        case Unit::boolean: spec.type = ParameterType::boolean; break;
        case Unit::length:
        case Unit::area:
        case Unit::volume: spec.type = ParameterType::length; break;
        case Unit::angle: spec.type = ParameterType::angle; break;
        case Unit::ratio: spec.type = ParameterType::ratio; break;
        default: spec.type = ParameterType::number;
    }
    return spec;
}

std::vector<MetricSpec> expectable(const FilterSpec& spec) {
    std::vector<MetricSpec> askable = spec.metrics;
    for (const PropertySpec& property : property_specs(spec.outputs.front().kind))
        if (!spec.metric(property.name)) askable.push_back({property.name, property.unit, property.help});
    return askable;
}

namespace {

ParameterValue parse_end(Unit unit, const std::string& text) {
    const int power = power_of_length(unit);
    if (power > 1) return ParameterScalar(parse_length_power(text, power));
    return parse(written_as(unit), {{text}, false});
}

/// In the metric's own unit: scan units and their powers, radians, fractions, 0 or 1.
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

/// Whether nothing lies between the ends, whatever the scan. Only absolute lengths in different units can be compared
/// without it.
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

/// Throws Error for what no number can meet.
void require_possible(const PlannedExpectation& expectation) {
    const bool equal = expectation.relation == Expectation::Relation::equal;
    if (expectation.unit == Unit::count && equal)
        if (const double wanted = number_of(expectation.low, Unit::count, {}); wanted != std::floor(wanted))
            throw Error("a count is never {}; expected a whole number", number_text(wanted));
    if (is_backwards(expectation))
        throw Error("nothing lies in {}; expected the lower end first",
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
    const std::vector<MetricSpec> askable = expectable(spec);
    const MetricSpec* declared = spec.metric(written.name);
    const auto asked = std::ranges::find(askable, declared ? declared->name : written.name, &MetricSpec::name);
    if (asked == askable.end()) {
        std::vector<std::string> names;
        for (const MetricSpec& metric : askable) names.push_back(metric.name);
        diagnostics.error(written.position,
                          fmt::format("nothing is known as '{}' of what {} gives; expect takes {}{}", written.name,
                                      spec.name, enumerated(names), did_you_mean(written.name, names)));
        return std::nullopt;
    }
    PlannedExpectation planned{written.name, written.position,         written.relation, asked->unit, {},
                               {},           expectation_text(written)};
    try {
        planned.low = parse_end(asked->unit, written.value);
        if (written.relation == Expectation::Relation::between) planned.high = parse_end(asked->unit, written.high);
        require_possible(planned);
    } catch (const Error& error) {
        diagnostics.error(written.position, fmt::format("expect {}: {}", written.name, error.sentence()));
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
                             metric ? display(*metric, scale.unit) : "that it is not defined");
    }
    if (!unmet.empty()) throw Error(unmet);
}

}  // namespace scanmill
