// SPDX-License-Identifier: GPL-3.0-or-later
/// The kind `metrics`. Its JSON form:
///
///     {"scanmill": 1, "unit": "mm", "metrics": {"hausdorff": 0.12, "closed": true, …},
///      "units": {"hausdorff": "length", …}}
///
/// `unit` is the unit of lengths, or null if unknown; areas and volumes are in its powers. Angles are in radians.
/// Ratios are plain fractions. Booleans are true or false. A value that is not finite is null and is read as NaN.
#include "scanmill/data/metrics.hpp"

#include <algorithm>

#include "scanmill/base/error.hpp"
#include "scanmill/kinds/document.hpp"

namespace scanmill {

namespace {

struct MetricsDocument {
    LengthUnit unit = LengthUnit::unknown;
    Metrics metrics;
    std::vector<std::pair<std::string, Unit>> units;
};
constexpr auto fields(const MetricsDocument*) {
    using T = MetricsDocument;
    return std::tuple{field("unit", &T::unit).nullable(), field("metrics", &T::metrics).by_name(),
                      field("units", &T::units, "The unit of each metric.")};
}

}  // namespace

template <>
struct KindTraits<Metrics> : NotGeometric<Metrics>, NoProperties<Metrics>, HasDocument<Metrics, MetricsDocument> {
    static constexpr std::string_view name = "metrics";
    static constexpr std::string_view json_member = "metrics";
    static MetricsDocument document(const Metrics& metrics) {
        MetricsDocument document{metrics.unit, metrics, {}};
        for (const Metric& metric : metrics.values) document.units.emplace_back(metric.name, metric.unit);
        return document;
    }
    static Metrics object(MetricsDocument document) {
        Metrics metrics = std::move(document.metrics);
        metrics.unit = document.unit;
        for (const auto& [name, unit] : document.units)
            if (!metrics.find(name)) throw Error("the document: 'units.{}' is the unit of no metric", name);
        for (Metric& metric : metrics.values) {
            const auto found = std::ranges::find(document.units, metric.name, &std::pair<std::string, Unit>::first);
            if (found == document.units.end()) throw Error("the document: 'units.{}' is missing", metric.name);
            metric.unit = found->second;
        }
        return metrics;
    }
};

template Kind kind_of<Metrics>();

}  // namespace scanmill
