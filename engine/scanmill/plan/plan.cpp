// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plan/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/base/hash.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/plan/expectation.hpp"
#include "scanmill/plan/output_names.hpp"
#include "scanmill/plan/step_parameters.hpp"
#include "scanmill/plan/wiring.hpp"
#include "scanmill/workflow/grammar.hpp"

namespace scanmill {

namespace {

const std::array<std::string, 4> placeholders{"scan", "folder", "variant", "workflow"};

bool leaves_folder(const std::filesystem::path& path) {
    const std::filesystem::path normal = path.lexically_normal();
    return path.is_absolute() || normal.empty() || *normal.begin() == "..";
}

bool names_a_folder(const std::filesystem::path& path) {
    return !path.has_filename() || path.filename() == "." || path.filename() == "..";
}

/// Reports wrong placeholders, absolute paths, and paths that leave the output folder. Reports paths that are not in
/// normal form (`a//b`, `a/../b`), because equal files must have equal names.
void check_template(const WorkflowOutput& output, Diagnostics& diagnostics) {
    const std::string& file = output.file;
    const auto error = [&](std::string message) { diagnostics.error(output.position, std::move(message)); };
    check_placeholders(file, "the file name", placeholders, output.position, diagnostics);
    if (file.find('\0') != std::string::npos) error("a file's name has a zero byte");
    constexpr std::size_t most = 255;  // the limit of nearly every file system
    const std::string shortest = with_placeholders(file, [](const std::string&) { return std::string(); });
    for (const std::filesystem::path& part : std::filesystem::path(shortest))
        if (const std::size_t bytes = part.native().size(); bytes > most)
            error(fmt::format("a file's name has {} bytes; expected at most {}", bytes, most));
    if (leaves_folder(file))
        error(fmt::format("'{}' lies outside the output folder; expected a path below it, as \"{{scan}}.stl\"", file));
    else if (names_a_folder(file))
        error(fmt::format("'{}' is the name of a folder; expected a file, as \"{{scan}}.stl\"", file));
    else if (const std::string normal = std::filesystem::path(file).lexically_normal().string(); normal != file)
        error(fmt::format("'{}' is not in its shortest form; expected '{}'", file, normal));
}

class Planner {
public:
    Planner(Workflow workflow, const FilterLibrary& library, Diagnostics& diagnostics,
            Diagnostics* settings_diagnostics)
        : library_(library),
          diagnostics_(diagnostics),
          settings_diagnostics_(settings_diagnostics) {
        plan_.workflow = std::move(workflow);
    }

    Plan plan(const Settings& settings) {
        settings_ = &settings;
        expand(plan_.workflow, settings, diagnostics_,
               [this](const Variant& variant) { plan_.variants.push_back(plan_variant(variant)); });
        for (const WorkflowOutput& output : plan_.workflow.outputs) check_template(output, diagnostics_);
        check_shared_files();
        check_folders();
        check_failed_folder();
        return std::move(plan_);
    }

private:
    /// Maps the names in a variant to steps, while the variant is being planned.
    struct Names {
        std::map<std::string, std::size_t> steps;
        std::map<std::string, std::string> unusable;  // name → why; empty: already reported

        void add(const std::string& name, std::size_t step) {
            if (unusable.contains(name)) return;
            if (!steps.emplace(name, step).second && steps[name] != step) {
                steps.erase(name);
                unusable[name] =
                    fmt::format("'{}' is the name of several steps; give one of them an `id` and use it here", name);
            }
        }
    };

    PlannedVariant plan_variant(const Variant& variant) {
        PlannedVariant planned;
        planned.name = variant.name;
        Names names;
        bool uncertain = false;
        std::set<std::string> ids;
        for (const ExpandedStep& step : variant.steps) {
            check_ids(step, ids);
            const FilterSpec* spec = find_filter(*step.syntax);
            if (!spec) {
                uncertain = true;
                for (const std::string& name : names_of(step)) names.unusable.emplace(name, "");
                continue;
            }
            const WiringScope scope{plan_, library_, planned.steps, names.steps, names.unusable, uncertain};
            if (step.syntax->may_be_left_out && !can_wire(*step.syntax, *spec, scope)) continue;
            const std::size_t index = add_step(step, *spec, scope);
            planned.steps.push_back(index);
            for (const std::string& name : names_of(step)) names.add(name, index);
        }
        const WiringScope scope{plan_, library_, planned.steps, names.steps, names.unusable, uncertain};
        for (const WorkflowOutput& output : plan_.workflow.outputs) plan_output(output, scope, planned);
        planned.steps_by_name = std::move(names.steps);
        return planned;
    }

    static std::vector<std::string> names_of(const ExpandedStep& step) {
        std::vector<std::string> names = step.aliases;
        names.push_back(step.syntax->name());
        return names;
    }

