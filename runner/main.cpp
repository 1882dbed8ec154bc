// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "commands/commands.hpp"
#include "output/error_output.hpp"
#include "output/terminal.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/worker/worker_processes.hpp"

namespace {

const CLI::App& innermost_command(const CLI::App& app) {
    const std::vector<CLI::App*> commands = app.get_subcommands();
    return commands.empty() ? app : innermost_command(*commands.front());
}

/// "; did you mean '--unit'?" An option that begins with the word comes before one that needs few edits.
std::string meant_option(const std::string& word, const std::vector<std::string>& names) {
    const auto longer = std::ranges::find_if(names, [&](const std::string& name) { return name.starts_with(word); });
    if (word.size() >= 2 && longer != names.end()) return "; did you mean '--" + *longer + "'?";
    std::string proposal = scanmill::did_you_mean(word, names);
    if (const std::size_t quote = proposal.find('\''); quote != std::string::npos) proposal.insert(quote + 1, "--");
    return proposal;
}

/// Reports the first argument that looks like a long option and is not one of the command's.
std::optional<scanmill::Error> unknown_option(const CLI::App& command, const std::vector<std::string>& arguments) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options())
        names.insert(names.end(), option->get_lnames().begin(), option->get_lnames().end());
    for (const std::string& argument : arguments) {
        if (argument == "--") break;
        if (!argument.starts_with("--")) continue;
        const std::string word = argument.substr(2, argument.find('=') - 2);
        if (std::ranges::find(names, word) != names.end()) continue;
        return scanmill::Error("{} has no option '--{}'{}", command.get_name(), word, meant_option(word, names));
    }
    return std::nullopt;
}

}  // namespace

int main(int argc, char** argv) {
    using namespace scanmill::runner;
    if (argc == 2 && argv[1] == std::string_view("worker")) return scanmill::serve_as_worker();
    // If the reader of the output closes it early, the program ends quietly, even if the caller ignores the signal.
    std::signal(SIGPIPE, SIG_DFL);
    // Ignoring this signal lets a write beyond the system's file size limit fail with an error code. Otherwise it would
    // end the program.
    std::signal(SIGXFSZ, SIG_IGN);
    CLI::App app("Scanmill turns libraries of 3D scans into surfaces, unattended.", "scanmill");
    app.set_version_flag("--version", "scanmill " SCANMILL_VERSION);
    app.require_subcommand(1);
    app.set_help_all_flag("--help-all", "Help of every command");
    const bool json = std::any_of(
        argv, argv + argc, [](std::string_view argument) { return argument == "--json" || argument == "--events"; });
    Action chosen;
    add_run_and_batch(app, chosen, {argv, argv + argc});
    add_export(app, chosen);
    add_check(app, chosen);
    add_list_and_show(app, chosen);
    add_info(app, chosen);
    add_convert(app, chosen);
    add_measure(app, chosen);
    add_schema_and_docs(app, chosen);
    add_runs(app, chosen, {argv, argv + argc});
    add_report(app, chosen);
    add_cache(app, chosen);
    add_completion(app, chosen);
    try {
        app.parse(argc, argv);
        const int code = chosen();
        if (std::fflush(stdout) == 0) return code;
        print_stderr("error: the output could not be written\n");
        return our_fault;
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
        const auto commands = app.get_subcommands();
        scanmill::Error described = unknown_option(innermost_command(app), {argv + std::min(argc, 1), argv + argc})
                                        .value_or(scanmill::Error(std::string(error.what())));
        described.set_hint("scanmill " + (commands.empty() ? "" : commands.front()->get_name() + " ") + "--help");
        if (const std::string word = argc > 1 ? argv[1] : ""; commands.empty() && !word.empty() && word[0] != '-') {
            std::vector<std::string> names;
            for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
                names.push_back(command->get_name());
            described = scanmill::Error("there is no command '{}'{}", word, scanmill::did_you_mean(word, names))
                            .hint("scanmill --help");
        }
        print(described, json);
        return bad_request;
    } catch (const scanmill::Error& error) {
        print(error, json);
        return bad_request;
    } catch (const std::exception& error) {
        print(scanmill::Error("an unexpected error: {}", error.what()), json);
        return our_fault;
    }
}
