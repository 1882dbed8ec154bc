// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/batch/batch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/base/hash.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/batch/scans.hpp"
#include "scanmill/filter/parameter.hpp"
#include "scanmill/io/mapped_file.hpp"
#include "scanmill/workflow/grammar.hpp"
#include "scanmill/workflow/sizes.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

constexpr const char* batch_forms = "a batch: a map that begins with `scanmill: 1` and `batch: NAME`";

template <class Value>
struct Cap {
    std::string_view expected, smallest, largest;
    Value (*parse)(std::string_view);
};
constexpr Cap<u64> size_cap{"a size, as 8 GiB", "64 MiB", "1024 TiB", parse_byte_size};
constexpr Cap<double> time_cap{"a time, as 10 min", "1 ms", "10000 h", parse_duration};

class BatchParser {
public:
    explicit BatchParser(Diagnostics& diagnostics)
        : diagnostics_(diagnostics),
          folder_(fs::path(diagnostics.file()).parent_path()) {}

    Batch batch(const YamlNode& root) {
        Batch batch;
        batch.file = diagnostics_.file();
        if (root.is_null()) {
            if (!diagnostics_.has_errors()) diagnostics_.error({}, "is empty; expected {}", batch_forms);
            return batch;
        }
        if (!require_map(root, batch_forms, diagnostics_)) return batch;
        const auto scans = [&](const YamlEntry& entry) {
            batch.scans = parse_scans(entry.value, folder_, diagnostics_);
        };
        const auto workflows = [&](const YamlEntry& entry) { add_workflows(entry.value, batch); };
        const auto set = [&](const YamlEntry& entry) { batch.settings = parse_settings(entry.value, diagnostics_); };
        const auto limits = [&](const YamlEntry& entry) { batch.limits = parse_limits(entry.value); };
        const auto reserved = [&](const YamlEntry& entry) {
            diagnostics_.error(entry.position,
                               "`{}` has no effect in this version: batches neither measure results nor "
                               "compare them with earlier runs; remove it, or use the filter measure in the "
                               "workflow",
                               entry.key);
        };
        read_mapping(root, "a batch",
                     {grammar_version_key(diagnostics_),
                      {"batch", name_into(batch.name, "a batch", diagnostics_), "has no name; expected `batch: NAME`"},
                      {"summary", text_into(batch.summary, diagnostics_)},
                      {"scans", scans, "has no scans; expected `scans:` with a list of paths"},
                      {"workflows", workflows, "has no workflows; expected `workflows:` with a list of files"},
                      {"set", set},
                      {"limits", limits},
                      {"measure", reserved},
                      {"gate", reserved}},
                     diagnostics_);
        return batch;
    }

private:
    Limits parse_limits(const YamlNode& node) {
        Limits limits;
        if (node.is_null() || !require_map(node, "a map of limits, as {memory: 8 GiB, time: 10 min}", diagnostics_))
            return limits;
        const auto step = [&](const YamlEntry& entry) {
            if (require_map(entry.value, "the limits of one step, as {memory: 4 GiB, time: 2 min}", diagnostics_))
                read_mapping(entry.value, "the limits of a step",
                             {{"memory", cap_into(limits.step_memory, size_cap)},
                              {"time", cap_into(limits.step_seconds, time_cap)}},
                             diagnostics_);
        };
        const auto retries = [&](const YamlEntry& entry) {
            ParameterSpec spec;
            spec.type = ParameterType::integer;
            spec.low = Bound{0, true};
            spec.high = Bound{most_retries, true};
            read_value(entry, expectation(spec), [&](const std::string& text) {
                const auto value = std::get<ParameterScalar>(parse(spec, {{text}, false}));
                limits.retries = static_cast<unsigned>(std::get<std::int64_t>(value));
            });
        };
        read_mapping(node, "limits",
                     {{"memory", cap_into(limits.cell_memory, size_cap)},
                      {"time", cap_into(limits.cell_seconds, time_cap)},
                      {"step", step},
                      {"retries", retries}},
                     diagnostics_);
        return limits;
    }

    /// Passes the text to `read`, whose Errors are reported at the value.
    template <class Read>
    void read_value(const YamlEntry& entry, std::string_view expected, const Read& read) {
        try {
            if (const auto text = require_text(entry.value, expected, diagnostics_)) read(*text);
        } catch (const Error& error) {
            diagnostics_.error(entry.value.position, "{}: {}", entry.key, error.sentence());
        }
    }

