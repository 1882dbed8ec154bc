// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A workflow as it is written, with the position of everything: the grammar's syntax tree. Names are resolved against
/// the installed filters later, by plan.hpp.

#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "scanmill/filter/parameter.hpp"
#include "scanmill/kinds/value.hpp"
#include "scanmill/workflow/document.hpp"

namespace scanmill {

/// `$name`, the use of a workflow parameter.
struct NameUse {
    std::string name;  ///< without the $
    Position position;
    std::size_t item = 0;  ///< index into `literal.items`, where the text is still empty
};

/// One written value: one text or several, some of which may be uses of workflow parameters.
struct WrittenValue {
    Position position;
    WrittenParameter literal;
    std::vector<NameUse> uses;
};

/// A value, or `{sweep: [value, …]}`, which has several: everything after it runs once for each.
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
    std::string file{};  ///< that the positions are in; empty: the workflow's
    bool may_be_left_out = false;  ///< variants without the values that `in` names may omit the step

    /// How other steps refer to this one.
    const std::string& name() const { return id.empty() ? filter : id; }
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
    std::string frame;  ///< may contain {stem}; empty: the file's own
    InvalidRows invalid = InvalidRows::by_format;  ///< of points
    std::string help;
    std::vector<Kind> also{};  ///< other kinds that its file may hold
    bool by_name = false;      ///< wired by `in` alone
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
    std::vector<WorkflowInput> inputs;  ///< scans feed the first: one at a time, or all at once when it is a list
    std::vector<WorkflowParameter> parameters;
    std::vector<StepItem> steps;
    std::vector<WorkflowOutput> outputs;
    /// Names used as `$name` in steps, outputs and defaults, including those that could not be read.
    std::set<std::string> mentions;
};

/// The workflow in `text`. Errors go to `diagnostics`; everything that could be read is returned.
Workflow parse_workflow(const std::string& text, Diagnostics& diagnostics);

/// A value, a list of values, `$name` (also within a list) or `{sweep: [value, …]}`. Wrong values are reported and left
/// out.
ValueExpression value_expression(const YamlNode& node, Diagnostics& diagnostics);
/// A value as in a workflow, from the command line: "0.1 %diag", "[0, 1]", "{sweep: [1, 2]}".
ValueExpression parse_value_expression(const std::string& text, Diagnostics& diagnostics);
/// Reports uses of parameters, which are not allowed here, and removes their values. `what` begins the message.
void refuse_uses(ValueExpression& value, std::string_view what, Diagnostics& diagnostics);

}  // namespace scanmill