    void check_ids(const ExpandedStep& step, std::set<std::string>& ids) {
        for (const std::string& name : names_of(step)) {
            const bool given = name == step.syntax->id || std::ranges::find(step.aliases, name) != step.aliases.end();
            if (!given || name.empty()) continue;  // empty after an error: neither id nor filter could be read
            if (!ids.insert(name).second) diagnostics_.error(step.syntax->position, "the id '{}' is used twice", name);
            if (std::ranges::find(plan_.workflow.inputs, name, &WorkflowInput::name) != plan_.workflow.inputs.end())
                diagnostics_.error(step.syntax->position, "the id '{}' is already the name of an input", name);
        }
    }

    const FilterSpec* find_filter(const StepSyntax& step) {
        if (step.filter.empty()) return nullptr;  // reported by the parser
        if (const FilterSpec* spec = library_.find(step.filter)) return spec;
        for (const UnusableModule& module : library_.unusable())
            if (module.name == step.filter) {
                diagnostics_.error(step.position, "the filter '{}' cannot be used: '{}' {}", step.filter,
                                   module.manifest.string(), module.reason);
                return nullptr;
            }
        const std::vector<std::string> names = library_.names();
        diagnostics_.error(step.position, "there is no filter '{}'; `scanmill list` lists the {} installed ones{}",
                           step.filter, names.size(), did_you_mean(step.filter, names));
        return nullptr;
    }

    static bool can_wire(const StepSyntax& step, const FilterSpec& spec, const WiringScope& scope) {
        Diagnostics reasons("");
        wire(step, spec, scope, reasons);
        return !reasons.has_errors();
    }

    /// Sets the kind of every output that has PortSpec::like to the kind of the value wired to that input.
    FilterSpec with_kinds(FilterSpec spec, const std::vector<PlannedInput>& inputs) const {
        for (PortSpec& output : spec.outputs)
            if (const auto wired = std::ranges::find(inputs, output.like, &PlannedInput::port);
                !output.like.empty() && wired != inputs.end())
                output.kind = kind_of(plan_, wired->sources.front());
        return spec;
    }

    std::size_t add_step(const ExpandedStep& step, const FilterSpec& declared, const WiringScope& scope) {
        const std::string& file = step.syntax->file.empty() ? plan_.workflow.file : step.syntax->file;
        ParameterSet set = step_parameters(step, declared, {file, *settings_, diagnostics_, settings_diagnostics_});
        std::vector<PlannedInput> inputs = wire(*step.syntax, declared, scope, diagnostics_);
        const FilterSpec spec = with_kinds(declared, inputs);
        std::string key = structure_key(spec, set, inputs);
        const auto [found, is_new] = step_of_key_.emplace(key, plan_.steps.size());
        if (is_new)
            plan_.steps.push_back({step.syntax->id.empty() ? spec.name : step.syntax->id,
                                   step.syntax->position,
                                   spec,
                                   std::move(set),
                                   std::move(inputs),
                                   {},
                                   std::move(key),
                                   step.syntax->file});
        std::vector<PlannedExpectation>& expectations = plan_.steps[found->second].expectations;
        for (const Expectation& written : step.syntax->expect) {
            if (std::ranges::find(expectations, written.position, &PlannedExpectation::position) != expectations.end())
                continue;  // already planned or reported for an earlier variant
            const std::optional<Expectation> complete = with_values(written);
            if (!complete) continue;
            if (auto expectation = plan_expectation(*complete, spec, diagnostics_))
                expectations.push_back(std::move(*expectation));
        }
        return found->second;
    }

    /// The expectation with a value for every `$name`. Nothing if a name has no single value, which expand() reports.
    std::optional<Expectation> with_values(Expectation expectation) const {
        for (const NameUse& use : expectation.uses) {
            const auto parameter = std::ranges::find(plan_.workflow.parameters, use.name, &WorkflowParameter::name);
            if (parameter == plan_.workflow.parameters.end()) return std::nullopt;
            const auto setting = settings_->find(use.name);
            const ValueExpression& given = setting != settings_->end() ? setting->second : parameter->value;
            if (given.sweep || given.values.size() != 1 || given.values.front().literal.list) return std::nullopt;
            (use.item == 0 ? expectation.value : expectation.high) = given.values.front().literal.items.front();
        }
        return expectation;
    }

    std::string structure_key(const FilterSpec& spec, const ParameterSet& parameters,
                              const std::vector<PlannedInput>& inputs) const {
        KeyBuilder key;
        key.field("filter", spec.name).field("version", std::to_string(spec.version));
        for (const auto& [name, value] : parameters.values) key.field("parameter " + name, canonical_text(value));
        for (const PlannedInput& input : inputs)
            for (const ValueSource& source : input.sources)
                key.field("port " + input.port, source.step
                                                    ? plan_.steps[*source.step].structure_key + "." + source.port
                                                    : "input " + plan_.workflow.inputs[source.input].name);
        return key.key();
    }

