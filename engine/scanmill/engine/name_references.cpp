// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/name_references.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "scanmill/filter/suggestion.hpp"

namespace scanmill {

namespace {

class References {
public:
    References(const Workflow& workflow, const Settings& settings, Diagnostics& diagnostics)
        : diagnostics_(diagnostics) {
        for (const WorkflowParameter& parameter : workflow.parameters) {
            names_.push_back(parameter.name);
            const auto setting = settings.find(parameter.name);
            const ValueExpression& given = setting != settings.end() ? setting->second : parameter.value;
            const auto is_list = [](const WrittenValue& value) { return value.literal.list; };
            if (std::ranges::any_of(given.values, is_list)) lists_.insert(parameter.name);
        }
        look_at(workflow.steps);
        // Where a name stands in what could not be read, or where it must not, that is said already.
        for (const WorkflowParameter& parameter : workflow.parameters)
            if (!workflow.mentions.contains(parameter.name))
                diagnostics_.warning(parameter.position,
                                     fmt::format("no step uses the parameter '{}'", parameter.name));
    }

    void require_known(const std::string& name, Position position) const {
        if (std::ranges::find(names_, name) != names_.end()) return;
        diagnostics_.error(position, fmt::format("the workflow has no parameter '{}'; {}{}", name,
                                                 names_.empty() ? "it declares none" : "it has " + enumerated(names_),
                                                 did_you_mean(name, names_)));
    }

private:
    void look_at(const std::vector<StepItem>& items) {
        for (const StepItem& item : items) {
            if (const auto* fork = std::get_if<OneOfSyntax>(&item.item)) {
                for (const AlternativeSyntax& alternative : fork->alternatives) look_at(alternative.steps);
                continue;
            }
            for (const NamedExpression& parameter : std::get<StepSyntax>(item.item).parameters)
                for (const WrittenValue& written : parameter.value.values)
                    for (const NameUse& use : written.uses) {
                        require_known(use.name, use.position);
                        if (written.literal.list) require_single(use, parameter.name);
                    }
        }
    }

    void require_single(const NameUse& use, const std::string& parameter) const {
        if (lists_.contains(use.name))
            diagnostics_.error(use.position, fmt::format("${0} is a list, which cannot stand within a list; expected a "
                                                         "single value, or the whole list as `{1}: ${0}`",
                                                         use.name, parameter));
    }

    Diagnostics& diagnostics_;
    std::vector<std::string> names_;
    std::set<std::string> lists_;
};

}  // namespace

void check_references(const Workflow& workflow, const Settings& settings, Diagnostics& diagnostics) {
    const References references(workflow, settings, diagnostics);
    for (const auto& [name, value] : settings) references.require_known(name, {});
}

}  // namespace scanmill
