// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Metrics as rows of name, number and unit: how they are kept and sent. Every number keeps its bits.

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scanmill/data/metrics.hpp"
#include "scanmill/filter/parameter.hpp"
#include "scanmill/kinds/value.hpp"

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

// What is remembered of a step that was run: everything but the values themselves, which are named by their content.

struct ResultOutput {
    std::string port;
    Kind kind = kind_of<PointCloud>();
    std::string content;  ///< EncodedValue::content()
    u64 bytes = 0;  ///< of its value file

    bool operator==(const ResultOutput&) const = default;
};

struct StepResult {
    std::vector<ResultOutput> outputs;
    /// Parameters as the filter got them, lengths in the scan's unit.
    std::vector<std::pair<std::string, WrittenParameter>> resolved;
    Metrics metrics;
    Metrics properties;  ///< of the primary output; empty when nobody asked for them
    std::vector<std::string> warnings;
    double seconds = 0;  ///< that the filter took

    const ResultOutput* output(std::string_view port) const;
};

/// CBOR; every number keeps its bits.
std::string to_bytes(const StepResult& result);
/// Throws Error for bytes that are none.
StepResult step_result_from(std::string_view bytes);

}  // namespace scanmill