    template <class Value>
    ReadEntry cap_into(Value& target, const Cap<Value>& form) {
        return [&](const YamlEntry& entry) {
            read_value(entry, form.expected, [&](const std::string& text) {
                double bare = 0;
                if (parse_number(text, bare)) throw Error("'{}' has no unit; expected {}", text, form.expected);
                target = form.parse(text);
                if (target < form.parse(form.smallest) || target > form.parse(form.largest))
                    throw Error("{} is out of range; expected {} to {}", text, form.smallest, form.largest);
            });
        };
    }

    void add_workflows(const YamlNode& node, Batch& batch) {
        if (node.is_scalar()) {
            add_workflow(node, batch);
            return;
        }
        if (!require_list(node, "a list of workflow files, as [compare.yaml]", diagnostics_)) return;
        if (node.items.empty()) diagnostics_.error(node.position, "the list of workflows is empty");
        for (const YamlNode& item : node.items) add_workflow(item, batch);
    }

    void add_workflow(const YamlNode& node, Batch& batch) {
        const auto text = require_text(node, "a workflow file, as compare.yaml", diagnostics_);
        if (!text) return;
        const fs::path file = folder_ / *text;
        std::error_code ignored;
        if (fs::is_directory(file, ignored) || text->empty()) {
            diagnostics_.error(node.position, "'{}' is a folder; expected a workflow file", file.string());
            return;
        }
        if (const std::optional<Error> other = why_no_file(file)) {
            diagnostics_.error(node.position,
                               "{}; expected a workflow, by a path that counts from the "
                               "batch's own folder",
                               other->sentence());
            return;
        }
        const auto [earlier, is_new] = line_of_.emplace(fs::absolute(file).lexically_normal(), node.position.line);
        if (is_new)
            batch.workflows.push_back({file, node.position});
        else
            diagnostics_.error(node.position,
                               "the workflow '{}' is repeated; it is already "
                               "at line {}",
                               *text, earlier->second);
    }

    Diagnostics& diagnostics_;
    fs::path folder_;
    std::map<fs::path, int> line_of_;
};

/// Equal for equal values, whatever their positions.
std::string key_of(const Settings& settings) {
    KeyBuilder key;
    for (const auto& [name, value] : settings) {
        key.field("name", name).field("values", std::to_string(value.values.size()));
        for (const WrittenValue& written : value.values) {
            key.field("items", std::to_string(written.literal.items.size()))
                .field("list", written.literal.list ? "1" : "0");
            for (const std::string& item : written.literal.items) key.field("item", item);
        }
    }
    return key.key();
}

/// The batch's values, overridden by the scan's, for the names that the workflow declares.
Settings settings_for(const Workflow& workflow, const Settings& of_batch, const Settings& of_scan) {
    Settings settings = of_scan;
    settings.insert(of_batch.begin(), of_batch.end());
    for (const std::string& name : undeclared(settings, workflow)) settings.erase(name);
    return settings;
}

class BatchPlanner {
public:
    BatchPlanner(const std::string& text, const std::string& file, const FilterLibrary& library)
        : library_(library),
          batch_diagnostics_(file) {
        checked_.batch = parse_batch(text, batch_diagnostics_);
    }

    CheckedBatch checked() {
        for (std::size_t i = 0; i < checked_.batch.workflows.size(); ++i) plan_workflow(i);
        if (!unreadable_) {
            report_undeclared(checked_.batch.settings);
            for (const BatchScan& scan : checked_.batch.scans) report_undeclared(scan.settings);
            report_idle_rules();
        }
        constexpr std::size_t most_cells = 100'000;
        if (const std::size_t cells = checked_.cells(); cells > most_cells)
            batch_diagnostics_.error({},
                                     "has {} cells (scans times variants); expected at most {}: make "
                                     "several batches of it",
                                     cells, most_cells);
        checked_.diagnostics.insert(checked_.diagnostics.begin(), std::move(batch_diagnostics_));
        return std::move(checked_);
    }

private:
    void plan_workflow(std::size_t index) {
        const BatchWorkflow& listed = checked_.batch.workflows[index];
        std::string text;
        try {
            text = read_workflow_file(listed.file);
        } catch (const Error& error) {
            batch_diagnostics_.error(listed.position, error.sentence());
            unreadable_ = true;
            return;
        }
        if (is_batch(text)) {
            batch_diagnostics_.error(listed.position, "'{}' is a batch; expected a workflow", listed.file.string());
            unreadable_ = true;
            return;
        }
        Diagnostics diagnostics(listed.file.string());
        const Workflow workflow = parse_workflow(text, diagnostics);
        if (workflow.steps.empty()) unreadable_ = true;  // nor could its parameters
        require_one_input(workflow, listed);
        if (!workflow.inputs.empty()) takes_points_ |= workflow.inputs.front().kind == kind_of<PointCloud>();
        for (const WorkflowParameter& parameter : workflow.parameters) declared_.insert(parameter.name);
        add_parts(workflow, index, diagnostics);
        checked_.diagnostics.push_back(std::move(diagnostics));
    }

