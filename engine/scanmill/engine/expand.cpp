// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/expand.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "scanmill/filter/suggestion.hpp"

namespace scanmill {

namespace {

constexpr std::size_t most_variants = 10'000;

std::string file_safe(std::string_view text) {
    std::string safe;
    for (char c : text) {
        if (c == '%')
            safe += "pct";
        else if (std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '_' || c == '-' || c == '=')
            safe += c;
        else if (c == ',' || c == '/')
            safe += '_';
    }
    return safe;
}

std::string written_text(const WrittenParameter& value) {
    std::string text;
    for (const std::string& item : value.items) text += (text.empty() ? "" : ",") + item;
    return text;
}

struct TooManyVariants {};

/// Walks the steps depth first; each fork copies the state of the walk.
class Expander {
public:
    Expander(const Workflow& workflow, const Settings& settings, Diagnostics& diagnostics)
        : workflow_(workflow),
          settings_(settings),
          diagnostics_(diagnostics) {}

    std::vector<Variant> all() {
        for (const auto& [name, value] : settings_) require_known(name, {});
        State start;
        walk(workflow_.steps, 0, start, [this](State& end) { finish(end); });
        for (const WorkflowParameter& parameter : workflow_.parameters)
            if (!used_.contains(parameter.name))
                diagnostics_.warning(parameter.position,
                                     fmt::format("no step uses the parameter '{}'", parameter.name));
        return std::move(variants_);
    }

private:
    struct State {
        std::vector<std::string> name_parts;
        std::set<std::string> swept;                       // names that appear in name_parts
        std::map<std::string, const WrittenValue*> bound;  // swept workflow parameters, once chosen
        std::vector<ExpandedStep> steps;
    };
    using Continue = std::function<void(State&)>;

    void walk(const std::vector<StepItem>& items, std::size_t index, State& state, const Continue& then) {
        if (index == items.size()) {
            then(state);
            return;
        }
        const Continue rest = [&](State& next) { walk(items, index + 1, next, then); };
        if (const auto* step = std::get_if<StepSyntax>(&items[index].item)) {
            ExpandedStep expanded{step, {}, {}};
            arguments(*step, 0, std::move(expanded), state, rest);
            return;
        }
        const auto& fork = std::get<OneOfSyntax>(items[index].item);
        for (const AlternativeSyntax& alternative : fork.alternatives) {
            State branch = state;
            if (!alternative.name.empty()) branch.name_parts.push_back(file_safe(alternative.name));
            walk(alternative.steps, 0, branch, [&](State& end) {
                if (!fork.id.empty() && !end.steps.empty()) end.steps.back().aliases.push_back(fork.id);
                rest(end);
            });
        }
    }

    /// Fixes the step's parameters from `index` on, forking at every sweep.
    void arguments(const StepSyntax& step, std::size_t index, ExpandedStep expanded, State& state,
                   const Continue& then) {
        if (index == step.parameters.size()) {
            State next = state;
            next.steps.push_back(std::move(expanded));
            then(next);
            return;
        }
        const NamedExpression& parameter = step.parameters[index];
        for (const WrittenValue& written : parameter.value.values) {
            State branch = state;
            const std::string* reference = nullptr;
            std::vector<const WrittenValue*> candidates{&written};
            if (!written.reference.empty()) {
                candidates = referenced(written, branch);
                reference = &written.reference;
                if (candidates.empty()) return;  // unknown, and reported
            }
            for (const WrittenValue* value : candidates) {
                State chosen = branch;
                if (candidates.size() > 1) {
                    chosen.bound[*reference] = value;
                    add_swept(chosen, step, *reference, *value);
                } else if (parameter.value.sweep) {
                    add_swept(chosen, step, parameter.name, *value);
                }
                ExpandedStep with = expanded;
                with.arguments.push_back({parameter.name, parameter.position, value->literal, written.position,
                                          reference ? *reference : std::string()});
                arguments(step, index + 1, std::move(with), chosen, then);
            }
        }
        // An expression whose text was wrong has no values; it was reported when it was read.
        if (parameter.value.values.empty()) arguments(step, index + 1, std::move(expanded), state, then);
    }

    /// The values that `$name` may take here: one, unless it is a sweep that this variant has not chosen from yet.
    std::vector<const WrittenValue*> referenced(const WrittenValue& written, const State& state) {
        if (!require_known(written.reference, written.position)) return {};
        used_.insert(written.reference);
        if (const auto found = state.bound.find(written.reference); found != state.bound.end()) return {found->second};
        const auto setting = settings_.find(written.reference);
        const ValueExpression& expression =
            setting != settings_.end()
                ? setting->second
                : std::ranges::find(workflow_.parameters, written.reference, &WorkflowParameter::name)->value;
        std::vector<const WrittenValue*> values;
        for (const WrittenValue& value : expression.values) values.push_back(&value);
        return values;
    }

    bool require_known(const std::string& name, Position position) {
        if (std::ranges::find(workflow_.parameters, name, &WorkflowParameter::name) != workflow_.parameters.end())
            return true;
        std::vector<std::string> names;
        for (const WorkflowParameter& parameter : workflow_.parameters) names.push_back(parameter.name);
        diagnostics_.error(position, fmt::format("the workflow has no parameter '{}'; {}{}", name,
                                                 names.empty() ? "it declares none" : "it has " + enumerated(names),
                                                 did_you_mean(name, names)));
        return false;
    }

    static void add_swept(State& state, const StepSyntax& step, const std::string& name, const WrittenValue& value) {
        // A second sweep of the same name tells whose it is.
        const std::string label =
            state.swept.contains(name) ? (step.id.empty() ? step.filter : step.id) + "." + name : name;
        state.swept.insert(name);
        state.name_parts.push_back(file_safe(label + "=" + written_text(value.literal)));
    }

    void finish(State& state) {
        if (variants_.size() == most_variants) throw TooManyVariants{};
        Variant variant;
        for (const std::string& part : state.name_parts) variant.name += (variant.name.empty() ? "" : "+") + part;
        if (variant.name.empty()) variant.name = "default";
        if (!names_.insert(variant.name).second)
            diagnostics_.error(
                state.steps.empty() ? Position{} : state.steps.back().syntax->position,
                fmt::format("two variants are called '{}'; give their alternatives different names", variant.name));
        variant.steps = std::move(state.steps);
        variants_.push_back(std::move(variant));
    }

    const Workflow& workflow_;
    const Settings& settings_;
    Diagnostics& diagnostics_;
    std::set<std::string> used_;
    std::set<std::string> names_;
    std::vector<Variant> variants_;
};

}  // namespace

std::vector<Variant> expand(const Workflow& workflow, const Settings& settings, Diagnostics& diagnostics) {
    try {
        return Expander(workflow, settings, diagnostics).all();
    } catch (const TooManyVariants&) {
        diagnostics.error({}, fmt::format("has more than {} variants; sweep over fewer values", most_variants));
        return {};
    }
}

}  // namespace scanmill
