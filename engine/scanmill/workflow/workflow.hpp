// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The syntax tree of a workflow file: every element as written, with its position. make_plan() resolves the names
/// against the installed filters later.

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
    std::size_t item = 0;  ///< index into `literal.items`, where the text stays empty until the value replaces it
};

/// One value as written: a text or a list of texts. Each text is a literal or the use of a workflow parameter.
struct WrittenValue {
    Position position;
    WrittenParameter literal;
    std::vector<NameUse> uses;
};

/// A value, or the values of `{sweep: [value, …]}`. The workflow has one variant per value of a sweep.
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
    /// Ends that are a workflow parameter; NameUse::item is 0 for `value` and 1 for `high`, which stay empty.
    std::vector<NameUse> uses{};
};

struct StepSyntax {
    std::string filter;
    Position position;
    std::string id;
    std::vector<NamedExpression> parameters;
    std::vector<InputWiring> in;
    std::optional<Reference> in_shorthand;  ///< `in: scan`, for filters with one port
    std::vector<Expectation> expect;
    std::string file{};  ///< contains the positions; empty: the workflow file
    bool may_be_left_out = false;  ///< variants that lack a value named by `in` omit the step

    /// The name by which other steps refer to this step.
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
    std::string frame;  ///< may contain {stem}; empty: the frame in the file
    InvalidRows invalid = InvalidRows::by_format;  ///< only for points
    std::string help;
    std::vector<Kind> also{};  ///< other kinds that the input's file may hold
    bool by_name = false;      ///< feeds only ports that name this input in `in`
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
    bool may_be_left_out = false;  ///< variants without the step named by `source` omit the output
};

struct Workflow {
    std::string file;
    std::string name;
    std::string summary;
    std::vector<WorkflowInput> inputs;  ///< the first takes the scans: one per run, or all of them if it is a list
    std::vector<WorkflowParameter> parameters;
    std::vector<StepItem> steps;
    std::vector<WorkflowOutput> outputs;
    /// Names used as `$name` in steps, outputs and defaults, also in parts that could not be read.
    std::set<std::string> mentions;
};

/// Parses `text`. Errors go to `diagnostics`; the result holds everything that could be read.
Workflow parse_workflow(const std::string& text, Diagnostics& diagnostics);

/// Reads a value, a list of values, `$name` (also within a list) or `{sweep: [value, …]}`. Reports wrong values and
/// leaves them out.
ValueExpression value_expression(const YamlNode& node, Diagnostics& diagnostics);
/// Parses a value from the command line, written as in a workflow: "0.1 %diag", "[0, 1]", "{sweep: [1, 2]}".
ValueExpression parse_value_expression(const std::string& text, Diagnostics& diagnostics);
/// Reports every value that uses a workflow parameter, and removes it. `what` begins the message: "a default".
void refuse_uses(ValueExpression& value, std::string_view what, Diagnostics& diagnostics);

}  // namespace scanmill
