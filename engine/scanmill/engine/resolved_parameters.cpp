// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/resolved_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanmill {

namespace {

/// Whether the error is the one that a filter meets when it reads a length of this value.
bool comes_of_reading(const ParameterValue& value, const Error& error) {
    const auto is_refused_alike = [&](const ParameterScalar& item) {
        const auto* length = std::get_if<Length>(&item);
        if (!length) return false;
        try {
            length->value();
        } catch (const Error& own) {
            return own.sentence() == error.sentence();
        }
        return false;
    };
    if (const auto* one = std::get_if<ParameterScalar>(&value)) return is_refused_alike(*one);
    const auto* list = std::get_if<std::vector<ParameterScalar>>(&value);
    return list && std::ranges::any_of(*list, is_refused_alike);
}

}  // namespace

ResolvedParameters resolved_parameters(const PlannedStep& step, const LengthScale& scale) {
    ResolvedParameters result;
    for (const auto& [name, value] : step.parameters.values) {
        try {
            result.values.values.emplace_back(name, resolved(value, scale));
        } catch (Error& error) {
            error.add_frame(fmt::format("in the parameter '{}'", name));
            const ParameterSpec* spec = step.spec.parameter(name);
            if (!spec || spec->default_value != value) throw;
            result.left.push_back({value, error});
            result.values.values.emplace_back(name, value);
        }
    }
    return result;
}

Outputs with_reasons(const std::vector<UnresolvedDefault>& left, const std::function<Outputs()>& run) {
    try {
        return run();
    } catch (const Error& error) {
        for (const UnresolvedDefault& unresolved : left)
            if (comes_of_reading(unresolved.value, error)) throw unresolved.reason;
        throw;
    }
}

}  // namespace scanmill
