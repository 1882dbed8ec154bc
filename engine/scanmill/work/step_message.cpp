// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/work/step_message.hpp"

#include <algorithm>

#include "scanmill/engine/expectation.hpp"
#include "scanmill/filter/error.hpp"

namespace scanmill {

using Json = nlohmann::json;

namespace {

Json to_json(const WrittenParameter& value) { return {value.items, value.list}; }

/// One end of an expectation; there may be none.
Json end_of(const ParameterValue& value) {
    return std::holds_alternative<std::monostate>(value) ? Json() : to_json(written(value));
}

ParameterValue end_from(const Json& json, Unit unit) {
    if (json.is_null()) return {};
    return parse(written_as(unit), {json.at(0).get<std::vector<std::string>>(), json.at(1).get<bool>()});
}

}  // namespace

Json rows_of(const ParameterSet& parameters) {
    Json rows = Json::array();
    for (const auto& [name, value] : parameters.values) {
        if (std::holds_alternative<std::monostate>(value)) continue;
        const WrittenParameter text = written(value);
        rows.push_back({name, text.items, text.list});
    }
    return rows;
}

ParameterSet parameters_from(const Json& rows, const FilterSpec& spec) {
    ParameterSet set;
    for (const ParameterSpec& parameter : spec.parameters) {
        const auto row = std::ranges::find_if(rows, [&](const Json& each) { return each.at(0) == parameter.name; });
        set.values.emplace_back(
            parameter.name,
            row == rows.end() ? ParameterValue()
                              : parse(parameter, {row->at(1).get<std::vector<std::string>>(), row->at(2).get<bool>()}));
    }
    return set;
}

Json to_json(const PlannedStep& step) {
    Json json{{"filter", step.spec.name},
              {"version", step.spec.version},
              {"label", step.label},
              {"parameters", rows_of(step.parameters)},
              {"expect", Json::array()}};
    for (const PlannedExpectation& expected : step.expectations)
        json["expect"].push_back({expected.name, static_cast<int>(expected.relation), static_cast<int>(expected.unit),
                                  end_of(expected.low), end_of(expected.high), expected.text});
    return json;
}

std::shared_ptr<const PlannedStep> step_from(const Json& json, const FilterLibrary& library) {
    const std::string name = json.at("filter");
    const FilterSpec* spec = library.find(name);
    if (!spec || spec->version != json.at("version").get<int>())
        throw Error("the filter {} changed while the run was going on", name).hint("run it again");
    auto step = std::make_shared<PlannedStep>();
    step->label = json.at("label");
    step->spec = *spec;
    step->parameters = parameters_from(json.at("parameters"), *spec);
    for (const Json& row : json.at("expect")) {
        const Unit unit = static_cast<Unit>(row.at(2).get<int>());
        step->expectations.push_back({row.at(0),
                                      {},
                                      static_cast<Expectation::Relation>(row.at(1).get<int>()),
                                      unit,
                                      end_from(row.at(3), unit),
                                      end_from(row.at(4), unit),
                                      row.at(5)});
    }
    return step;
}

}  // namespace scanmill
