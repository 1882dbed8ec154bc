// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `metrics`: named numbers with units, in the order they were reported.
///
/// Metrics of an object with a size contain the metric `diagonal`, which `%diag` refers to.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/data/frame.hpp"

namespace scanmill {

/// What a metric's number counts or measures. Lengths are in the scan's unit, angles in radians, ratios plain
/// fractions.
enum class Unit { count, length, area, volume, angle, ratio, seconds, number, boolean };
std::string_view name_of(Unit unit);
std::optional<Unit> unit_named(std::string_view name);

/// Which of two values of a metric is the better one; `neither` also for those that only should not change.
enum class Better { neither, larger, smaller };
std::string_view name_of(Better better);
std::optional<Better> better_named(std::string_view name);

struct Metric {
    std::string name;
    double value;
    Unit unit;
    bool operator==(const Metric&) const = default;
};

struct Metrics {
    std::vector<Metric> values;
    LengthUnit unit = LengthUnit::unknown;  ///< of lengths; areas and volumes are in its powers

    /// Replaces an earlier metric of the same name.
    void set(std::string_view name, double value, Unit kind);
    const Metric* find(std::string_view name) const;
};

/// "3000", "0.0125", "yes": a metric's number for people; angles in degrees, ratios in percent.
std::string display(const Metric& metric);
/// The same with the unit of lengths: "0.0125 mm", "3.2 u²".
std::string display(const Metric& metric, LengthUnit unit);

}  // namespace scanmill
