// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/gate/gate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/workflow/sizes.hpp"

namespace scanmill {

namespace {

/// The accepted forms of a rule, for messages: "+1 %, +0.01 mm, +0.1 %diag or exact".
std::string_view forms_of(Unit unit) {
    switch (unit) {
        case Unit::length: return "+1 %, +0.01 mm, +0.1 %diag or exact";
        case Unit::area: return "+1 %, +12 mm2, +0.5 u2 or exact";
        case Unit::volume: return "+1 %, +12 mm3, +0.5 u3 or exact";
        case Unit::angle: return "+1 %, +3 deg or exact";
        case Unit::seconds: return "+20 %, +5 s or exact";
        case Unit::boolean: return "exact";
        case Unit::ratio: return "+1 % (of the accepted value), +0.01 or exact";
        case Unit::count: return "+1 %, +2 or exact";
        case Unit::number: return "+1 %, +0.5 or exact";
    }
    return "exact";
}

double length_amount(std::string_view text, int power, const LengthScale& scale) {
    const Length written = power > 1 ? parse_length_power(text, power) : Length::parse(text);
    if (written.in() == Length::In::spacing)
        throw Error("'{}' cannot be used: the point spacing of the accepted run is not recorded", text);
    if (power > 1) return resolved_length_power(written, power, scale);
    return written.amount() == 0 ? 0 : written.resolved(scale).value();
}

double number_amount(std::string_view text) {
    double amount = 0;
    if (!parse_number(text, amount) || !std::isfinite(amount)) throw Error("'{}' is not a number", text);
    return amount;
}

/// Parses an amount without a sign; returns it in the metric's unit.
double absolute_amount(std::string_view text, Unit unit, const LengthScale& scale) {
    if (const int power = power_of_length(unit); power > 0) return length_amount(text, power, scale);
    if (unit == Unit::angle) return Angle::parse(text).in_radians();
    if (unit == Unit::seconds) return parse_duration(text);
    if (unit == Unit::boolean) throw Error("'{}' cannot limit a metric that is true or false", text);
    return number_amount(text);
}

}  // namespace

Tolerance parse_tolerance(std::string_view text, Unit unit, LengthUnit lengths, double diagonal) {
    if (text == "exact") return {};
    Tolerance tolerance;
    std::string_view amount = text;
    const bool has_sign = amount.starts_with('+') || amount.starts_with('-');
    if (has_sign) {
        tolerance.may_fall = amount.front() == '+';
        tolerance.may_rise = amount.front() == '-';
        amount.remove_prefix(1);
        amount.remove_prefix(std::min(amount.find_first_not_of(' '), amount.size()));
    }
    try {
        if (amount.empty()) throw Error("{} has no amount", has_sign ? quote(text) : "the rule");
        if (amount.front() == '+' || amount.front() == '-') throw Error("{} has two signs", quote(text));
        tolerance.is_relative = amount.ends_with('%') && unit != Unit::boolean;
        const LengthScale scale{lengths, [&] { return diagonal; }, {}};
        tolerance.amount = tolerance.is_relative ? Ratio::parse(amount).value() : absolute_amount(amount, unit, scale);
        if (!std::isfinite(tolerance.amount)) throw Error("{} is too large", quote(amount));
    } catch (const UnresolvedLength&) {
        throw;  // the rule is valid, but its length cannot be converted for this scan
    } catch (const Error& error) {
        if (error.remedy() == Remedy::declare_unit) throw;
        throw Error(error.finding()).expected(forms_of(unit));  // replaces the forms that a parameter expects
    }
    return tolerance;
}

void require_rule_fits(std::string_view text, Unit unit, Better better) {
    if (requires_truth(text)) return;
    // The unit and the diagonal are arbitrary: only the form and the sign are checked.
    const Tolerance tolerance = parse_tolerance(text, unit, LengthUnit::millimetre, 1);
    if (better == Better::neither || text == "exact") return;
    const bool is_right = better == Better::smaller ? tolerance.may_fall : tolerance.may_rise;
    if (is_right) return;
    const bool has_sign = tolerance.may_fall || tolerance.may_rise;
    const std::string amount(text.substr(has_sign ? text.find_first_not_of("+- ") : 0));
    throw Error("'{}' {}: {} is better; expected {}{} or exact", text,
                has_sign ? "limits the wrong direction" : "also limits improvements",
                better == Better::smaller ? "smaller" : "larger", better == Better::smaller ? "+" : "-", amount);
}

bool is_cost(std::string_view metric) { return metric == "seconds" || metric == "cpu-seconds" || metric == "memory"; }

Tolerance parse_cost_tolerance(std::string_view text) {
    constexpr std::string_view expected = "expected a share of the accepted costs, as +20 %";
    if (!text.ends_with('%') || !text.starts_with('+'))
        throw Error("{} is not a limit of a cost; {}", quote(text), expected);
    const Tolerance tolerance = parse_tolerance(text, Unit::number, LengthUnit::unknown, std::nan(""));
    if (tolerance.amount <= 0) throw Error("{} does not allow for noise; {}", quote(text), expected);
    return tolerance;
}

}  // namespace scanmill
