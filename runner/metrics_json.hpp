// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Metrics in the JSON that commands print.

#include <nlohmann/json.hpp>

#include "scanmill/data/metrics.hpp"

namespace scanmill::runner {

using Json = nlohmann::ordered_json;

/// An object of numbers, yes and no.
inline Json metrics_json(const Metrics& metrics) {
    Json json = Json::object();
    for (const Metric& metric : metrics.values)
        json[metric.name] = metric.unit == Unit::boolean ? Json(metric.value != 0) : Json(metric.value);
    return json;
}

}  // namespace scanmill::runner
