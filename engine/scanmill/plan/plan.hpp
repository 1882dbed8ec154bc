// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The plan of one workflow: the graph of its steps over all variants. Equal steps are merged, every port is wired, and
/// every parameter is typed and in range. Planning finds every error that can be found before a scan is opened.

#include <optional>
#include <string>
#include <vector>

#include "scanmill/plan/expand.hpp"
#include "scanmill/plugin/library.hpp"
#include "scanmill/record/fields.hpp"
#include "scanmill/workflow/workflow.hpp"

namespace scanmill {

/// The origin of a value: an output of a planned step, or a workflow input.
struct ValueSource {
    std::optional<std::size_t> step;  ///< index into Plan::steps
    std::size_t input = 0;  ///< index into Workflow::inputs, when there is no step
    std::string port;  ///< output port of the step
    auto operator<=>(const ValueSource&) const = default;
};

struct PlannedInput {
    std::string port;
    std::vector<ValueSource> sources;
    bool operator==(const PlannedInput&) const = default;
};

/// A condition on a step's result; `low` and `high` are typed by the unit of the metric or property.
struct PlannedExpectation {
    std::string name;
    Position position;
    Expectation::Relation relation;
    Unit unit;
    ParameterValue low, high;
    std::string text;  ///< "genus: < 2", for messages
};
constexpr auto fields(const PlannedExpectation*) {
    using R = PlannedExpectation;
    return std::tuple{field("name", &R::name), field("relation", &R::relation), field("unit", &R::unit),
                      field("low", &R::low),   field("high", &R::high),         field("text", &R::text)};
}

struct PlannedStep {
    std::string label;  ///< the id, or else the filter's name
    Position position;
    FilterSpec spec;
    ParameterSet parameters;  ///< as authored, with defaults; lengths keep their written units
    std::vector<PlannedInput> inputs;
    std::vector<PlannedExpectation> expectations;
    /// Equal for steps with the same filter, parameters and upstream steps.
    std::string structure_key;
    std::string file{};  ///< the file to which `position` refers; if empty, the workflow file
};

struct PlannedOutput {
    std::string file;  ///< template
    Position position;
    ValueSource source;
    std::string name;  ///< name of the source, as written in the workflow
};

struct PlannedVariant {
    std::string name;
    std::vector<std::size_t> steps;  ///< indices into Plan::steps, each after its inputs
    std::vector<PlannedOutput> outputs;
    /// Maps each name to its step in this variant. Names are ids, filters and ids of one-of steps.
    std::map<std::string, std::size_t> steps_by_name;
};

struct Plan {
    Workflow workflow;
    std::vector<PlannedStep> steps;  ///< every step after the steps it reads from
    std::vector<PlannedVariant> variants;
};

/// Checks the workflow against the installed filters. If `diagnostics` has errors, the plan must not be run.
///
/// `settings_diagnostics` belongs to the file that contains the settings; nullptr for settings from the command line. A
/// value that its parameter refuses is reported there, or else at the step. Relative paths in the settings count from
/// the folder of that file, or else from the working folder.
Plan make_plan(Workflow workflow, const FilterLibrary& library, const Settings& settings, Diagnostics& diagnostics,
               Diagnostics* settings_diagnostics = nullptr);

/// The workflow's name, or the stem of its file if it has none.
std::string workflow_name(const Plan& plan);

Kind kind_of(const Plan& plan, const ValueSource& source);

/// The values of the placeholders in names of output files: the scan's stem, the variant, the workflow and the name of
/// the folder that holds the scan.
struct TemplateValues {
    std::string scan, variant, workflow, folder;
};

/// Fills in the template `file`. Returns a path relative to the output folder, in normal form. Throws Error if the path
/// leaves the folder.
std::string expand_template(const std::string& file, const TemplateValues& values);

/// The source's name for messages and listings: "scan", "solid", "solid.tets".
std::string describe(const Plan& plan, const ValueSource& source);

}  // namespace scanmill
