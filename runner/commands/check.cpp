// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "commands/load.hpp"
#include "output/error_output.hpp"
#include "output/plan_output.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/batch/plan_batch.hpp"
#include "scanmill/workflow/document.hpp"

namespace scanmill::runner {

namespace {

struct Options {
    std::vector<std::string> files, settings;
    bool plan = false, json = false;
    std::string format = "text";
};

/// One file after the other: findings as they come, or all as JSON at the end.
class Checker {
public:
    explicit Checker(const Options& options)
        : options_(options),
          as_json_(options.json || options.format == "json"),
          library_(open_library()),
          settings_(parse_settings(options.settings)) {}

    int check() {
        for (const std::string& file : options_.files) {
            try {
                const std::string text = read_workflow_file(file);
                if (is_batch(text))
                    check_one_batch(file, text);
                else
                    check_one_workflow(file, text);
            } catch (const Error& error) {
                code_ = bad_request;
                if (as_json_)
                    entries_.push_back(unreadable_json(file, error));
                else
                    print(error, false);
            }
        }
        if (as_json_) print_files_json(std::move(entries_));
        return code_;
    }

private:
    void check_one_workflow(const std::string& file, const std::string& text) {
        const CheckedWorkflow checked = check_workflow(file, text, library_, settings_);
        const bool sound = report(checked.diagnostics);
        if (!sound) return;
        if (options_.plan)
            show(checked.plan);
        else
            say("{}: ok, {}, {}\n", file, count_text(checked.plan.steps.size(), "step", "steps"),
                count_text(checked.plan.variants.size(), "variant", "variants"));
    }

    void check_one_batch(const std::string& file, const std::string& text) {
        if (!settings_.empty())
            throw Error("'{}' is a batch, which --set does not reach; write the values under its `set:`", file);
        const CheckedBatch checked = check_batch(text, file, library_);
        for (const Diagnostics& diagnostics : checked.diagnostics) report(diagnostics);
        if (checked.has_errors()) return;
        if (options_.plan)
            for (const BatchPart& part : checked.parts) show(*part.plan);
        else
            say("{}: ok, {}, {}, {}, {}\n", file, count_text(checked.batch.scans.size(), "scan", "scans"),
                count_text(checked.batch.workflows.size(), "workflow", "workflows"),
                count_text(checked.variants(), "variant", "variants"), count_text(checked.cells(), "cell", "cells"));
    }

    /// Whether nothing is wrong.
    bool report(const Diagnostics& diagnostics) {
        if (diagnostics.has_errors()) code_ = bad_request;
        if (as_json_)
            entries_.push_back(to_json(diagnostics));
        else
            print(diagnostics);
        return !diagnostics.has_errors();
    }

    /// As JSON a plan belongs to the file that was reported for its workflow.
    void show(const Plan& plan) {
        if (!as_json_) {
            fmt::print("{}", options_.format == "dot" ? plan_dot(plan) : plan_text(plan));
            return;
        }
        for (auto entry = entries_.rbegin(); entry != entries_.rend(); ++entry)
            if ((*entry)["file"] == plan.workflow.file) {
                auto json = nlohmann::ordered_json::parse(plan_json(plan));
                if (entry->contains("plan"))
                    (*entry)["further-plans"].push_back(std::move(json));
                else
                    (*entry)["plan"] = std::move(json);
                return;
            }
    }

    template <class... Arguments>
    void say(fmt::format_string<Arguments...> line, Arguments&&... arguments) {
        if (!as_json_) fmt::print(line, std::forward<Arguments>(arguments)...);
    }

    const Options& options_;
    bool as_json_;
    FilterLibrary library_;
    Settings settings_;
    nlohmann::ordered_json entries_ = nlohmann::ordered_json::array();
    int code_ = done;
};

}  // namespace

void add_check(CLI::App& app, Action& chosen) {
    CLI::App* command = app.add_subcommand("check", "Checks workflow and batch files without opening any scan");
    auto options = std::make_shared<Options>();
    command->add_option("FILE", options->files, "Workflow or batch files")->required();
    command->add_option("--set", options->settings, "A workflow parameter's value, NAME=VALUE")->take_all();
    CLI::Option* plan =
        command->add_flag("--plan", options->plan, "Print the steps of every variant and what feeds them");
    command->add_option("--format", options->format, "Of the plan: text, dot (for Graphviz) or json")
        ->needs(plan)
        ->check(CLI::IsMember({"text", "dot", "json"}));
    command->add_flag("--json", options->json, "Print the findings as JSON");
    command->callback([&chosen, options] { chosen = [options] { return Checker(*options).check(); }; });
}

}  // namespace scanmill::runner
