// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plan/expand.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <set>
#include <utility>

#include "scanmill/base/text.hpp"

namespace scanmill {

namespace {

constexpr std::size_t most_variants = 10'000;
constexpr std::size_t most_steps =
    500'000;  // in all variants together; every step takes time and memory, even if variants share it

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

/// Decides at every fork which branch to follow.
class Choices {
public:
    virtual ~Choices() = default;
    /// Returns a branch, 0 … count - 1. `fork` identifies the fork within the workflow.
    virtual std::size_t choose(const void* fork, std::size_t count) = 0;
};

/// Yields every combination of branches once. The branch of the last fork changes fastest.
class EveryCombination : public Choices {
public:
    std::size_t choose(const void*, std::size_t count) override {
        if (count <= 1) return 0;
        if (next_ == made_.size()) made_.push_back({0, count});
        return made_[next_++].choice;
    }
    /// Moves to the next combination; false after the last.
    bool advance() {
        next_ = 0;
        while (!made_.empty() && made_.back().choice + 1 == made_.back().count) made_.pop_back();
        if (made_.empty()) return false;
        ++made_.back().choice;
        return true;
    }

private:
    struct Made {
        std::size_t choice, count;
    };
    std::vector<Made> made_;
    std::size_t next_ = 0;  // index into made_ of the fork to decide next
};

/// Takes the next branch each time a fork is reached, until every branch of every fork was taken at least once.
class EachOnce : public Choices {
public:
    std::size_t choose(const void* fork, std::size_t count) override {
        return forks_.try_emplace(fork, Fork{0, count}).first->second.reached++ % count;
    }
    bool advance() {
        const auto is_done = [](const auto& fork) { return fork.second.reached >= fork.second.count; };
        return ++rounds_ < most_variants && !std::ranges::all_of(forks_, is_done);
    }

private:
    struct Fork {
        std::size_t reached, count;
    };
    std::map<const void*, Fork> forks_;
    std::size_t rounds_ = 0;
};

/// One path through the workflow: the variant that `choices` leads to.
class Walk {
public:
    Walk(const Workflow& workflow, const Settings& settings, Choices& choices)
        : workflow_(workflow),
          settings_(settings),
          choices_(choices) {}

    Variant variant() {
        follow(workflow_.steps);
        variant_.name = name_parts_.empty() ? "default" : fmt::format("{}", fmt::join(name_parts_, "+"));
        return std::move(variant_);
    }

private:
    void follow(const std::vector<StepItem>& items) {
        for (const StepItem& item : items) {
            if (const auto* step = std::get_if<StepSyntax>(&item.item))
                variant_.steps.push_back({step, arguments(*step), {}});
            else
                follow(std::get<OneOfSyntax>(item.item));
        }
    }

    void follow(const OneOfSyntax& fork) {
        if (fork.alternatives.empty()) return;
        const AlternativeSyntax& taken = fork.alternatives[choices_.choose(&fork, fork.alternatives.size())];
        if (!taken.name.empty()) name_parts_.push_back(file_safe(taken.name));
        const std::size_t before = variant_.steps.size();
        follow(taken.steps);
        if (!fork.id.empty() && variant_.steps.size() > before) variant_.steps.back().aliases.push_back(fork.id);
    }

    std::vector<ChosenArgument> arguments(const StepSyntax& step) {
        std::vector<ChosenArgument> all;
        for (const NamedExpression& parameter : step.parameters) {
            const std::vector<WrittenValue>& values = parameter.value.values;
            if (values.empty()) continue;  // no value could be read
            const WrittenValue& written = values[choices_.choose(&values, values.size())];
            const std::size_t parts = name_parts_.size();
            std::optional<ChosenArgument> argument = replaced(step, parameter, written);
            if (!argument) continue;  // its `$name` is unknown or has no valid value
            const bool is_named =
                !written.literal.list && name_parts_.size() > parts;  // replaced() added the swept `$name`
            if (parameter.value.sweep && !is_named) name_sweep(step, parameter.name, argument->value);
            all.push_back(std::move(*argument));
        }
        return all;
    }

