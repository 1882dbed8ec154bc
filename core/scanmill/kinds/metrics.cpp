// SPDX-License-Identifier: GPL-3.0-or-later
/// The kind `metrics`. Its JSON form:
///
///     {"scanmill": 1, "unit": "mm", "metrics": {"hausdorff": 0.12, "closed": true, …},
///      "units": {"hausdorff": "length", …}}
///
/// `unit` is the unit of lengths; areas and volumes are in its powers; null if unknown. Angles are in radians, ratios
/// plain fractions; booleans are true and false; a value that is not finite is null and is read as NaN.
#include "scanmill/data/metrics.hpp"

#include <cmath>
#include <limits>
#include <tuple>

#include "scanmill/base/error.hpp"
#include "scanmill/kinds/document.hpp"
#include "scanmill/kinds/kind_traits.hpp"

namespace scanmill {

template <>
struct KindTraits<Metrics> : NotGeometric<Metrics>, NoProperties<Metrics> {
    static constexpr std::string_view name = "metrics";
    static void visit(FieldVisitor& visitor, Metrics& metrics) {
        std::vector<std::tuple<std::string, double, int>> rows;
        for (const auto& [name, value, unit] : metrics.values) rows.emplace_back(name, value, static_cast<int>(unit));
        visitor.small("values", rows);
        metrics.values.clear();
        for (const auto& [name, value, unit] : rows) metrics.values.push_back({name, value, static_cast<Unit>(unit)});
        visitor.small("unit", metrics.unit);
    }
    static constexpr std::string_view json_member = "metrics";
    static void to_json(const Metrics& metrics, Json& document) {
        document = {{"scanmill", 1},
                    {"unit", unit_json(metrics.unit)},
                    {"metrics", metrics_json(metrics)},
                    {"units", Json::object()}};
        for (const Metric& metric : metrics.values) document["units"][metric.name] = name_of(metric.unit);
    }
    static Metrics from_json(const Json& document, const OnWarning&) {
        require_document(document, {"scanmill", "unit", "metrics", "units"});
        const Json& values = member(document, "metrics");
        const Json& units = member(document, "units");
        if (!values.is_object() || !units.is_object())
            throw Error("'metrics' and 'units' are objects; expected a value and a unit for every metric");
        require_keys(units, "'units'", [&] {
            std::vector<std::string> names;
            for (const auto& [name, value] : values.items()) names.push_back(name);
            return names;
        }());
        Metrics metrics;
        metrics.unit = unit_member(document);
        for (const auto& [name, value] : values.items()) {
            const std::string unit_text = text_member(units, name, "'units'");
            const std::optional<Unit> unit = value_named<Unit>(unit_text);
            if (!unit) throw Error("the metric '{}' has the unknown unit '{}'", name, unit_text);
            if (!value.is_number() && !value.is_boolean() && !value.is_null())
                throw Error("the metric '{}' is not a number, true, false or null", name);
            metrics.set(name,
                        value.is_null()      ? std::numeric_limits<double>::quiet_NaN()
                        : value.is_boolean() ? (value.get<bool>() ? 1.0 : 0.0)
                                             : value.get<double>(),
                        *unit);
        }
        return metrics;
    }
};

template Kind kind_of<Metrics>();

}  // namespace scanmill