    void add_parts(const Workflow& workflow, std::size_t index, Diagnostics& diagnostics) {
        const Batch& batch = checked_.batch;
        std::map<std::string, std::size_t> part_of_settings;
        for (std::size_t scan = 0; scan < batch.scans.size(); ++scan) {
            const Settings settings = settings_for(workflow, batch.settings, batch.scans[scan].settings);
            const auto [part, is_new] = part_of_settings.emplace(key_of(settings), checked_.parts.size());
            if (is_new) checked_.parts.push_back({plan(workflow, settings, diagnostics), index, {}});
            checked_.parts[part->second].scans.push_back(scan);
        }
        if (batch.scans.empty())  // errors in the workflow are still found
            plan(workflow, settings_for(workflow, batch.settings, {}), diagnostics);
    }

    std::shared_ptr<const Plan> plan(const Workflow& workflow, const Settings& settings, Diagnostics& diagnostics) {
        return std::make_shared<const Plan>(make_plan(workflow, library_, settings, diagnostics, &batch_diagnostics_));
    }

    void require_one_input(const Workflow& workflow, const BatchWorkflow& listed) {
        const std::string name = listed.file.string();
        if (workflow.inputs.empty())
            batch_diagnostics_.error(listed.position,
                                     "'{}' has no inputs, so a batch cannot run it over scans; "
                                     "run it by itself",
                                     name);
        if (workflow.inputs.size() <= 1) return;
        batch_diagnostics_.error(
            listed.position,
            "'{}' has {} inputs, and a batch can only feed the first, '{}'; run it by itself over the "
            "scans, with a file for '{}'",
            name, workflow.inputs.size(), workflow.inputs[0].name, workflow.inputs[1].name);
    }

    void report_undeclared(const Settings& settings) {
        const std::vector<std::string> names(declared_.begin(), declared_.end());
        for (const auto& [name, value] : settings)
            if (!declared_.contains(name))
                batch_diagnostics_.error(value.position, "none of the workflows has a parameter '{}'; {}{}", name,
                                         names.empty() ? "they declare none" : "they have " + enumerated(names),
                                         did_you_mean(name, names));
    }

    /// A rule for invalid rows has no effect if no workflow takes points. Scans of one entry have one position.
    void report_idle_rules() {
        if (takes_points_) return;
        std::set<std::pair<int, int>> reported;
        for (const BatchScan& scan : checked_.batch.scans)
            if (const Position at = scan.invalid_position;
                scan.invalid != InvalidRows::by_format && reported.emplace(at.line, at.column).second)
                batch_diagnostics_.error(at, "`invalid` is for points; no workflow of the batch takes points");
    }

    const FilterLibrary& library_;
    Diagnostics batch_diagnostics_;
    CheckedBatch checked_;
    std::set<std::string> declared_;
    bool takes_points_ = false;
    bool unreadable_ = false;  // a workflow cannot be read, so its parameters are unknown
};

}  // namespace

Batch parse_batch(const std::string& text, Diagnostics& diagnostics) {
    const YamlNode root = parse_yaml(text, diagnostics);
    return BatchParser(diagnostics).batch(root);
}

bool is_batch(const std::string& text) {
    if (text.find("batch") == std::string::npos) return false;  // most texts are workflows, and some are long
    Diagnostics ignored("");
    return parse_yaml(text, ignored).find("batch") != nullptr;
}

bool CheckedBatch::has_errors() const { return std::ranges::any_of(diagnostics, &Diagnostics::has_errors); }

std::size_t CheckedBatch::variants() const {
    std::set<std::pair<std::size_t, std::string>> names;
    for (const BatchPart& part : parts)
        for (const PlannedVariant& variant : part.plan->variants) names.emplace(part.workflow, variant.name);
    return names.size();
}

std::size_t CheckedBatch::cells() const {
    std::size_t count = 0;
    for (const BatchPart& part : parts) count += part.plan->variants.size() * part.scans.size();
    return count;
}

CheckedBatch check_batch(const std::string& text, const std::string& file, const FilterLibrary& library) {
    return BatchPlanner(text, file, library).checked();
}

}  // namespace scanmill
