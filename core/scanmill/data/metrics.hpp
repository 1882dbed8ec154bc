// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `metrics`: named numbers with units, in the order they were reported.
///
/// Metrics of an object with a size contain the metric `diagonal`, which `%diag` refers to.

#include <string>
#include <string_view>
#include <vector>

#include "scanmill/data/frame.hpp"
#include "scanmill/record/fields.hpp"

namespace scanmill {

/// The quantity that a metric's number counts or measures. Lengths are in the scan's unit, angles in radians, ratios
/// plain fractions.
enum class Unit { count, length, area, volume, angle, ratio, seconds, number, boolean };
constexpr std::array<std::string_view, 9> names_of(const Unit*) {
    return {"count", "length", "area", "volume", "angle", "ratio", "seconds", "number", "boolean"};
}

/// Which of two values of a metric is better. `neither` includes metrics that should merely not change.
enum class Better { neither, larger, smaller };
constexpr std::array<std::string_view, 3> names_of(const Better*) { return {"neither", "larger", "smaller"}; }

struct Metric {
    std::string name;
    double value;
    Unit unit;
    bool operator==(const Metric&) const = default;
};
constexpr auto fields(const Metric*) {
    return std::tuple{field("name", &Metric::name), field("value", &Metric::value).nullable(),
                      field("unit", &Metric::unit)};
}

struct Metrics {
    std::vector<Metric> values;
    LengthUnit unit = LengthUnit::unknown;  ///< unit of lengths; areas and volumes use its powers

    /// Replaces an earlier metric of the same name.
    void set(std::string_view name, double value, Unit kind);
    const Metric* find(std::string_view name) const;
};
constexpr auto fields(const Metrics*) {
    return std::tuple{field("values", &Metrics::values), field("unit", &Metrics::unit, "The unit of lengths.")};
}

/// "3000", "0.0125", "yes": a metric's number for people; angles in degrees, ratios in percent.
std::string display(const Metric& metric);
/// A metric's number with its unit: "0.0125 mm", "3.2 u²". `unit` is the unit of lengths.
std::string display(const Metric& metric, LengthUnit unit);

}  // namespace scanmill
