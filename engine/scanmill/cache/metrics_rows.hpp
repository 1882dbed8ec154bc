// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Metrics as rows of name, number and unit: how they are kept and sent. Every number keeps its bits.

#include <nlohmann/json.hpp>

#include "scanmill/data/metrics.hpp"

namespace scanmill {

inline nlohmann::json rows_of(const Metrics& metrics) {
    nlohmann::json rows = nlohmann::json::array();
    for (const Metric& metric : metrics.values)
        rows.push_back({metric.name, metric.value, static_cast<int>(metric.unit)});
    return rows;
}

/// Throws nlohmann::json::exception for what is none.
inline Metrics metrics_from(const nlohmann::json& rows) {
    Metrics metrics;
    for (const nlohmann::json& row : rows)
        metrics.values.push_back(
            {row.at(0).get<std::string>(), row.at(1).get<double>(), static_cast<Unit>(row.at(2).get<int>())});
    return metrics;
}

}  // namespace scanmill
