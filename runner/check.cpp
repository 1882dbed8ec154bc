// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "error_output.hpp"
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

int check(const Options& options) {
    const FilterLibrary library = open_library();
    const Settings settings = parse_settings(options.settings);
    auto files = nlohmann::ordered_json::array();
    const bool as_json = options.json || options.format == "json";
    int code = done;
    for (const std::string& file : options.files) {
        try {
            const CheckedWorkflow checked = check_workflow(file, library, settings);
            const bool sound = !checked.diagnostics.has_errors();
            if (!sound) code = bad_request;
            if (as_json) {
                nlohmann::ordered_json entry = to_json(checked.diagnostics);
                if (sound && options.plan) entry["plan"] = nlohmann::ordered_json::parse(plan_json(checked.plan));
                files.push_back(std::move(entry));
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
                files.push_back(unreadable_json(file, error));
            else
                print(error, false);
        }
    }
    if (as_json) print_files_json(std::move(files));
    return code;
}

}  // namespace

void add_check(CLI::App& app, Action& chosen) {
    CLI::App* command = app.add_subcommand("check", "Checks workflow files without opening any scan");
    auto options = std::make_shared<Options>();
    command->add_option("FILE", options->files, "Workflow files")->required();
    command->add_option("--set", options->settings, "A workflow parameter's value, NAME=VALUE")->take_all();
    CLI::Option* plan =
        command->add_flag("--plan", options->plan, "Print the steps of every variant and what feeds them");
    command->add_option("--format", options->format, "Of the plan: text, dot (for Graphviz) or json")
        ->needs(plan)
        ->check(CLI::IsMember({"text", "dot", "json"}));
    command->add_flag("--json", options->json, "Print the findings as JSON");
    command->callback([&chosen, options] { chosen = [options] { return check(*options); }; });
}

}  // namespace scanmill::runner
