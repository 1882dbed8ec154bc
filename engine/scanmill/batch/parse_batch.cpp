// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "scanmill/base/error.hpp"
#include "scanmill/batch/batch.hpp"
#include "scanmill/batch/parse_scans.hpp"
#include "scanmill/filter/parameter.hpp"
#include "scanmill/io/mapped_file.hpp"
#include "scanmill/workflow/grammar.hpp"
#include "scanmill/workflow/sizes.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

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

/// 0 when there is none, or after reporting.
unsigned retries(const YamlEntry* entry, Diagnostics& diagnostics) {
    if (!entry) return 0;
    ParameterSpec spec;
    spec.type = ParameterType::integer;
    spec.low = Bound{0, true};
    spec.high = Bound{most_retries, true};
    const auto text = require_text(entry->value, expectation(spec), diagnostics);
    if (!text) return 0;
    try {
        const ParameterValue value = parse(spec, {{*text}, false});
        return static_cast<unsigned>(std::get<std::int64_t>(std::get<ParameterScalar>(value)));
    } catch (const Error& error) {
        diagnostics.error(entry->value.position, fmt::format("retries: {}", error.sentence()));
        return 0;
    }
}

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
    limits.retries = retries(keys.find("retries"), diagnostics);
    keys.complain_of_others();
    return limits;
}

constexpr const char* batch_forms = "a batch: a map that begins with `scanmill: 1` and `batch: NAME`";

class BatchParser {
public:
    explicit BatchParser(Diagnostics& diagnostics)
        : diagnostics_(diagnostics),
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
        for (const char* key : {"measure", "gate"})
            if (const YamlEntry* entry = keys.find(key))
                diagnostics_.error(entry->position, fmt::format("nothing acts on `{}` in this version: batches neither "
                                                                "measure results nor compare them with earlier runs; "
                                                                "remove it, or use the filter measure in the workflow",
                                                                key));
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

    Diagnostics& diagnostics_;
    fs::path folder_;
    std::map<fs::path, int> line_of_;
};

}  // namespace

Batch parse_batch(const std::string& text, Diagnostics& diagnostics) {
    const YamlNode root = parse_yaml(text, diagnostics);
    return BatchParser(diagnostics).batch(root);
}

bool is_batch(const std::string& text) {
    if (text.find("batch") == std::string::npos) return false;  // most texts are workflows, and some are long
    Diagnostics unheard("");
    return parse_yaml(text, unheard).find("batch") != nullptr;
}

}  // namespace scanmill
