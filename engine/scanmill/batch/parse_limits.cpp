// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/batch/parse_limits.hpp"

#include <fmt/format.h>

#include "scanmill/engine/byte_size.hpp"
#include "scanmill/engine/duration.hpp"
#include "scanmill/engine/grammar.hpp"
#include "scanmill/filter/constraint.hpp"
#include "scanmill/filter/error.hpp"

namespace scanmill {

namespace {

template <class Value>
struct Cap {
    std::string_view expected, smallest, largest;
    Value (*parse)(std::string_view);
};
constexpr Cap<u64> size_cap{"a size, as 8 GiB", "64 MiB", "1024 TiB", parse_byte_size};
constexpr Cap<double> time_cap{"a time, as 10 min", "1 ms", "10000 h", parse_duration};

/// 0 when there is none, or after reporting.
template <class Value>
Value cap(const YamlEntry* entry, const Cap<Value>& form, Diagnostics& diagnostics) {
    if (!entry) return 0;
    const auto text = require_text(entry->value, form.expected, diagnostics);
    if (!text) return 0;
    const Position place = entry->value.position;
    double bare = 0;
    if (parse_number(*text, bare)) {
        diagnostics.error(place, fmt::format("{}: '{}' has no unit; expected {}", entry->key, *text, form.expected));
        return 0;
    }
    try {
        const Value value = form.parse(*text);
        if (value < form.parse(form.smallest) || value > form.parse(form.largest))
            diagnostics.error(place, fmt::format("{}: {} is out of range; expected {} to {}", entry->key, *text,
                                                 form.smallest, form.largest));
        return value;
    } catch (const Error& error) {
        diagnostics.error(place, fmt::format("{}: {}", entry->key, error.sentence()));
        return 0;
    }
}

/// The value of a filter's parameter that is so called; nothing after reporting what it cannot take.
std::optional<ParameterValue> value(const YamlEntry& entry, const ParameterSpec& spec, Diagnostics& diagnostics) {
    WrittenParameter written;
    written.list = entry.value.is_sequence();
    if (written.list) {
        for (const YamlNode& item : entry.value.items) {
            const auto text = require_text(item, "a value", diagnostics);
            if (!text) return std::nullopt;
            written.items.push_back(*text);
        }
    } else if (const auto text = require_text(entry.value, expectation(spec), diagnostics)) {
        written.items.push_back(*text);
    } else {
        return std::nullopt;
    }
    try {
        return parse(spec, written);
    } catch (const Error& error) {
        diagnostics.error(entry.value.position, fmt::format("{}: {}", entry.key, error.sentence()));
        return std::nullopt;
    }
}

ParameterSpec spec_of(ParameterType type, std::optional<Bound> low, std::optional<Bound> high, bool is_list = false) {
    ParameterSpec spec;
    spec.type = type;
    spec.low = low;
    spec.high = high;
    spec.list = is_list;
    return spec;
}

template <class T>
std::optional<T> scalar(const YamlEntry* entry, const ParameterSpec& spec, Diagnostics& diagnostics) {
    if (!entry) return std::nullopt;
    const auto parsed = value(*entry, spec, diagnostics);
    if (!parsed) return std::nullopt;
    return std::get<T>(std::get<ParameterScalar>(*parsed));
}

}  // namespace

Limits parse_limits(const YamlNode& node, Diagnostics& diagnostics) {
    Limits limits;
    if (!require_map(node, "a map of limits, as {memory: 8 GiB, time: 10 min}", diagnostics)) return limits;
    MapReader keys(node, "limits", diagnostics);
    limits.cell_memory = cap(keys.find("memory"), size_cap, diagnostics);
    limits.cell_seconds = cap(keys.find("time"), time_cap, diagnostics);
    if (const YamlEntry* step = keys.find("step");
        step && require_map(step->value, "the limits of one step, as {memory: 4 GiB, time: 2 min}", diagnostics)) {
        MapReader of_step(step->value, "the limits of a step", diagnostics);
        limits.step_memory = cap(of_step.find("memory"), size_cap, diagnostics);
        limits.step_seconds = cap(of_step.find("time"), time_cap, diagnostics);
        of_step.complain_of_others();
    }
    const ParameterSpec retries = spec_of(ParameterType::integer, Bound{0, true}, Bound{most_retries, true});
    limits.retries =
        static_cast<unsigned>(scalar<std::int64_t>(keys.find("retries"), retries, diagnostics).value_or(0));
    keys.complain_of_others();
    return limits;
}

MeasureOptions parse_measure(const YamlNode& node, Diagnostics& diagnostics) {
    MeasureOptions options;
    if (!require_map(node, "how results are measured, as {samples: 100000, thresholds: [0.5 %diag]}", diagnostics))
        return options;
    MapReader keys(node, "measure", diagnostics);
    const ParameterSpec samples = spec_of(ParameterType::integer, Bound{1, true}, Bound{most_samples, true});
    options.samples = scalar<std::int64_t>(keys.find("samples"), samples, diagnostics);
    if (const YamlEntry* entry = keys.find("thresholds")) {
        const ParameterSpec thresholds = spec_of(ParameterType::length, Bound{0, false}, std::nullopt, true);
        if (entry->value.is_sequence() && entry->value.items.empty())
            diagnostics.error(entry->value.position, "thresholds: the list is empty; expected lengths, as [0.5 %diag]");
        else if (const auto parsed = value(*entry, thresholds, diagnostics))
            for (const ParameterScalar& item : std::get<std::vector<ParameterScalar>>(*parsed))
                options.thresholds.push_back(std::get<Length>(item));
    }
    options.self_intersections = scalar<bool>(keys.find("self-intersections"),
                                              spec_of(ParameterType::boolean, std::nullopt, std::nullopt), diagnostics);
    keys.complain_of_others();
    return options;
}

}  // namespace scanmill
