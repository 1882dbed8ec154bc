// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/batch/batch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/base/hash.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/batch/check_gate.hpp"
#include "scanmill/batch/objects.hpp"
#include "scanmill/batch/scans.hpp"
#include "scanmill/filter/parameter.hpp"
#include "scanmill/formats/common/format.hpp"
#include "scanmill/io/mapped_file.hpp"
#include "scanmill/plan/output_names.hpp"
#include "scanmill/plan/step_parameters.hpp"
#include "scanmill/plan/wiring.hpp"
#include "scanmill/workflow/grammar.hpp"
#include "scanmill/workflow/ready.hpp"
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
            batch.has_scans = true;
            batch.scans = parse_scans(entry.value, folder_, diagnostics_);
        };
        const auto workflows = [&](const YamlEntry& entry) { add_workflows(entry.value, batch); };
        const auto set = [&](const YamlEntry& entry) { batch.settings = parse_settings(entry.value, diagnostics_); };
        const auto limits = [&](const YamlEntry& entry) { batch.limits = parse_limits(entry.value); };
        const auto measure = [&](const YamlEntry& entry) { batch.measure = parse_measure(entry); };
        const auto gate = [&](const YamlEntry& entry) { batch.gate = parse_gate(entry); };
        read_mapping(root, "a batch",
                     {grammar_version_key(diagnostics_),
                      {"batch", name_into(batch.name, "a batch", diagnostics_), "has no name; expected `batch: NAME`"},
                      {"summary", text_into(batch.summary, diagnostics_)},
                      {"scans", scans},
                      {"workflows", workflows, "has no workflows; expected `workflows:` with a list of files"},
                      {"set", set},
                      {"limits", limits},
                      {"measure", measure},
                      {"gate", gate}},
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
            limits.retries = static_cast<unsigned>(whole_number(entry, 0, most_retries).value_or(0));
        };
        read_mapping(node, "limits",
                     {{"memory", cap_into(limits.cell_memory, size_cap)},
                      {"time", cap_into(limits.cell_seconds, time_cap)},
                      {"step", step},
                      {"retries", retries}},
                     diagnostics_);
        return limits;
    }

    BatchMeasure parse_measure(const YamlEntry& entry) {
        BatchMeasure measure;
        measure.position = entry.position;
        const YamlNode& node = entry.value;
        if (node.is_null() || !require_map(node, "a map, as {of: [surface], samples: 50000}, or nothing", diagnostics_))
            return measure;
        for (const YamlEntry& each : node.entries) {
            if (each.key == "of") {
                parse_measured(each.value, measure);
            } else if (each.key == "filter") {
                name_into(measure.filter, "a filter", diagnostics_)(each);
                measure.filter_position = each.value.position;
            } else {
                measure.parameters.push_back({each.key, each.position, measuring_value(each.value)});
            }
        }
        return measure;
    }

    void parse_measured(const YamlNode& node, BatchMeasure& measure) {
        if (node.is_sequence() && node.items.empty())
            diagnostics_.error(node.position, "the list of values to measure is empty");
        for (const YamlNode& item : node.is_sequence() ? std::span(node.items) : std::span(&node, 1))
            if (const auto text = require_text(item, "the name of a step, or a list of them", diagnostics_))
                measure.of.push_back({*text, item.position});
    }

    /// The value of a parameter under `measure`. A sweep is an error, because results that are measured in different
    /// ways cannot be compared.
    ValueExpression measuring_value(const YamlNode& node) {
        ValueExpression value = value_expression(node, diagnostics_);
        refuse_uses(value, "a parameter of `measure`", diagnostics_);
        if (value.sweep) {
            diagnostics_.error(node.position, "a parameter of `measure` has one value; `sweep` is for workflows");
            value.values.clear();
        }
        return value;
    }

    std::optional<Gate> parse_gate(const YamlEntry& entry) {
        Gate gate;
        const YamlNode& node = entry.value;
        if (!require_map(node, "a map from metrics to tolerances, as {hausdorff: +1 %, genus: exact}", diagnostics_))
            return std::nullopt;
        for (const YamlEntry& rule : node.entries) {
            if (rule.key == "repeats")
                parse_repeats(rule, gate);
            else if (const auto text =
                         require_text(rule.value, "a tolerance, as +1 %, -0.01 mm or exact", diagnostics_))
                gate.rules.push_back({rule.key, *text, rule.position});
        }
        if (gate.rules.empty() && !diagnostics_.has_errors())
            diagnostics_.error(entry.position,
                               "the gate has no rules; expected metrics and tolerances, as hausdorff: +1 %");
        return gate;
    }

    void parse_repeats(const YamlEntry& entry, Gate& gate) {
        gate.repeats = static_cast<unsigned>(whole_number(entry, 1, most_repeats).value_or(1));
    }

    /// The whole number, from `low` to `high`. Reports other values and returns nothing.
    std::optional<std::int64_t> whole_number(const YamlEntry& entry, int low, int high) {
        ParameterSpec spec;
        spec.type = ParameterType::integer;
        spec.low = Bound{static_cast<double>(low), true};
        spec.high = Bound{static_cast<double>(high), true};
        std::optional<std::int64_t> number;
        read_value(entry, expectation(spec), [&](const std::string& text) {
            number = std::get<std::int64_t>(std::get<ParameterScalar>(parse(spec, {{text}, false})));
        });
        return number;
    }

    /// Passes the text of a value to `read`. If `read` throws an Error, reports it at the value.
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
        fs::path file = folder_;
        const auto warn = [&](std::string sentence) { diagnostics_.warning(node.position, std::move(sentence)); };
        if (!text->empty()) try {
                file = workflow_file(*text, warn, folder_);
            } catch (const Error& error) {
                diagnostics_.error(node.position, error.sentence());
                return;
            }
        std::error_code ignored;
        if (fs::is_directory(file, ignored) || text->empty()) {
            diagnostics_.error(node.position, "'{}' is a folder; expected a workflow file", file.string());
            return;
        }
        if (const std::optional<Error> other = why_no_file(file)) {
            diagnostics_.error(node.position, "{}; expected a workflow file, by a path relative to the batch's folder",
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

/// A key that is equal for settings with equal names and values. Positions are not part of the key.
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

/// The values of the parameters that the workflow declares. Values of the scan override values of the batch.
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
        const Batch& batch = checked_.batch;
        if (batch.measure) measuring_ = measuring_filter(*batch.measure);
        for (std::size_t i = 0; i < batch.workflows.size(); ++i) plan_workflow(i);
        if (!unreadable_) {
            report_undeclared(batch.settings);
            for (const BatchScan& scan : batch.scans) report_undeclared(scan.settings);
            report_unknown_inputs();
            report_idle_rules();
            report_idle_poses();
        }
        report_idle_truths();
        const bool is_sound = !unreadable_ && std::ranges::none_of(checked_.diagnostics, &Diagnostics::has_errors);
        if (is_sound) report_idle_scans();
        if (is_sound && measuring_) report_unmeasured();
        if (is_sound && batch.gate && !checked_.parts.empty() && batch.measure.has_value() == (measuring_ != nullptr))
            check_gate(batch, checked_.parts, library_, batch_diagnostics_);
        if (refused_.size() > most_refused)
            batch_diagnostics_.warning(
                {}, fmt::format("for {}, the poses are wrong, too",
                                count_text(refused_.size() - most_refused, "more object", "more objects")));
        if (idle_.size() > most_refused)
            batch_diagnostics_.warning(
                {}, fmt::format("for {}, a file of poses is not used, too",
                                count_text(idle_.size() - most_refused, "more object", "more objects")));
        constexpr std::size_t most_cells = 100'000;
        if (const std::size_t cells = checked_.cells(); cells > most_cells)
            batch_diagnostics_.error({}, "has {} cells (scans times variants); expected at most {}: split the batch",
                                     cells, most_cells);
        else if (is_sound && !batch_diagnostics_.has_errors())
            report_shared_files();
        if (measuring_)
            for (BatchScan& scan : checked_.batch.scans)
                if (!scan.truth.files.empty()) scan.inputs.emplace(truth_input, scan.truth);
        checked_.diagnostics.insert(checked_.diagnostics.begin(), std::move(batch_diagnostics_));
        return std::move(checked_);
    }

private:
    /// Whether the workflow takes the scan in one run with others.
    bool joins(const Workflow& workflow, std::size_t scan) const {
        return takes_views(workflow) && !checked_.batch.scans[scan].is_object();
    }
    static std::span<const WorkflowInput> further_inputs(const Workflow& workflow) {
        return std::span(workflow.inputs).subspan(std::min<std::size_t>(1, workflow.inputs.size()));
    }

    /// The filter that measures; nullptr after an error in its name or its parameters.
    const FilterSpec* measuring_filter(const BatchMeasure& written) {
        const std::vector<std::string> names = measuring_filters(library_);
        const auto error = [&](Position position, std::string message) {
            batch_diagnostics_.error(position, std::move(message));
            return nullptr;
        };
        if (names.empty()) return error(written.position, "no installed filter measures results");
        if (written.filter.empty() && names.size() > 1)
            return error(written.position, fmt::format("{} measure results; expected `filter: NAME` under `measure:`",
                                                       enumerated(names)));
        if (!written.filter.empty() && std::ranges::find(names, written.filter) == names.end())
            return error(written.filter_position,
                         fmt::format("'{}' is not a filter that measures results; expected {}{}", written.filter,
                                     enumerated(names), did_you_mean(written.filter, names)));
        const FilterSpec* spec = library_.find(written.filter.empty() ? names.front() : written.filter);
        const StepSyntax syntax = measuring_step(*spec);
        ExpandedStep step{&syntax, {}, {}};
        for (const NamedExpression& parameter : syntax.parameters)
            if (!parameter.value.values.empty())  // the value could be read
                step.arguments.push_back(
                    {&parameter, &parameter.value.values.front(), parameter.value.values.front().literal, {}});
        const std::size_t errors = batch_diagnostics_.errors();
        step_parameters(step, *spec, {syntax.file, Settings(), batch_diagnostics_, nullptr});
        return batch_diagnostics_.errors() == errors ? spec : nullptr;
    }

    StepSyntax measuring_step(const FilterSpec& spec) const {
        const Batch& batch = checked_.batch;
        StepSyntax step;
        step.filter = spec.name;
        step.position = batch.measure->position;
        step.parameters = batch.measure->parameters;
        step.file = batch.file;
        step.may_be_left_out = true;
        return step;
    }

    /// The workflow with an input for the truth and the measuring steps. `plain` is the plan of the workflow. Its
    /// outputs are measured unless BatchMeasure::of names other values.
    Workflow with_measurements(Workflow workflow, const Plan& plain, Diagnostics& diagnostics) const {
        const std::string &value_port = measuring_->measures->value, &truth_port = measuring_->measures->truth;
        const Position position = checked_.batch.measure->position;
        const PortSpec& truth = *measuring_->input(truth_port);
        WorkflowInput& input = workflow.inputs.emplace_back();
        input.name = truth_input;
        input.position = position;
        input.kind = truth.kind;
        input.also = truth.also;
        input.by_name = true;
        std::vector<Reference> values = checked_.batch.measure->of;
        if (values.empty())
            for (const PlannedVariant& variant : plain.variants)
                for (const PlannedOutput& output : variant.outputs)
                    if (measuring_->input(value_port)->takes(kind_of(plain, output.source)))
                        values.push_back({output.name, position});
        std::set<std::string> added;
        for (const Reference& value : values) {
            if (!added.insert(value.text).second) continue;
            StepSyntax step = measuring_step(*measuring_);
            step.id = measuring_step_name(value);
            step.in = {{value_port, position, {value}}, {truth_port, position, {{truth_input, position}}}};
            const auto taken = std::ranges::find_if(
                plain.variants, [&](const PlannedVariant& variant) { return variant.steps_by_name.contains(step.id); });
            if (taken == plain.variants.end())
                workflow.steps.push_back({std::move(step)});
            else
                diagnostics.error(plain.steps[taken->steps_by_name.at(step.id)].position,
                                  "the step has the name '{}', which the batch's `measure` adds; rename the step",
                                  step.id);
        }
        return workflow;
    }

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
        if (workflow.steps.empty()) unreadable_ = true;  // its parameters may not have been read, either
        report_unfed_inputs(workflow, listed);
        if (!workflow.inputs.empty()) {
            if (!checked_.batch.has_scans)
                batch_diagnostics_.error(listed.position,
                                         "the workflow '{}' reads a scan, but the batch has no scans; expected "
                                         "`scans:` with a list of paths",
                                         listed.file.string());
            takes_scans_ = true;
            takes_points_ |= workflow.inputs.front().kind == kind_of<PointCloud>();
            first_inputs_.insert(workflow.inputs.front().name);
        }
        for (const WorkflowInput& input : further_inputs(workflow)) further_inputs_.insert(input.name);
        if (const auto taken = std::ranges::find(workflow.inputs, truth_input, &WorkflowInput::name);
            checked_.batch.measure && taken != workflow.inputs.end())
            diagnostics.error(taken->position,
                              "the input has the name '{}', which the batch's `measure` adds; rename the input",
                              truth_input);
        for (const WorkflowParameter& parameter : workflow.parameters) declared_.insert(parameter.name);
        add_parts(workflow, index, diagnostics);
        checked_.diagnostics.push_back(std::move(diagnostics));
    }

    /// Scans with equal values. If the workflow takes one scan per run, either all of them have a truth or none has.
    struct Group {
        Settings settings;
        std::string shape;  ///< BatchPart::shape
        std::vector<std::size_t> scans;
        std::map<std::size_t, Refusal> refusals;  ///< BatchPart::refusals
    };

    void add_parts(const Workflow& workflow, std::size_t index, Diagnostics& diagnostics) {
        const Batch& batch = checked_.batch;
        if (batch.scans.empty() ||
            workflow.inputs.empty()) {  // plan the workflow even without scans, to find its errors
            auto planned = plan(workflow, settings_for(workflow, batch.settings, {}), false, diagnostics);
            if (workflow.inputs.empty()) checked_.parts.push_back({std::move(planned), index, {}});
            return;
        }
        if (refuses_objects(workflow, batch.workflows[index])) return;
        std::vector<Group> groups;
        std::map<std::string, std::size_t> group_of_key;
        for (std::size_t scan = 0; scan < batch.scans.size(); ++scan) {
            Settings settings = settings_for(workflow, batch.settings, batch.scans[scan].settings);
            const bool is_joined = joins(workflow, scan), is_measured = !is_joined && has_truth(scan);
            const std::string manner =
                fmt::format("{}{}{}", index, is_joined ? " joined" : "", is_measured ? " measured" : "");
            const std::string shape = key_of(settings) + manner;
            Refusal refusal;
            for (const auto& [name, why] : batch.scans[scan].missing_settings)
                if (settings.contains(name)) refusal = why;
            if (takes_poses(workflow))
                if (Refusal why = add_poses(scan, workflow, settings); !why.empty()) refusal = std::move(why);
            const auto [group, is_new] = group_of_key.emplace(key_of(settings) + manner, groups.size());
            if (is_new) groups.push_back({std::move(settings), shape, {}, {}});
            groups[group->second].scans.push_back(scan);
            if (!refusal.empty()) groups[group->second].refusals.emplace(scan, std::move(refusal));
        }
        for (Group& group : groups) {
            const bool is_joined = joins(workflow, group.scans.front());
            if (is_joined) require_agreement(workflow, batch.workflows[index], group.scans);
            const bool is_measured = measuring_ && (is_joined ? agree_on_truth(batch.workflows[index], group)
                                                              : has_truth(group.scans.front()));
            checked_.parts.push_back({plan(workflow, group.settings, is_measured, diagnostics),
                                      index,
                                      std::move(group.scans),
                                      {},
                                      std::move(group.refusals),
                                      std::move(group.shape)});
        }
    }

    /// Reports objects if the workflow takes one scan per run.
    bool refuses_objects(const Workflow& workflow, const BatchWorkflow& listed) {
        const std::vector<BatchScan>& scans = checked_.batch.scans;
        const auto object = std::ranges::find_if(scans, &BatchScan::is_object);
        if (takes_views(workflow) || object == scans.end()) return false;
        batch_diagnostics_.error(
            listed.position,
            "'{}' takes one scan per run, and the object '{}' has {}; expected a workflow whose first input has "
            "`list: true`, or scans without `by: folder`",
            listed.file.string(), object->name(), count_text(object->views.size(), "view", "views"));
        return true;
    }

    /// Adds the object's poses to the settings. Poses beside the views give way to a setting, which may be `none`.
    /// Returns why they cannot be used.
    Refusal add_poses(std::size_t index, const Workflow& workflow, Settings& settings) {
        BatchScan& scan = checked_.batch.scans[index];
        const bool is_found = scan.poses_position.line == 0;
        if (is_found && settings.contains(poses_parameter)) {
            scan.poses_file.clear();
            return {};
        }
        if (is_found && !scan.idle_poses.empty() && idle_.insert(index).second && idle_.size() <= most_refused)
            batch_diagnostics_.warning(scan.position, scan.idle_poses);
        if (!scan.poses_refusal.empty() && refused_.insert(index).second && refused_.size() <= most_refused)
            batch_diagnostics_.warning(is_found ? scan.position : scan.poses_position, scan.poses_refusal.text());
        if (scan.poses_file.empty()) return scan.poses_refusal;
        report_common_frame(scan, workflow.inputs.front());
        const fs::path file = path_from(fs::path(checked_.batch.file).parent_path(), scan.poses_file);
        settings.insert_or_assign(poses_parameter, text_setting(file.string(), scan.position));
        return scan.poses_refusal;
    }

    /// Reports views with poses that are all in one frame, because poses belong to views by the names of frames. The
    /// objects of an entry share its position, which is reported once.
    void report_common_frame(const BatchScan& object, const WorkflowInput& views) {
        const std::string& frame = object.frame.empty() ? views.frame : object.frame;
        if (frame.empty() || frame.find("{stem}") != std::string::npos || object.views.size() < 2) return;
        if (in_common_frame_.emplace(object.position.line, object.position.column).second)
            batch_diagnostics_.error(object.position,
                                     "the {} of the object '{}' have poses, but are all in the frame '{}'; expected "
                                     "`frame: \"{{stem}}\"`, or `set: {{poses: none}}` for views that need no poses",
                                     count_text(object.views.size(), "view", "views"), object.name(), frame);
    }

    /// Reports poses if no workflow takes them. Scans of one entry share a position, which is reported once.
    void report_idle_poses() {
        std::set<std::pair<int, int>> reported;
        for (const BatchScan& scan : checked_.batch.scans)
            if (const Position at = scan.poses_position;
                at.line > 0 && !declared_.contains(poses_parameter) && reported.emplace(at.line, at.column).second)
                batch_diagnostics_.error(at,
                                         "no workflow has a parameter '{}'; a workflow with an input for poses takes "
                                         "them by `in: {{NAME: FILE}}`",
                                         poses_parameter);
    }

    bool has_truth(std::size_t scan) const { return !checked_.batch.scans[scan].truth.files.empty(); }

    std::shared_ptr<const Plan> plan(const Workflow& workflow, const Settings& settings, bool is_measured,
                                     Diagnostics& diagnostics) {
        Plan plan = make_plan(workflow, library_, settings, diagnostics, &batch_diagnostics_);
        if (is_measured && !diagnostics.has_errors())
            plan = make_plan(with_measurements(workflow, plan, diagnostics), library_, settings, diagnostics,
                             &batch_diagnostics_);
        return std::make_shared<const Plan>(std::move(plan));
    }

    /// Reports scans whose files for other inputs differ, because a workflow that takes all scans in one run needs the
    /// same files for all of them.
    void require_agreement(const Workflow& workflow, const BatchWorkflow& listed, std::span<const std::size_t> scans) {
        const std::vector<BatchScan>& all = checked_.batch.scans;
        for (const WorkflowInput& input : further_inputs(workflow)) {
            const auto first = all[scans.front()].inputs.find(input.name);
            if (first == all[scans.front()].inputs.end()) continue;  // report_unfed_inputs() reported it
            for (const std::size_t scan : scans)
                if (const auto other = all[scan].inputs.find(input.name);
                    other != all[scan].inputs.end() && other->second.files != first->second.files) {
                    batch_diagnostics_.error(
                        other->second.position,
                        "'{}' takes all scans in one run, which needs the same files for the input '{}'; '{}' and '{}' "
                        "have different files",
                        listed.file.string(), input.name, all[scans.front()].file.string(), all[scan].file.string());
                    break;
                }
        }
    }

    bool agree_on_truth(const BatchWorkflow& listed, const Group& group) {
        const std::vector<BatchScan>& all = checked_.batch.scans;
        const BatchInput& first = all[group.scans.front()].truth;
        for (const std::size_t scan : group.scans)
            if (!all[scan].truth.has_same_files(first)) {
                batch_diagnostics_.warning(
                    listed.position,
                    fmt::format("'{}' takes all scans in one run, but the scans have different truths, "
                                "so its results are not measured",
                                listed.file.string()));
                return false;
            }
        return !first.files.empty();
    }

    void report_unfed_inputs(const Workflow& workflow, const BatchWorkflow& listed) {
        for (const WorkflowInput& input : further_inputs(workflow)) {
            std::vector<std::string> unfed;
            for (const BatchScan& scan : checked_.batch.scans) {
                const auto given = scan.inputs.find(input.name);
                if (given == scan.inputs.end())
                    unfed.push_back(scan.file.string());
                else if (!input.list && given->second.files.size() > 1)
                    batch_diagnostics_.error(given->second.position, "the input '{}' of '{}' takes one file; found {}",
                                             input.name, listed.file.string(), given->second.files.size());
            }
            if (!unfed.empty())
                batch_diagnostics_.error(
                    listed.position,
                    "the input '{}' of '{}' has no file for the scan '{}'{}; expected `in: {{{}: FILE}}` at the scan",
                    input.name, listed.file.string(), unfed.front(),
                    unfed.size() > 1 ? fmt::format(" and {} more", unfed.size() - 1) : "", input.name);
        }
    }

    void report_unknown_inputs() {
        const std::vector<std::string> names(further_inputs_.begin(), further_inputs_.end());
        for (const BatchScan& scan : checked_.batch.scans)
            for (const auto& [name, input] : scan.inputs) {
                if (further_inputs_.contains(name)) continue;
                if (first_inputs_.contains(name))
                    batch_diagnostics_.error(input.position,
                                             "the scan itself feeds '{}', a workflow's first input; name its file as "
                                             "`path`",
                                             name);
                else
                    batch_diagnostics_.error(input.position, "no workflow has an input '{}' beside its first; {}{}",
                                             name, names.empty() ? "they have none" : "they have " + enumerated(names),
                                             did_you_mean(name, names));
            }
    }

    void report_undeclared(const Settings& settings) {
        const std::vector<std::string> names(declared_.begin(), declared_.end());
        for (const auto& [name, value] : settings)
            if (!declared_.contains(name))
                batch_diagnostics_.error(value.position, "none of the workflows has a parameter '{}'; {}{}", name,
                                         names.empty() ? "they declare none" : "they have " + enumerated(names),
                                         did_you_mean(name, names));
    }

    /// Reports rules for invalid rows if no workflow takes points, because they have no effect. Scans of one entry
    /// share a position, which is reported once.
    void report_idle_rules() {
        if (takes_points_) return;
        std::set<std::pair<int, int>> reported;
        for (const BatchScan& scan : checked_.batch.scans)
            if (const Position at = scan.invalid_position;
                scan.invalid != InvalidRows::by_format && reported.emplace(at.line, at.column).second)
                batch_diagnostics_.error(at, "`invalid` is for points; no workflow of the batch takes points");
    }

    void report_idle_scans() {
        const std::vector<BatchScan>& scans = checked_.batch.scans;
        if (!takes_scans_ && !scans.empty() && !checked_.batch.workflows.empty())
            batch_diagnostics_.error(scans.front().position, "no workflow of the batch takes scans; scans given: {}",
                                     scans.size());
    }

    void report_idle_truths() {
        const Batch& batch = checked_.batch;
        bool has_any = false;
        for (const BatchScan& scan : batch.scans) {
            if (scan.truth.files.empty()) continue;
            has_any = true;
            if (!batch.measure)
                batch_diagnostics_.warning(
                    scan.truth.position, "`truth` has no effect without `measure:` in the batch: nothing is measured");
        }
        if (batch.measure && !has_any && (!batch.scans.empty() || !batch.has_scans))
            batch_diagnostics_.error(batch.measure->position,
                                     "no scan has a truth, so nothing would be measured; expected `truth: FILE` at a "
                                     "scan");
    }

    /// Reports values under `of` that are not measured, a batch without any measured result, and workflows without a
    /// measured result.
    void report_unmeasured() {
        std::set<std::string> steps;  // names of measuring steps
        std::set<std::size_t> measured, unmeasured;  // workflows with measuring steps, and all that take a truth
        for (const BatchPart& part : checked_.parts) {
            if (!takes_truth(*part.plan)) continue;
            unmeasured.insert(part.workflow);
            for (const PlannedVariant& variant : part.plan->variants)
                for (const auto& [name, step] : variant.steps_by_name)
                    if (is_of_batch(part.plan->steps[step])) {
                        steps.insert(name);
                        measured.insert(part.workflow);
                    }
        }
        if (unmeasured.empty()) return;  // every run takes a list of scans with different truths
        const std::vector<Reference>& of = checked_.batch.measure->of;
        for (const Reference& value : of)
            if (!steps.contains(measuring_step_name(value))) report_unmeasured(value);
        const std::string kinds = kinds_text(*measuring_->input(measuring_->measures->value));
        if (measured.empty() && !batch_diagnostics_.has_errors())
            batch_diagnostics_.error(checked_.batch.measure->position,
                                     "no workflow has an output of kind {}, so nothing would be measured; expected "
                                     "`of: [STEP]`",
                                     kinds);
        for (const std::size_t workflow : unmeasured)
            if (!measured.contains(workflow) && !measured.empty())
                batch_diagnostics_.warning(
                    checked_.batch.workflows[workflow].position,
                    fmt::format(
                        "no result of '{}' is measured: {}", checked_.batch.workflows[workflow].file.string(),
                        of.empty() ? "it has no output of kind " + kinds : "it has none of the steps under `of`"));
    }

    void report_unmeasured(const Reference& value) {
        const std::string name = value.text.substr(0, value.text.find('.'));
        std::set<std::string> names;
        for (const BatchPart& part : checked_.parts) {
            const Plan& plan = *part.plan;
            if (!takes_truth(plan)) continue;
            for (const WorkflowInput& input : plan.workflow.inputs) names.insert(input.name);
            for (const PlannedVariant& variant : plan.variants) {
                for (const auto& [step_name, step] : variant.steps_by_name)
                    if (!is_of_batch(plan.steps[step])) names.insert(step_name);
                if (names.contains(name)) return report_unfit(value, plan, variant);
            }
        }
        names.erase(truth_input);
        const std::vector<std::string> known(names.begin(), names.end());
        batch_diagnostics_.error(value.position, "no workflow has a step '{}' to measure; they have {}{}", name,
                                 known.empty() ? "none" : enumerated(known), did_you_mean(name, known));
    }

    void report_unfit(const Reference& value, const Plan& plan, const PlannedVariant& variant) {
        const std::map<std::string, std::string> no_names;
        const WiringScope scope{plan, library_, variant.steps, variant.steps_by_name, no_names, false};
        const std::optional<ValueSource> source = resolve(value, scope, batch_diagnostics_);
        if (!source) return;
        const bool is_list = !source->step && plan.workflow.inputs[source->input].list;
        batch_diagnostics_.error(value.position, "'{}' is {}{}; {} measures {}", value.text,
                                 is_list ? "a list of " : "", name_of(kind_of(plan, *source)), measuring_->name,
                                 kinds_text(*measuring_->input(measuring_->measures->value)));
    }

    static bool takes_truth(const Plan& plan) {
        const std::vector<WorkflowInput>& inputs = plan.workflow.inputs;
        return !inputs.empty() && inputs.back().name == truth_input;
    }
    static bool is_of_batch(const PlannedStep& step) { return !step.file.empty(); }
    static std::string measuring_step_name(const Reference& value) {
        std::string name = std::string(measurement_prefix) + value.text;
        std::ranges::replace(name, '.', '-');
        return name;
    }

    /// Reports cells that would write the same file. Reports only the first ten errors.
    void report_shared_files() {
        OutputNames files{fs::path()};
        std::size_t shared = 0;
        for (std::size_t part = 0; part < checked_.parts.size(); ++part) {
            const Plan& plan = *checked_.parts[part].plan;
            const Position of_workflow = checked_.batch.workflows[checked_.parts[part].workflow].position;
            std::vector<const BatchScan*> scans;  // nullptr: one run with all scans, or without a scan
            if (checked_.has_run_per_scan(checked_.parts[part]))
                for (const std::size_t scan : checked_.parts[part].scans) scans.push_back(&checked_.batch.scans[scan]);
            else
                scans.push_back(nullptr);
            for (const BatchScan* scan : scans)
                for (const PlannedVariant& variant : plan.variants) try {
                        add_outputs(files, plan, variant, scan, std::to_string(part));
                    } catch (const Error& error) {
                        constexpr std::size_t most = 10;
                        if (++shared <= most)
                            batch_diagnostics_.error(
                                scan ? scan->position : of_workflow,
                                error.sentence() + (error.hint().empty() ? "" : "; " + error.hint()));
                    }
        }
    }

    /// Adds the outputs of a cell. `scan` is null if the run of the cell takes all scans or no scan. Equal values of
    /// one scan may share a file.
    void add_outputs(OutputNames& files, const Plan& plan, const PlannedVariant& variant, const BatchScan* scan,
                     const std::string& part) const {
        const std::string workflow = workflow_name(plan), name = scan ? scan->file.string() : workflow;
        const TemplateValues values{scan ? scan->name() : workflow, variant.name, workflow,
                                    scan ? folder_name(scan->file) : workflow};
        const std::string writer = cell_text(name, variant.name, checked_.parts.size() > 1 ? workflow : "");
        for (const PlannedOutput& output : variant.outputs) {
            const std::string source = output.source.step ? plan.steps[*output.source.step].structure_key
                                                          : std::to_string(output.source.input);
            const std::string file = expand_template(output.file, values);
            const std::string content = part + "\n" + name + "\n" + source;
            files.add(file, {content, output.source.port}, writer, values);
            files.add(description_of(file).string(), {content, output.source.port + " described"}, writer, values);
        }
    }

    const FilterLibrary& library_;
    Diagnostics batch_diagnostics_;
    CheckedBatch checked_;
    const FilterSpec* measuring_ = nullptr;  // null: the batch does not measure
    std::set<std::string> declared_;
    std::set<std::string> first_inputs_, further_inputs_;  // names of inputs
    bool takes_scans_ = false, takes_points_ = false;
    static constexpr std::size_t most_refused = 10;
    std::set<std::pair<int, int>> in_common_frame_;  // positions of reported entries
    std::set<std::size_t> idle_;  // objects with an unused file of poses; warnings name the first
    std::set<std::size_t> refused_;  // objects whose poses are refused; warnings name the first
    bool unreadable_ = false;  // a workflow cannot be read, so its parameters and inputs are unknown
};

}  // namespace

