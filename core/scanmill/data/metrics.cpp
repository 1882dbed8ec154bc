// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/metrics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scanmill {

void Metrics::set(std::string_view name, double value, Unit kind) {
    const auto found = std::ranges::find(values, name, &Metric::name);
    Metric& metric = found == values.end() ? values.emplace_back(Metric{std::string(name), 0, kind}) : *found;
    metric.value = value;
    metric.unit = kind;
}

const Metric* Metrics::find(std::string_view name) const {
    const auto found = std::ranges::find(values, name, &Metric::name);
    return found == values.end() ? nullptr : &*found;
}

std::string display(const Metric& metric) {
    if (metric.unit == Unit::boolean) return metric.value != 0 ? "yes" : "no";
    if (metric.unit == Unit::angle) return fmt::format("{:.4g} deg", metric.value * 180 / std::numbers::pi);
    if (metric.unit == Unit::ratio) return fmt::format("{:.4g} %", metric.value * 100);
    if (metric.value == std::floor(metric.value) && std::abs(metric.value) < 1e15)
        return fmt::format("{:.0f}", metric.value);
    return fmt::format("{:.6g}", metric.value);
}

std::string display(const Metric& metric, LengthUnit unit) {
    switch (metric.unit) {
        case Unit::length: return fmt::format("{} {}", display(metric), symbol(unit));
        case Unit::area: return fmt::format("{} {}²", display(metric), symbol(unit));
        case Unit::volume: return fmt::format("{} {}³", display(metric), symbol(unit));
        default: return display(metric);
    }
}

}  // namespace scanmill
