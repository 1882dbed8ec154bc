// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "scanmill/base/error.hpp"
#include "scanmill/batch/batch.hpp"
#include "scanmill/batch/parse_limits.hpp"
#include "scanmill/batch/parse_scans.hpp"
#include "scanmill/batch/parse_settings.hpp"
#include "scanmill/filter/constraint.hpp"
#include "scanmill/io/regular_file.hpp"
#include "scanmill/workflow/grammar.hpp"
#include "scanmill/workflow/parse_value.hpp"
#include "scanmill/workflow/sizes.hpp"

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

Settings parse_settings(const YamlNode& node, Diagnostics& diagnostics) {
    Settings settings;
    if (!require_map(node, "a map of parameters, as {max-error: 0.1 %diag}", diagnostics)) return settings;
    for (const YamlEntry& entry : node.entries) {
        if (!require_name(entry.key, entry.position, "a parameter", diagnostics)) continue;
        ValueExpression value = value_expression(entry.value, diagnostics);
        std::erase_if(value.values, [&](const WrittenValue& written) {
            if (!written.uses.empty())
                diagnostics.error(written.uses.front().position,
                                  "a setting cannot refer to a parameter; write the value");
            return !written.uses.empty();
        });
        if (value.values.empty()) continue;  // and that is reported
        value.position = entry.position;
        settings.emplace(entry.key, std::move(value));
    }
    return settings;
}

namespace {

namespace fs = std::filesystem;

constexpr const char* batch_forms = "a batch: a map that begins with `scanmill: 1` and `batch: NAME`";

class BatchParser {
public:
    BatchParser(const FilterLibrary& library, Diagnostics& diagnostics)
        : library_(library),
          diagnostics_(diagnostics),
          folder_(fs::path(diagnostics.file()).parent_path()) {}

    Batch batch(const YamlNode& root) {
        Batch batch;
        batch.file = diagnostics_.file();
        if (root.is_null()) {
            if (!diagnostics_.has_errors()) diagnostics_.error({}, fmt::format("is empty; expected {}", batch_forms));
            return batch;
        }
        if (!require_map(root, batch_forms, diagnostics_)) return batch;
        MapReader keys(root, "a batch", diagnostics_);
        require_grammar_version(keys, diagnostics_);
        name(keys, root, batch);
        batch.summary = keys.text("summary");
        if (const YamlEntry* entry = keys.find("scans"))
            batch.scans = parse_scans(entry->value, folder_, diagnostics_);
        else
            diagnostics_.error(root.position, "has no scans; expected `scans:` with a list of paths");
        if (const YamlEntry* entry = keys.find("workflows"))
            workflows(entry->value, batch);
        else
            diagnostics_.error(root.position, "has no workflows; expected `workflows:` with a list of files");
        if (const YamlEntry* entry = given(keys.find("set")))
            batch.settings = parse_settings(entry->value, diagnostics_);
        if (const YamlEntry* entry = given(keys.find("limits")))
            batch.limits = parse_limits(entry->value, diagnostics_);
        if (const YamlEntry* entry = given(keys.find("measure")))
            batch.measure = parse_measure(entry->value, diagnostics_);
        if (const YamlEntry* entry = given(keys.find("gate")))
            batch.gate = parse_gate(entry->value, library_, diagnostics_);
        keys.complain_of_others();
        return batch;
    }

private:
    /// A section without content says nothing.
    static const YamlEntry* given(const YamlEntry* entry) { return entry && !entry->value.is_null() ? entry : nullptr; }

    void name(MapReader& keys, const YamlNode& root, Batch& batch) {
        const YamlEntry* entry = keys.find("batch");
        if (!entry) {
            diagnostics_.error(root.position, "has no name; expected `batch: NAME`");
            return;
        }
        const auto text = require_text(entry->value, "the batch's name", diagnostics_);
        if (text && require_name(*text, entry->value.position, "a batch", diagnostics_)) batch.name = *text;
    }

    void workflows(const YamlNode& node, Batch& batch) {
        if (node.is_scalar()) {
            workflow(node, batch);
            return;
        }
        if (!require_list(node, "a list of workflow files, as [compare.yaml]", diagnostics_)) return;
        if (node.items.empty()) diagnostics_.error(node.position, "the list of workflows is empty");
        for (const YamlNode& item : node.items) workflow(item, batch);
    }

    void workflow(const YamlNode& node, Batch& batch) {
        const auto text = require_text(node, "a workflow file, as compare.yaml", diagnostics_);
        if (!text) return;
        const fs::path file = folder_ / *text;
        std::error_code ignored;
        if (fs::is_directory(file, ignored) || text->empty()) {
            diagnostics_.error(node.position, fmt::format("'{}' is a folder; expected a workflow file", file.string()));
            return;
        }
        if (const std::optional<Error> other = why_no_file(file)) {
            diagnostics_.error(node.position, fmt::format("{}; expected a workflow, by a path that counts from the "
                                                          "batch's own folder",
                                                          other->sentence()));
            return;
        }
        const auto [earlier, is_new] = line_of_.emplace(fs::absolute(file).lexically_normal(), node.position.line);
        if (is_new)
            batch.workflows.push_back({file, node.position});
        else
            diagnostics_.error(node.position, fmt::format("the workflow '{}' stands here a second time; it is already "
                                                          "at line {}",
                                                          *text, earlier->second));
    }

    const FilterLibrary& library_;
    Diagnostics& diagnostics_;
    fs::path folder_;
    std::map<fs::path, int> line_of_;
};

}  // namespace

Batch parse_batch(const std::string& text, const FilterLibrary& library, Diagnostics& diagnostics) {
    const YamlNode root = parse_yaml(text, diagnostics);
    return BatchParser(library, diagnostics).batch(root);
}

bool is_batch(const std::string& text) {
    if (text.find("batch") == std::string::npos) return false;  // most texts are workflows, and some are long
    Diagnostics unheard("");
    return parse_yaml(text, unheard).find("batch") != nullptr;
}

}  // namespace scanmill
