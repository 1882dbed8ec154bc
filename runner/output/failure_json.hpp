// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Failures in the JSON that commands print.

#include <nlohmann/json.hpp>

#include "output/error_output.hpp"
#include "scanmill/worker/report.hpp"

namespace scanmill::runner {

using Json = nlohmann::ordered_json;

/// Adds `error`, `cause` and, where there is one, `signal` or `exit-code` to an object.
inline void add_failure(Json& entry, const Failure& failure) {
    entry["error"] = with_option(failure.whole()).what();
    entry["cause"] = name_of(failure.cause);
    if (failure.cause == Cause::signal) entry["signal"] = failure.number;
    if (failure.cause == Cause::exit) entry["exit-code"] = failure.number;
}

}  // namespace scanmill::runner
