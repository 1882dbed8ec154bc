// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/cache/step_result.hpp"

#include <algorithm>

#include "scanmill/kinds/document.hpp"

namespace scanmill {

static constexpr std::string_view subject = "the cached result of a step";

const ResultOutput* StepResult::output(std::string_view port) const {
    const auto found = std::ranges::find(outputs, port, &ResultOutput::port);
    return found == outputs.end() ? nullptr : &*found;
}

std::string to_bytes(const StepResult& result) { return cbor_of(json_of(result)); }

StepResult step_result_from(std::string_view bytes) {
    return from_json<StepResult>(json_from_cbor(bytes, subject), subject);
}

}  // namespace scanmill
