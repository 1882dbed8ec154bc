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

constexpr std::array<std::string_view, 3> relative_suffixes{"u", "%diag", "spacing"};  // indexed by Length::In

/// LengthUnit::unknown for lengths that are relative or in the scan's unit.
LengthUnit unit_of(Length::In in) {
    const auto relative = static_cast<int>(relative_suffixes.size());
    return static_cast<LengthUnit>(std::max(0, static_cast<int>(in) + 1 - relative));
}

struct Dimensioned {
    double amount;
    std::string_view suffix;
};

/// Splits "0.1 %diag" into its number and its suffix. Throws Error if it does not begin with a finite number.
Dimensioned split(std::string_view text, std::string_view noun, std::string_view examples) {
    Dimensioned result{};
    const char* begin = text.data();
    const char* end = begin + text.size();
    if (text.size() > 1 && *begin == '+' && begin[1] != '-') ++begin;
    const auto [rest, error] = std::from_chars(begin, end, result.amount);
    if (error != std::errc() || !std::isfinite(result.amount))
        throw Error("'{}' is not {}", text, noun).expected(examples);
    result.suffix = {rest, end};
    result.suffix.remove_prefix(std::min(result.suffix.find_first_not_of(' '), result.suffix.size()));
    return result;
}

Dimensioned split_with_unit(std::string_view text, std::string_view noun, std::string_view examples) {
    const Dimensioned parts = split(text, noun, examples);
    if (parts.suffix.empty()) throw Error("'{}' has no unit", text).expected(examples);
    return parts;
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
    const auto in_range = [&](double length) {
        if (!std::isfinite(length) || (length == 0 && amount_ != 0))
            throw Error("{} is outside the range of a length: it is {} u", text(), length);
        return Length(length);
    };
    const auto times = [&](const std::function<double()>& reference, double factor, std::string_view what) {
        const double length = reference ? reference() : 0;
        if (!(length > 0 && std::isfinite(length)))
            throw Error("{} cannot be resolved: the scan's {} is {}", text(), what, length)
                .hint("give the length in the scan's unit, for example 0.5 u");
        return in_range(amount_ * factor * length);
    };
    if (in_ == In::scan_unit) return *this;
    if (in_ == In::percent_of_diagonal) return times(scale.diagonal, 0.01, "bounding-box diagonal");
    if (in_ == In::spacing) return times(scale.spacing, 1, "point spacing");
    const LengthUnit unit = unit_of(in_);
    if (scale.unit == unit) return Length(amount_);
    if (scale.unit == LengthUnit::unknown)
        throw Error("{} needs a scan of known unit; this scan's unit is not declared", text())
            .hint(
                "declare it with `inputs: {scan: {kind: points, unit: mm}}` in the workflow, or write the length in "
                "the scan's own unit, for example 0.5 u")
            .remedy(Remedy::declare_unit);
    return in_range(in_unit(amount_, unit, scale.unit));
} catch (const Error& error) {
    throw UnresolvedLength(*this, error);
}

std::string Length::text() const {
    const auto relative = static_cast<std::size_t>(in_);
    const std::string_view suffix =
        relative < relative_suffixes.size() ? relative_suffixes[relative] : symbol(unit_of(in_));
    return number_text(amount_).append(" ").append(suffix);
}

Length Length::parse(std::string_view text) {
    auto [amount, suffix] = split_with_unit(text, "a length", length_examples);
    if (suffix == "spacings") suffix = "spacing";
    if (const auto found = std::ranges::find(relative_suffixes, suffix); found != relative_suffixes.end())
        return {amount, static_cast<In>(found - relative_suffixes.begin())};
    if (const std::optional<LengthUnit> unit = length_unit(suffix))
        return {amount, static_cast<In>(static_cast<int>(*unit) + static_cast<int>(relative_suffixes.size()) - 1)};
    if (suffix == "%")
        throw Error("'{}' has no reference", text)
            .expected(fmt::format("{} %diag, a share of the bounding box's diagonal", amount));
    throw Error("'{}' is not a unit of length", suffix)
        .expected(fmt::format("u, %diag, spacing, {}", length_unit_symbols()));
}

double Angle::in_radians() const { return degrees_ ? amount_ * (std::numbers::pi / 180) : amount_; }
double Angle::in_degrees() const { return degrees_ ? amount_ : amount_ * (180 / std::numbers::pi); }
std::string Angle::text() const { return number_text(amount_) + (degrees_ ? " deg" : " rad"); }

Angle Angle::parse(std::string_view text) {
    const auto [amount, suffix] = split_with_unit(text, "an angle", angle_examples);
    if (suffix == "deg") return degrees(amount);
    if (suffix == "rad") return radians(amount);
    throw Error("'{}' is not a unit of angle", suffix).expected("deg or rad");
}

std::string Ratio::text() const { return number_text(amount_) + (percent_ ? " %" : ""); }

Ratio Ratio::parse(std::string_view text) {
    const auto [amount, suffix] = split(text, "a ratio", ratio_examples);
    if (suffix == "%") return percent(amount);
    if (suffix.empty()) return fraction(amount);
    throw Error("'{}' is not a ratio", text).expected(ratio_examples);
}

}  // namespace scanmill
