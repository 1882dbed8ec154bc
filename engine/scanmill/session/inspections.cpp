// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/session/inspections.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanmill {

namespace {

/// "at least 99 %" for "in [99 %, 100 %]", "below 0.1 mm" for "< 0.1 mm"; other texts stay.
std::string limit_text(const std::string& limits, Unit unit) {
    if (limits.starts_with("< ")) return "below " + limits.substr(2);
    if (limits.starts_with("> ")) return "above " + limits.substr(2);
    if (!limits.starts_with("in [") || !limits.ends_with(']')) return limits;
    const std::string ends = limits.substr(4, limits.size() - 5);
    const std::size_t comma = ends.find(", ");
    const std::string low = ends.substr(0, comma), high = comma == std::string::npos ? "" : ends.substr(comma + 2);
    if (unit == Unit::ratio && (high == "100 %" || high == "1")) return "at least " + low;
    if (unit == Unit::ratio && (low == "0 %" || low == "0")) return "at most " + high;
    return low + " to " + high;
}

/// NAME of the whole nominal or of the first item, NAME@2 and so on of the others.
std::string numbered_name(const std::string& metric, std::size_t number) {
    return number == 1 ? metric : fmt::format("{}@{}", metric, number);
}

class PageInspectionMaker {
public:
    explicit PageInspectionMaker(const InspectionStep& inspection)
        : inspection_(inspection),
          inspects_(*inspection.inspects),
          metrics_(inspection.step->metrics) {}

    PageInspection made() {
        PageInspection page;
        page.step = inspection_.step->label;
        page.unit = symbol(metrics_.unit);
        page.tolerance = inspection_.numbers(inspects_.tolerance);
        page.histogram = histogram();
        for (const auto& [name, limits] : inspection_.step->expected) page.expected.push_back(limit(name, limits));
        for (const std::string& name : inspects_.numbers)
            page.columns.push_back({name, inspection_.filter->metric(name)->help});
        for (std::size_t part = 1; has_part(part); ++part) page.rows.push_back(row(part));
        for (std::size_t label = 1; find(inspects_.label[0], label); ++label) page.labels.push_back(this->label(label));
        for (const MetricSpec& metric : inspection_.filter->metrics)
            if (!metric.numbered && !is_shown(metric.name))
                if (const Metric* found = metrics_.find(metric.name))
                    page.facts.push_back({metric.name, display(*found, metrics_.unit), metric.help});
        return page;
    }

private:
    const Metric* find(const std::string& metric, std::size_t number) const {
        return metrics_.find(numbered_name(metric, number));
    }
    std::string text(const std::string& metric, std::size_t number) const {
        const Metric* found = find(metric, number);
        return found ? display(*found, metrics_.unit) : "";
    }

    PageLimit limit(const std::string& name, const std::string& limits) const {
        const StepRecord& step = *inspection_.step;
        const Metric* found = metrics_.find(name);
        const Metric* value = found ? found : step.properties.find(name);
        // The error of the step names every condition that does not hold.
        bool is_met = true;
        for (const char* between : {" in ", " < ", " > ", ": "})
            if (step.failure.error.find("expected " + name + between) != std::string::npos) is_met = false;
        const MetricSpec* spec = inspection_.filter->metric(name);
        return {name, limit_text(limits, spec ? spec->unit : Unit::number),
                value ? display(*value, found ? metrics_.unit : step.properties.unit) : "", is_met};
    }

    bool has_part(std::size_t part) const {
        return std::ranges::any_of(inspects_.numbers, [&](const std::string& name) { return find(name, part); });
    }
    PagePart row(std::size_t part) const {
        PagePart row{part == 1 ? "whole" : fmt::format("{}", part), {}};
        for (const std::string& name : inspects_.numbers) row.texts.push_back(text(name, part));
        return row;
    }

    PageLabel label(std::size_t number) const {
        return {text(inspects_.label[0], number),
                find(inspects_.label[0], number)->value,
                {text(inspects_.label[1], number), text(inspects_.label[2], number), text(inspects_.label[3], number)}};
    }

    std::optional<PageHistogram> histogram() const {
        const auto [low, high] = inspection_.numbers(inspects_.range);
        PageHistogram found{low, high, {}, inspection_.numbers(inspects_.tolerance)};
        for (std::size_t bin = 1; const Metric* share = find(inspects_.histogram, bin); ++bin)
            found.shares.push_back(share->value);
        return found.shares.empty() ? std::nullopt : std::optional(found);
    }

    /// Whether the metric is part of the histogram.
    bool is_shown(const std::string& metric) const {
        return std::ranges::count(inspects_.tolerance, metric) + std::ranges::count(inspects_.range, metric) > 0;
    }

    const InspectionStep& inspection_;
    const InspectSpec& inspects_;
    const Metrics& metrics_;
};

}  // namespace

std::optional<PageInspection> page_inspection(const InspectionStep& inspection) {
    if (!inspection || inspection.step->metrics.values.empty()) return std::nullopt;
    return PageInspectionMaker(inspection).made();
}

}  // namespace scanmill
