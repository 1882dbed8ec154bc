// SPDX-License-Identifier: GPL-3.0-or-later
// Completion scripts, made from the commands that the program has.

#include <fmt/format.h>

#include <algorithm>

#include "commands/commands.hpp"

namespace scanmill::runner {

namespace {

struct Option {
    std::string name;  ///< "--set"
    std::string help;
    bool takes_value;
};

struct Command {
    std::string name, help;
    std::vector<Option> options;
};

std::vector<Command> commands_of(const CLI::App& app) {
    std::vector<Command> commands;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        Command described{command->get_name(), command->get_description(), {}};
        for (const CLI::Option* option : command->get_options())
            for (const std::string& name : option->get_lnames())
                described.options.push_back(
                    {"--" + name, option->get_description(), option->get_items_expected_max() > 0});
        commands.push_back(std::move(described));
    }
    return commands;
}

bool completes_filters(const Command& command) { return command.name == "show"; }

/// Words that the command takes in place of files; none where it takes files.
std::string_view words_of(const Command& command) {
    return command.name == "completion" ? "bash zsh fish" : command.name == "schema" ? "workflow batch" : "";
}

/// The text without what would end a quoted word of a shell, or has a meaning of its own in zsh's descriptions.
std::string plain(std::string_view text) {
    std::string result;
    for (char c : text) {
        if (c == '\'' || c == '`' || c == '\\') continue;
        result += c == ':' ? ',' : c == '[' ? '(' : c == ']' ? ')' : c;
    }
    return result;
}

std::string bash(const std::vector<Command>& commands) {
    std::string names, cases;
    for (const Command& command : commands) {
        names += (names.empty() ? "" : " ") + command.name;
        std::string options;
        for (const Option& option : command.options) options += (options.empty() ? "" : " ") + option.name;
        cases += fmt::format("        {}:-*) words=\"{}\" ;;\n", command.name, options);
        if (!words_of(command).empty())
            cases += fmt::format("        {}:*) words=\"{}\" ;;\n", command.name, words_of(command));
        if (completes_filters(command))
            cases += fmt::format("        {}:*) words=$(scanmill list --names 2>/dev/null) ;;\n", command.name);
    }
    return fmt::format(R"(_scanmill() {{
    local word=${{COMP_WORDS[COMP_CWORD]}} words
    case $([ "$COMP_CWORD" -gt 1 ] && echo "${{COMP_WORDS[1]}}"):$word in
        :*) words="{} --help --version" ;;
{}        *) mapfile -t COMPREPLY < <(compgen -f -- "$word"); return ;;
    esac
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}}
complete -o filenames -F _scanmill scanmill
)",
                       names, cases);
}

std::string zsh(const std::vector<Command>& commands) {
    std::string names, cases;
    for (const Command& command : commands) {
        names += fmt::format("        '{}:{}'\n", command.name, plain(command.help));
        cases += fmt::format("        {}) _arguments", command.name);
        for (const Option& option : command.options)
            cases +=
                fmt::format(" '*{}[{}]{}'", option.name, plain(option.help), option.takes_value ? ":value:_files" : "");
        cases += completes_filters(command)   ? " \"*:filter:($(scanmill list --names 2>/dev/null))\" ;;\n"
                 : !words_of(command).empty() ? fmt::format(" '1:word:({})' ;;\n", words_of(command))
                                              : " '*:file:_files' ;;\n";
    }
    return fmt::format(R"(#compdef scanmill
_scanmill() {{
    local -a commands=(
{}    )
    if (( CURRENT == 2 )); then
        _describe command commands
        return
    fi
    local command=$words[2]
    shift words
    (( CURRENT-- ))
    case $command in
{}    esac
}}
compdef _scanmill scanmill
)",
                       names, cases);
}

std::string fish(const std::vector<Command>& commands) {
    std::string text;
    for (const Command& command : commands) {
        text += fmt::format("complete -c scanmill -n __fish_use_subcommand -f -a {} -d '{}'\n", command.name,
                            plain(command.help));
        const std::string here = fmt::format("complete -c scanmill -n '__fish_seen_subcommand_from {}'", command.name);
        if (!words_of(command).empty()) text += fmt::format("{} -f -a '{}'\n", here, words_of(command));
        if (completes_filters(command)) text += here + " -f -a '(scanmill list --names 2>/dev/null)'\n";
        for (const Option& option : command.options)
            text += fmt::format("{} -l {}{} -d '{}'\n", here, option.name.substr(2), option.takes_value ? " -r" : "",
                                plain(option.help));
    }
    return text;
}

}  // namespace

void add_completion(CLI::App& app, Action& chosen) {
    CLI::App* command =
        app.add_subcommand("completion", "Prints a script that completes commands, options and filters");
    auto shell = std::make_shared<std::string>();
    command->add_option("SHELL", *shell, "bash, zsh or fish")
        ->required()
        ->check(CLI::IsMember({"bash", "zsh", "fish"}));
    command->footer(
        "In ~/.bashrc: source <(scanmill completion bash)\n"
        "In ~/.zshrc, after compinit: source <(scanmill completion zsh)\n"
        "In ~/.config/fish/config.fish: scanmill completion fish | source");
    command->callback([&chosen, &app, shell] {
        chosen = [&app, shell] {
            const std::vector<Command> commands = commands_of(app);
            fmt::print("{}", *shell == "bash" ? bash(commands) : *shell == "zsh" ? zsh(commands) : fish(commands));
            return done;
        };
    });
}

}  // namespace scanmill::runner
