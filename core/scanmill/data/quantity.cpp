// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/quantity.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill {

namespace {

struct LengthSuffix {
    Length::In in;
    std::string_view text;
    LengthUnit unit;  // unknown for the relative ones
};
constexpr std::array<LengthSuffix, 9> suffixes{{
    {Length::In::scan_unit, "u", LengthUnit::unknown},
    {Length::In::percent_of_diagonal, "%diag", LengthUnit::unknown},
    {Length::In::spacing, "spacing", LengthUnit::unknown},
    {Length::In::micrometre, "um", LengthUnit::micrometre},
    {Length::In::millimetre, "mm", LengthUnit::millimetre},
    {Length::In::centimetre, "cm", LengthUnit::centimetre},
    {Length::In::metre, "m", LengthUnit::metre},
    {Length::In::inch, "in", LengthUnit::inch},
    {Length::In::foot, "ft", LengthUnit::foot},
}};

const LengthSuffix& suffix_of(Length::In in) { return suffixes[static_cast<std::size_t>(in)]; }

struct Dimensioned {
    double amount;
    std::string_view suffix;
};

/// Splits "0.1 %diag" into its number and what follows; false when it does not begin with a finite number.
bool split(std::string_view text, Dimensioned& result) {
    const char* begin = text.data();
    const char* end = begin + text.size();
    if (text.size() > 1 && *begin == '+' && begin[1] != '-') ++begin;
    const auto [rest, error] = std::from_chars(begin, end, result.amount);
    if (error != std::errc() || !std::isfinite(result.amount)) return false;
    std::string_view suffix(rest, end);
    while (!suffix.empty() && suffix.front() == ' ') suffix.remove_prefix(1);
    result.suffix = suffix;
    return true;
}

}  // namespace

double Length::value() const {
    if (in_ != In::scan_unit)
        throw UnresolvedLength(*this, Error("the length {} was not resolved into the scan's unit", text())
                                          .hint("call length.resolved(length_scale(scan)) before the algorithm"));
    return amount_;
}

UnresolvedLength::~UnresolvedLength() = default;

Length Length::resolved(const LengthScale& scale) const try {
    const auto finite = [&](double length) {
        if (!std::isfinite(length))
            throw Error("{} comes to more than the largest number, {:.3g} u", text(),
                        std::numeric_limits<double>::max())
                .hint("give a shorter length");
        if (length == 0 && amount_ != 0)
            throw Error("{} comes to less than the smallest number", text()).hint("give a longer length");
        return Length(length);
    };
    const auto times = [&](const std::function<double()>& reference, double factor, std::string_view what) {
        const double length = reference ? reference() : 0;
        if (!(length > 0) || !std::isfinite(length))
            throw Error("{} cannot be resolved: the scan's {} is {}", text(), what, length)
                .hint("give the length in the scan's unit, as 0.5 u");
        return finite(amount_ * factor * length);
    };
    if (in_ == In::scan_unit) return *this;
    if (in_ == In::percent_of_diagonal) return times(scale.diagonal, 0.01, "bounding-box diagonal");
    if (in_ == In::spacing) return times(scale.spacing, 1, "point spacing");
    const LengthSuffix& suffix = suffix_of(in_);
    if (scale.unit == suffix.unit) return Length(amount_);
    if (scale.unit == LengthUnit::unknown)
        throw Error("{} needs a scan of known unit; this scan's unit is not declared", text())
            .hint(
                "declare it with `inputs: {scan: {kind: points, unit: mm}}` in the workflow, or write the length in "
                "the scan's own unit, as 0.5 u")
            .remedy(Remedy::declare_unit);
    return finite(in_unit(amount_, suffix.unit, scale.unit));
} catch (const Error& error) {
    throw UnresolvedLength(*this, error);
}

std::string Length::text() const { return number_text(amount_) + " " + std::string(suffix_of(in_).text); }

std::string_view length_examples() { return "0.2 mm, 0.1 %diag, 3 spacing or 0.5 u"; }

Length Length::parse(std::string_view text) {
    Dimensioned parts;
    if (!split(text, parts)) throw Error("'{}' is not a length; expected {}", text, length_examples());
    if (parts.suffix.empty()) throw Error("'{}' has no unit; expected {}", text, length_examples());
    if (parts.suffix == "spacings") parts.suffix = "spacing";
    for (const LengthSuffix& suffix : suffixes)
        if (suffix.text == parts.suffix) return {parts.amount, suffix.in};
    if (parts.suffix == "%")
        throw Error("'{}' does not say of what; expected {} %diag, of the bounding box's diagonal", text, parts.amount);
    throw Error("'{}' is no unit of length; expected u, %diag, spacing, {}", parts.suffix, length_unit_symbols());
}

double Angle::in_radians() const { return degrees_ ? amount_ * (std::numbers::pi / 180) : amount_; }
double Angle::in_degrees() const { return degrees_ ? amount_ : amount_ * (180 / std::numbers::pi); }
std::string Angle::text() const { return number_text(amount_) + (degrees_ ? " deg" : " rad"); }

Angle Angle::parse(std::string_view text) {
    Dimensioned parts;
    if (!split(text, parts)) throw Error("'{}' is not an angle; expected 40 deg or 0.7 rad", text);
    if (parts.suffix.empty()) throw Error("'{}' has no unit; expected 40 deg or 0.7 rad", text);
    if (parts.suffix == "deg") return degrees(parts.amount);
    if (parts.suffix == "rad") return radians(parts.amount);
    throw Error("'{}' is no unit of angle; expected deg or rad", parts.suffix);
}

std::string Ratio::text() const { return number_text(amount_) + (percent_ ? " %" : ""); }

Ratio Ratio::parse(std::string_view text) {
    Dimensioned parts;
    if (!split(text, parts) || (!parts.suffix.empty() && parts.suffix != "%"))
        throw Error("'{}' is not a ratio; expected 5 % or 0.05", text);
    return parts.suffix.empty() ? fraction(parts.amount) : percent(parts.amount);
}

}  // namespace scanmill