    void plan_output(const WorkflowOutput& output, const WiringScope& scope, PlannedVariant& variant) {
        if (output.may_be_left_out && !scope.steps_by_name.contains(output.source.text)) return;
        const std::optional<ValueSource> source = resolve(output.source, scope, diagnostics_);
        if (!source) return;
        if (!source->step && plan_.workflow.inputs[source->input].list) {
            diagnostics_.error(output.source.position, "'{}' is a list; a file holds one value", output.source.text);
            return;
        }
        const Kind kind = kind_of(plan_, *source);
        const std::string extension = std::filesystem::path(output.file).extension().string();
        if (!can_write(extension, kind)) {
            const std::string writable = writable_extensions(kind), unusable = why_unusable(extension);
            diagnostics_.error(output.position, "'{}' is {}, which no '{}' file can hold; {}", output.source.text,
                               name_of(kind), extension,
                               !unusable.empty()  ? unusable
                               : writable.empty() ? "this kind cannot be written yet"
                                                  : "expected " + writable);
        }
        variant.outputs.push_back({output.file, output.position, *source, output.source.text});
    }

    void check_shared_files() {
        struct Writer {
            const PlannedVariant* variant;
            const PlannedOutput* output;
            bool is_reported = false;
        };
        std::map<std::string_view, Writer> last_writers;
        for (const PlannedVariant& variant : plan_.variants)
            for (const PlannedOutput& output : variant.outputs) {
                if (output.file.find("{variant}") != std::string::npos) continue;
                const auto [found, is_new] = last_writers.emplace(output.file, Writer{&variant, &output});
                Writer& last = found->second;
                if (!is_new && !last.is_reported && last.output->source != output.source) {
                    last.is_reported = true;
                    diagnostics_.error(output.position,
                                       "the variants '{}' and '{}' would both write '{}'; put "
                                       "{{variant}} into the name",
                                       last.variant->name, variant.name, output.file);
                }
                last.variant = &variant;
                last.output = &output;
            }
    }

    void check_folders() {
        std::set<std::string_view> files;
        for (const WorkflowOutput& output : plan_.workflow.outputs) files.insert(output.file);
        for (const WorkflowOutput& output : plan_.workflow.outputs) {
            const std::string folder = output.file + "/";
            if (const auto file = files.lower_bound(folder); file != files.end() && file->starts_with(folder))
                diagnostics_.error(output.position, "'{}' is an output and also the folder of '{}'", output.file,
                                   *file);
        }
    }

    /// Outputs below failed_folder_name that another output would replace, or remove.
    void check_failed_folder() {
        std::set<std::string_view> files;
        for (const WorkflowOutput& output : plan_.workflow.outputs) files.insert(output.file);
        const std::string folder = fmt::format("{}/", failed_folder_name);
        for (const WorkflowOutput& output : plan_.workflow.outputs) {
            if (!output.file.starts_with(folder)) continue;
            const std::string_view other = std::string_view(output.file).substr(folder.size());
            if (files.contains(other))
                diagnostics_.error(output.position,
                                   "'{}' is where '{}' is written if a step does not meet its `expect`; put the output "
                                   "into another folder",
                                   output.file, other);
        }
    }

    const FilterLibrary& library_;
    Diagnostics& diagnostics_;
    Diagnostics* settings_diagnostics_;
    const Settings* settings_ = nullptr;
    Plan plan_;
    std::map<std::string, std::size_t> step_of_key_;
};

}  // namespace

Plan make_plan(Workflow workflow, const FilterLibrary& library, const Settings& settings, Diagnostics& diagnostics,
               Diagnostics* settings_diagnostics) {
    return Planner(std::move(workflow), library, diagnostics, settings_diagnostics).plan(settings);
}

std::string workflow_name(const Plan& plan) {
    return plan.workflow.name.empty() ? std::filesystem::path(plan.workflow.file).stem().string() : plan.workflow.name;
}

Kind kind_of(const Plan& plan, const ValueSource& source) {
    return source.step ? plan.steps[*source.step].spec.output(source.port)->kind
                       : plan.workflow.inputs[source.input].kind;
}

std::string expand_template(const std::string& file, const TemplateValues& values) {
    const std::string name = with_placeholders(file, [&](const std::string& placeholder) {
        return placeholder == "scan"      ? values.scan
               : placeholder == "folder"  ? values.folder
               : placeholder == "variant" ? values.variant
                                          : values.workflow;
    });
    if (leaves_folder(name) || names_a_folder(name))
        throw Error("'{}' becomes '{}', which is not a file below the output folder", file, name)
            .hint("rename the scan");
    return std::filesystem::path(name).lexically_normal().string();
}

std::string describe(const Plan& plan, const ValueSource& source) {
    if (!source.step) return plan.workflow.inputs[source.input].name;
    const PlannedStep& step = plan.steps[*source.step];
    return source.port == step.spec.outputs.front().name ? step.label : step.label + "." + source.port;
}

}  // namespace scanmill
