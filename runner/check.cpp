// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "load.hpp"
#include "plan_output.hpp"
#include "scanmill/filter/error.hpp"

namespace scanmill::runner {

namespace {

struct Options {
    std::vector<std::string> files, settings;
    bool plan = false, json = false;
    std::string format = "text";
};

nlohmann::ordered_json to_json(const Diagnostics& diagnostics) {
    auto json = nlohmann::ordered_json::array();
    for (const Diagnostic& diagnostic : diagnostics.sorted())
        json.push_back({{"severity", diagnostic.severity == Diagnostic::Severity::error ? "error" : "warning"},
                        {"line", diagnostic.position.line},
                        {"column", diagnostic.position.column},
                        {"message", diagnostic.message}});
    return json;
}

int check(const Options& options) {
    const FilterLibrary library = open_library();
    const Settings settings = parse_settings(options.settings);
    nlohmann::ordered_json json{{"scanmill", 1}, {"files", nlohmann::ordered_json::array()}};
    const bool as_json = options.json || (options.plan && options.format == "json");
    int code = done;
    for (const std::string& file : options.files) {
        try {
            const CheckedWorkflow checked = check_workflow(file, library, settings);
            const bool sound = !checked.diagnostics.has_errors();
            if (!sound) code = bad_request;
            if (as_json) {
                nlohmann::ordered_json entry{
                    {"file", file}, {"ok", sound}, {"diagnostics", to_json(checked.diagnostics)}};
                if (sound && options.plan) entry["plan"] = nlohmann::ordered_json::parse(plan_json(checked.plan));
                json["files"].push_back(std::move(entry));
                continue;
            }
            print(checked.diagnostics);
            if (!sound) continue;
            if (options.plan)
                fmt::print("{}", options.format == "dot" ? plan_dot(checked.plan) : plan_text(checked.plan));
            else
                fmt::print("{}: ok, {} step{}, {} variant{}\n", file, checked.plan.steps.size(),
                           checked.plan.steps.size() == 1 ? "" : "s", checked.plan.variants.size(),
                           checked.plan.variants.size() == 1 ? "" : "s");
        } catch (const Error& error) {
            code = bad_request;
            if (as_json)
                json["files"].push_back(
                    {{"file", file},
                     {"ok", false},
                     {"diagnostics",
                      {{{"severity", "error"}, {"line", 0}, {"column", 0}, {"message", error.sentence()}}}}});
            else
                fmt::print(stderr, "error: {}\n", error.what());
        }
    }
    if (as_json) fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
    return code;
}

}  // namespace

void add_check(CLI::App& app, Action& chosen) {
    CLI::App* command = app.add_subcommand("check", "Checks workflow files without opening any scan");
    auto options = std::make_shared<Options>();
    command->add_option("FILE", options->files, "Workflow files")->required();
    command->add_option("--set", options->settings, "A workflow parameter's value, NAME=VALUE")->take_all();
    command->add_flag("--plan", options->plan, "Print the steps of every variant and what feeds them");
    command->add_option("--format", options->format, "Of the plan: text, dot (for Graphviz) or json")
        ->check(CLI::IsMember({"text", "dot", "json"}));
    command->add_flag("--json", options->json, "Print the findings as JSON");
    command->callback([&chosen, options] { chosen = [options] { return check(*options); }; });
}

}  // namespace scanmill::runner
