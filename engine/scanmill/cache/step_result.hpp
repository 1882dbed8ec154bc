// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What is remembered of a step that was run: everything but the values themselves, which are named by their content.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scanmill/data/value.hpp"
#include "scanmill/filter/parameter.hpp"

namespace scanmill {

struct ResultOutput {
    std::string port;
    Kind kind = Kind::points;
    std::string content;  ///< EncodedValue::content()
    u64 bytes = 0;  ///< of its value file

    bool operator==(const ResultOutput&) const = default;
};

struct StepResult {
    std::vector<ResultOutput> outputs;
    /// Parameters as the filter got them, lengths in the scan's unit.
    std::vector<std::pair<std::string, WrittenParameter>> resolved;
    Metrics metrics;
    Metrics facts;  ///< of the primary output; empty when nobody asked for them
    std::vector<std::string> warnings;
    double seconds = 0;  ///< that the filter took

    const ResultOutput* output(std::string_view port) const;
};

/// CBOR; every number keeps its bits.
std::string to_bytes(const StepResult& result);
/// Throws Error for bytes that are none.
StepResult step_result_from(std::string_view bytes);

}  // namespace scanmill
