// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The kind `metrics`. Its JSON form:
///
///     {"scanmill": 1, "unit": "mm", "metrics": {"hausdorff": 0.12, "closed": true, …},
///      "units": {"hausdorff": "length", …}}
///
/// `unit` is the unit of lengths; areas and volumes are in its powers; null when unknown. Angles are in radians, ratios
/// plain fractions; booleans are true and false; a value that is not finite is null, and reads back as NaN.

#include "scanmill/kinds/kind.hpp"

namespace scanmill {

/// The numbers alone, by name.
nlohmann::ordered_json metrics_json(const Metrics& metrics);

template <>
struct KindTraits<Metrics> : NotGeometric<Metrics> {
    static constexpr std::string_view name = "metrics";
    static void visit(FieldVisitor& visitor, Metrics& metrics);
    static constexpr std::string_view json_member = "metrics";
    static void to_json(const Metrics& metrics, nlohmann::ordered_json& document);
    static Metrics from_json(const nlohmann::ordered_json& document, const OnWarning& warn);
};
inline const KindRegistration<Metrics> metrics_kind;

}  // namespace scanmill
