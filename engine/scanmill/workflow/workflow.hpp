// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A workflow as its file says it, with the place of everything: the grammar's syntax tree. What the names in it mean
/// is checked later (plan.hpp), against the filters at hand.

#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "scanmill/filter/parameter.hpp"
#include "scanmill/kinds/value.hpp"
#include "scanmill/workflow/diagnostics.hpp"
#include "scanmill/workflow/document.hpp"

namespace scanmill {

/// `$name`: the value of a workflow parameter stands here.
struct NameUse {
    std::string name;  ///< without the $
    Position position;
    std::size_t item = 0;  ///< of `literal.items`, which holds nothing there yet
};

/// One written value: text(s), of which some may be uses of workflow parameters.
struct WrittenValue {
    Position position;
    WrittenParameter literal;
    std::vector<NameUse> uses;
};

/// A value, or `{sweep: [value, …]}`: then it has several, and everything after it runs once for each.
struct ValueExpression {
    Position position;
    std::vector<WrittenValue> values;
    bool sweep = false;
};

struct NamedExpression {
    std::string name;
    Position position;
    ValueExpression value;
};

/// "step", "step.port" or a workflow input's name.
struct Reference {
    std::string text;
    Position position;
};

struct InputWiring {
    std::string port;
    Position position;
    std::vector<Reference> sources;  ///< more than one only for list ports
};

struct Expectation {
    enum class Relation { equal, below, above, between };
    std::string name;
    Position position;
    Relation relation = Relation::equal;
    std::string value, high;  ///< as written; `high` only for between
};

struct StepSyntax {
    std::string filter;
    Position position;
    std::string id;
    std::vector<NamedExpression> parameters;
    std::vector<InputWiring> in;
    std::optional<Reference> in_shorthand;  ///< `in: scan`, for filters with one port
    std::vector<Expectation> expect;
};

struct StepItem;

struct AlternativeSyntax {
    std::string name;
    Position position;
    std::vector<StepItem> steps;
};

struct OneOfSyntax {
    Position position;
    std::string id;
    std::vector<AlternativeSyntax> alternatives;
};

struct StepItem {
    std::variant<StepSyntax, OneOfSyntax> item;
};

struct WorkflowInput {
    std::string name;
    Position position;
    Kind kind = kind_of<PointCloud>();
    bool list = false;
    LengthUnit unit = LengthUnit::unknown;
    std::string frame;  ///< may hold {stem}, see input_frame.hpp; empty: what the file says
    std::string help;
};

struct WorkflowParameter {
    std::string name;
    Position position;
    ValueExpression value;
    std::string help;
};

struct WorkflowOutput {
    std::string file;  ///< a template
    Position position;
    Reference source;
};

struct Workflow {
    std::string file;
    std::string name;
    std::string summary;
    std::vector<WorkflowInput>
        inputs;  ///< the first is fed by the scans: one at a time, or all at once when it is a list
    std::vector<WorkflowParameter> parameters;
    std::vector<StepItem> steps;
    std::vector<WorkflowOutput> outputs;
    /// Names that stand as `$name` in steps, outputs and defaults, also in what could not be read.
    std::set<std::string> mentions;
};

/// The workflow in `text`; what is wrong goes to `diagnostics`, what is right is still returned.
Workflow parse_workflow(const std::string& text, Diagnostics& diagnostics);

/// A value as a workflow would hold it, from the command line: "0.1 %diag", "[0, 1]", "{sweep: [1, 2]}".
ValueExpression parse_value_expression(const std::string& text, Diagnostics& diagnostics);

}  // namespace scanmill
