// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/cache/step_result.hpp"

#include <algorithm>

#include "scanmill/base/error.hpp"

namespace scanmill {

using nlohmann::json;

void from_json(const json& value, Kind& kind) {
    const auto name = value.get<std::string>();
    const std::optional<Kind> found = kind_named(name);
    if (!found) throw Error("unknown kind {}", name);
    kind = *found;
}

const ResultOutput* StepResult::output(std::string_view port) const {
    const auto found = std::ranges::find(outputs, port, &ResultOutput::port);
    return found == outputs.end() ? nullptr : &*found;
}

std::string to_bytes(const json& value) {
    std::string bytes;
    json::to_cbor(value, bytes);
    return bytes;
}

StepResult step_result_from(std::string_view bytes) try {
    return json::from_cbor(bytes).get<StepResult>();
} catch (const json::exception&) {
    throw Error("the cached result of a step is not one that Scanmill writes");
}

}  // namespace scanmill