    std::optional<ChosenArgument> replaced(const StepSyntax& step, const NamedExpression& parameter,
                                           const WrittenValue& written) {
        ChosenArgument argument{&parameter, &written, written.literal, {}};
        for (const NameUse& use : written.uses) {
            const WrittenValue* value = referenced(step, use.name);
            if (!value || (written.literal.list && value->literal.list)) return std::nullopt;
            argument.replaced.push_back({&use, value});
            if (written.literal.list)
                argument.value.items[use.item] = value->literal.items.front();
            else
                argument.value = value->literal;
        }
        return argument;
    }

    /// The value of `$name`. A swept parameter keeps the value that was chosen at its first use.
    const WrittenValue* referenced(const StepSyntax& step, const std::string& name) {
        if (const auto bound = bound_.find(name); bound != bound_.end()) return bound->second;
        const auto setting = settings_.find(name);
        const auto parameter = std::ranges::find(workflow_.parameters, name, &WorkflowParameter::name);
        if (parameter == workflow_.parameters.end()) return nullptr;
        const std::vector<WrittenValue>& values =
            setting != settings_.end() ? setting->second.values : parameter->value.values;
        if (values.empty()) return nullptr;
        const WrittenValue* chosen = &values[choices_.choose(&values, values.size())];
        if (values.size() > 1) {
            bound_.emplace(name, chosen);
            name_sweep(step, name, chosen->literal);
        }
        return chosen;
    }

    /// Adds `name=value` to the variant's name. If the name appears already, puts the step's name before it.
    void name_sweep(const StepSyntax& step, const std::string& name, const WrittenParameter& value) {
        const std::string label = swept_.contains(name) ? step.name() + "." + name : name;
        swept_.insert(name);
        name_parts_.push_back(file_safe(label + "=" + fmt::format("{}", fmt::join(value.items, ","))));
    }

    const Workflow& workflow_;
    const Settings& settings_;
    Choices& choices_;
    Variant variant_;
    std::vector<std::string> name_parts_;
    std::set<std::string> swept_;  // names that appear in name_parts_
    std::map<std::string, const WrittenValue*> bound_;  // chosen values of swept workflow parameters
};

/// Calls `visit` with variants until it returns false.
template <class Order>
void visit_all(const Workflow& workflow, const Settings& settings, const std::function<bool(const Variant&)>& visit) {
    Order choices;
    while (visit(Walk(workflow, settings, choices).variant()) && choices.advance()) {
    }
}

/// Names the exceeded limit, as "more than 7 variants"; empty if no limit is exceeded.
std::string excess(const Workflow& workflow, const Settings& settings) {
    std::size_t variants = 0, steps = 0;
    visit_all<EveryCombination>(workflow, settings, [&](const Variant& variant) {
        steps += variant.steps.size();
        return ++variants <= most_variants && steps <= most_steps;
    });
    return variants > most_variants ? fmt::format("more than {} variants", most_variants)
           : steps > most_steps     ? fmt::format("more than {} steps in all its variants", most_steps)
                                    : "";
}

/// Checks that every `$name` and every setting is a declared parameter. A `$name` within a list must be a single value,
/// and one under `expect` must not be swept. Warns about declared parameters that the file does not use.
class ReferenceCheck {
public:
    ReferenceCheck(const Workflow& workflow, const Settings& settings, Diagnostics& diagnostics)
        : diagnostics_(diagnostics),
          parameters_(workflow.parameters) {
        for (const WorkflowParameter& parameter : parameters_) {
            const auto setting = settings.find(parameter.name);
            const ValueExpression& given = setting != settings.end() ? setting->second : parameter.value;
            const auto is_list = [](const WrittenValue& value) { return value.literal.list; };
            if (std::ranges::any_of(given.values, is_list)) lists_.insert(parameter.name);
            if (given.sweep) swept_.insert(parameter.name);
            if (!workflow.mentions.contains(parameter.name))
                diagnostics_.warning(parameter.position,
                                     fmt::format("no step uses the parameter '{}'", parameter.name));
        }
        check(workflow.steps);
        for (const auto& [name, value] : settings) require_declared(name, {});
    }

private:
    void require_declared(const std::string& name, Position position) {
        if (std::ranges::find(parameters_, name, &WorkflowParameter::name) == parameters_.end())
            diagnostics_.error(position, "the workflow has no parameter '{}'; {}", name, it_has(parameters_, name));
    }

