// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The result of a step as the cache stores it, in CBOR.

#include <string>
#include <string_view>
#include <vector>

#include "scanmill/data/metrics.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/filter/parameter.hpp"
#include "scanmill/kinds/value.hpp"
#include "scanmill/record/fields.hpp"

namespace scanmill {

struct ResultOutput {
    std::string port;
    Kind kind = kind_of<PointCloud>();
    std::string content;  ///< EncodedValue::content()
    u64 bytes = 0;        ///< size of the value file

    bool operator==(const ResultOutput&) const = default;
};
constexpr auto fields(const ResultOutput*) {
    using R = ResultOutput;
    return std::tuple{field("port", &R::port), field("kind", &R::kind), field("content", &R::content),
                      field("bytes", &R::bytes)};
}

/// The result of a step, without its values. The content hash of a value names its file in the cache.
struct StepResult {
    std::vector<ResultOutput> outputs;
    ParameterSet resolved;  ///< lengths in the scan's unit; without parameters that name files
    Metrics metrics;
    Metrics properties;  ///< properties of the primary output; empty unless requested
    std::vector<std::string> warnings;
    std::vector<Doubt> doubts;
    double seconds = 0;  ///< run time of the filter
    std::string filter{};  ///< for reports about the cache; empty: a scan was read
    std::string workflow{};  ///< name of the workflow that stored the result, for the same reports; empty: unknown

    const ResultOutput* output(std::string_view port) const;
};
constexpr auto fields(const StepResult*) {
    using R = StepResult;
    return std::tuple{field("outputs", &R::outputs),
                      field("resolved", &R::resolved),
                      field("metrics", &R::metrics),
                      field("properties", &R::properties),
                      field("warnings", &R::warnings),
                      field("doubts", &R::doubts),
                      field("seconds", &R::seconds),
                      field("filter", &R::filter).optional(),
                      field("workflow", &R::workflow).optional()};
}

std::string to_bytes(const StepResult& result);
/// Throws Error for bytes that are not a serialised StepResult.
StepResult step_result_from(std::string_view bytes);

}  // namespace scanmill