Batch parse_batch(const std::string& text, Diagnostics& diagnostics) {
    const YamlNode root = parse_yaml(text, diagnostics);
    return BatchParser(diagnostics).batch(root);
}

std::string BatchScan::name() const { return is_object() ? file.filename().string() : stem_of(file); }

std::vector<std::string> measuring_filters(const FilterLibrary& library) {
    std::vector<std::string> names = library.names();
    std::erase_if(names, [&](const std::string& name) {
        const FilterSpec& spec = *library.find(name);
        return !spec.measures || !std::ranges::all_of(spec.inputs, [&](const PortSpec& port) {
            return port.optional || port.name == spec.measures->value || port.name == spec.measures->truth;
        });
    });
    return names;
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
    for (const BatchPart& part : parts)
        count += part.plan->variants.size() * (has_run_per_scan(part) ? part.scans.size() : 1);
    return count;
}

const Refusal& CheckedBatch::refusal(const BatchPart& part, std::size_t scan) const {
    const auto found = part.refusals.find(scan);
    const Refusal& of_scan = batch.scans[scan].refusal;
    return of_scan.empty() && found != part.refusals.end() ? found->second : of_scan;
}

bool CheckedBatch::has_run_per_scan(const BatchPart& part) const {
    if (part.scans.empty()) return false;
    return !takes_views(part.plan->workflow) || batch.scans[part.scans.front()].is_object();
}

CheckedBatch check_batch(const std::string& text, const std::string& file, const FilterLibrary& library) {
    return BatchPlanner(text, file, library).checked();
}

}  // namespace scanmill