    void check(const std::vector<StepItem>& items) {
        for (const StepItem& item : items) {
            if (const auto* fork = std::get_if<OneOfSyntax>(&item.item)) {
                for (const AlternativeSyntax& alternative : fork->alternatives) check(alternative.steps);
                continue;
            }
            check(std::get<StepSyntax>(item.item).expect);
            for (const NamedExpression& parameter : std::get<StepSyntax>(item.item).parameters)
                for (const WrittenValue& written : parameter.value.values)
                    for (const NameUse& use : written.uses) {
                        require_declared(use.name, use.position);
                        if (written.literal.list && lists_.contains(use.name))
                            diagnostics_.error(use.position,
                                               "${0} is a list, which cannot be part of a list; expected a "
                                               "single value, or the whole list as `{1}: ${0}`",
                                               use.name, parameter.name);
                    }
        }
    }

    /// Variants may share a step, so its conditions cannot depend on the variant.
    void check(const std::vector<Expectation>& expectations) {
        for (const Expectation& expectation : expectations)
            for (const NameUse& use : expectation.uses) {
                require_declared(use.name, use.position);
                if (lists_.contains(use.name))
                    diagnostics_.error(use.position, "expect {}: ${} is a list; a condition needs a single value",
                                       expectation.name, use.name);
                else if (swept_.contains(use.name))
                    diagnostics_.error(use.position,
                                       "expect {}: ${} is swept, and variants share the condition; expected a "
                                       "parameter with one value",
                                       expectation.name, use.name);
            }
    }

    Diagnostics& diagnostics_;
    const std::vector<WorkflowParameter>& parameters_;
    std::set<std::string> lists_, swept_;
};

/// An alternative with the name of an earlier one of the same fork; null if there is none.
const AlternativeSyntax* repeated_alternative(const std::vector<StepItem>& items) {
    for (const StepItem& item : items) {
        const auto* fork = std::get_if<OneOfSyntax>(&item.item);
        if (!fork) continue;
        std::set<std::string> names;
        for (const AlternativeSyntax& alternative : fork->alternatives) {
            if (!alternative.name.empty() && !names.insert(file_safe(alternative.name)).second) return &alternative;
            if (const AlternativeSyntax* nested = repeated_alternative(alternative.steps)) return nested;
        }
    }
    return nullptr;
}

void report_equal_variants(const Variant& variant, const Workflow& workflow, Diagnostics& diagnostics) {
    const AlternativeSyntax* repeated = repeated_alternative(workflow.steps);
    if (!repeated) {
        diagnostics.error(variant.steps.empty() ? Position{} : variant.steps.back().syntax->position,
                          "two variants are called '{}'; remove the value that is repeated in a sweep", variant.name);
        return;
    }
    const auto* step = std::get_if<StepSyntax>(&repeated->steps.front().item);
    const bool is_named_by_step = repeated->steps.size() == 1 && step && step->name() == repeated->name;
    diagnostics.error(repeated->position, "two variants are called '{}', since two alternatives are called '{}'; {}",
                      variant.name, repeated->name,
                      is_named_by_step
                          ? fmt::format("add `id:` with another name to one of them, as `- {{id: {}-2, {}: …}}`",
                                        repeated->name, step->filter)
                          : "change the `name:` of one of them");
}

}  // namespace

std::vector<std::string> undeclared(const Settings& settings, const Workflow& workflow) {
    std::vector<std::string> names;
    for (const auto& [name, value] : settings)
        if (std::ranges::find(workflow.parameters, name, &WorkflowParameter::name) == workflow.parameters.end())
            names.push_back(name);
    return names;
}

void expand(const Workflow& workflow, const Settings& settings, Diagnostics& diagnostics,
            const std::function<void(const Variant&)>& visit) {
    ReferenceCheck(workflow, settings, diagnostics);
    if (const std::string limit = excess(workflow, settings); !limit.empty()) {
        diagnostics.error({}, "has " + limit + "; sweep over fewer values");
        std::size_t steps = 0;
        visit_all<EachOnce>(workflow, settings, [&](const Variant& variant) {
            visit(variant);
            return (steps += variant.steps.size()) <= most_steps;
        });
        return;
    }
    std::set<std::string> names;
    bool is_reported = false;  // report only one pair: a value repeated in a sweep gives many
    visit_all<EveryCombination>(workflow, settings, [&](const Variant& variant) {
        if (!names.insert(variant.name).second && !std::exchange(is_reported, true))
            report_equal_variants(variant, workflow, diagnostics);
        visit(variant);
        return true;
    });
}

}  // namespace scanmill
