// SPDX-License-Identifier: GPL-3.0-or-later
// Completion scripts, generated from the program's commands and options.

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "commands/commands.hpp"
#include "commands/common.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/batch/batch.hpp"
#include "scanmill/workflow/document.hpp"
#include "scanmill/workflow/ready.hpp"

namespace scanmill::runner {

namespace {

struct Option {
    std::string name;  ///< such as "--set"
    std::string help;
    std::string words;  ///< accepted values, separated by blanks; empty: any value, or no value
    bool takes_value;
};

struct Command {
    std::string name, help;
    std::vector<Option> options;
    std::string words;  ///< accepted arguments; empty: files
    std::string first_words;  ///< accepted as the first argument, besides files
};

/// The accepted words of an option. The set of CLI::IsMember is part of the option's type: "TEXT:{um,mm}".
std::string words_of(const CLI::Option& option) {
    const std::string type = option.get_type_name();
    const std::size_t open = type.find('{'), close = type.find('}');
    if (open == std::string::npos || close == std::string::npos) return {};
    std::string words = type.substr(open + 1, close - open - 1);
    std::ranges::replace(words, ',', ' ');
    return words;
}

std::vector<Command> commands_of(const CLI::App& app) {
    std::vector<Command> commands;
    for (const CLI::App* command :
         app.get_subcommands([](const CLI::App* each) { return !each->get_group().empty(); })) {
        Command described{command->get_name(), command->get_description(), {}, {}, {}};
        for (const CLI::Option* option : command->get_options()) {
            for (const std::string& name : option->get_lnames())
                described.options.push_back(
                    {"--" + name, option->get_description(), words_of(*option), option->get_items_expected_max() > 0});
        }
        const auto arguments = command->get_options([](const CLI::Option* each) { return each->get_positional(); });
        if (!arguments.empty()) described.words = words_of(*arguments.front());
        if (described.name == "show") described.words = "$(scanmill list --names 2>/dev/null)";
        if (described.name == "run" || described.name == "batch" || described.name == "check")
            described.first_words = fmt::format("{}", fmt::join(ready_names(), " "));
        commands.push_back(std::move(described));
    }
    return commands;
}

/// The text without characters that end a quoted word of a shell, or that have a meaning in zsh's descriptions.
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
        names += " " + command.name;
        std::string options;
        for (const Option& option : command.options) {
            options += " " + option.name;
            if (option.name == "--set")
                cases += fmt::format("        {}:--set:*) words=$(_scanmill_settings \"$name\") ;;\n", command.name);
            else if (!option.words.empty())
                cases += fmt::format("        {}:{}:*) words=\"{}\" ;;\n", command.name, option.name, option.words);
        }
        cases += fmt::format("        {}:*:-*) words=\"{}\" ;;\n", command.name, options.substr(1));
        if (!command.words.empty())
            cases += fmt::format("        {}:*) words=\"{}\" ;;\n", command.name, command.words);
        if (!command.first_words.empty())  // the previous word is the command's name only at the first argument
            cases += fmt::format(
                "        {0}:{0}:*) mapfile -t COMPREPLY < <(compgen -f -W \"{1}\" -- \"$word\"); return ;;\n",
                command.name, command.first_words);
    }
    return fmt::format(R"sh(_scanmill_settings() {{
    local all=$(scanmill complete-set "${{COMP_WORDS[@]:1}}" 2>/dev/null)
    if [ -n "$1" ]; then
        sed -n "s/^$1=//p" <<< "$all"
    else
        compopt -o nospace 2>/dev/null
        sed 's/=.*/=/' <<< "$all" | sort -u
    fi
}}
_scanmill() {{
    # bash makes words of --set NAME=VALUE and --keep=VALUE that end before and after the =
    local word=${{COMP_WORDS[COMP_CWORD]}} option=${{COMP_WORDS[COMP_CWORD-1]}} name words
    if [ "$word" = = ]; then
        name=$option option=${{COMP_WORDS[COMP_CWORD-2]}} word=
    elif [ "$option" = = ]; then
        name=${{COMP_WORDS[COMP_CWORD-2]}} option=${{COMP_WORDS[COMP_CWORD-3]}}
    fi
    case $name in --*) option=$name name= ;; esac
    case $([ "$COMP_CWORD" -gt 1 ] && echo "${{COMP_WORDS[1]}}:$option"):$word in
        :*) words="{} --help --version" ;;
{}        *) mapfile -t COMPREPLY < <(compgen -f -- "$word"); return ;;
    esac
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}}
complete -o filenames -F _scanmill scanmill
)sh",
                       names.substr(1), cases);
}

std::string zsh(const std::vector<Command>& commands) {
    std::string names, cases;
    for (const Command& command : commands) {
        names += fmt::format("        '{}:{}'\n", command.name, plain(command.help));
        cases += fmt::format("        {}) _arguments", command.name);
        for (const Option& option : command.options)
            cases += fmt::format(" '*{}[{}]{}'", option.name, plain(option.help),
                                 !option.takes_value      ? ""
                                 : option.name == "--set" ? ":value:_scanmill_settings"
                                 : option.words.empty()   ? ":value:_files"
                                                          : ":value:(" + option.words + ")");
        if (!command.first_words.empty())
            cases += fmt::format(" '1:workflow:{{compadd -- {}; _files}}'", command.first_words);
        cases += command.words.empty() ? " '*:file:_files' ;;\n" : fmt::format(" \"*:word:({})\" ;;\n", command.words);
    }
    return fmt::format(R"sh(#compdef scanmill
_scanmill_settings() {{
    compadd -S '' -- ${{(f)"$(scanmill complete-set $words 2>/dev/null)"}}
}}
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
# As a file that zsh loads for the first completion, it completes at once.
if [ "$funcstack[1]" = _scanmill ]; then _scanmill "$@"; else compdef _scanmill scanmill; fi
)sh",
                       names, cases);
}

std::string fish(const std::vector<Command>& commands) {
    std::string text;
    for (const Command& command : commands) {
        text += fmt::format("complete -c scanmill -n __fish_use_subcommand -f -a {} -d '{}'\n", command.name,
                            plain(command.help));
        const std::string here = fmt::format("complete -c scanmill -n '__fish_seen_subcommand_from {}'", command.name);
        if (!command.words.empty())
            text += fmt::format("{} -f -a '{}'\n", here, command.words.substr(command.words.starts_with('$')));
        if (!command.first_words.empty()) text += fmt::format("{} -a '{}'\n", here, command.first_words);
        for (const Option& option : command.options) {
            const std::string words =
                option.name == "--set" ? "(scanmill complete-set (commandline -opc)[2..] 2>/dev/null)" : option.words;
            text += fmt::format("{} -l {}{} -d '{}'\n", here, option.name.substr(2),
                                !words.empty()       ? fmt::format(" -x -a '{}'", words)
                                : option.takes_value ? " -r"
                                                     : "",
                                plain(option.help));
        }
    }
    return text;
}

struct CompletionOptions {
    std::string shell;
    const CLI::App* app = nullptr;
};

int completion(const CompletionOptions& options) {
    const std::vector<Command> commands = commands_of(*options.app);
    fmt::print("{}", options.shell == "bash"  ? bash(commands)
                     : options.shell == "zsh" ? zsh(commands)
                                              : fish(commands));
    return done;
}

/// The named values of a parameter: choices, true and false, and its word.
std::vector<std::string> values_of(const ParameterSpec& parameter) {
    std::vector<std::string> values;
    for (const Choice& choice : parameter.choices) values.push_back(choice.name);
    if (parameter.type == ParameterType::boolean) values = {"false", "true"};
    if (!parameter.word.empty()) values.push_back(parameter.word);
    return values;
}

/// Prints NAME=VALUE for every value; prints NAME= if there is none.
template <class Values>
void print_setting(const std::string& name, const Values& values) {
    if (values.empty()) fmt::print("{}=\n", name);
    for (const std::string& value : values) fmt::print("{}={}\n", name, value);
}

/// Prints the settings of a workflow. A workflow's parameter has the values of the filter parameters that use it.
void print_settings(const Workflow& workflow, const FilterLibrary& library) {
    std::map<std::string, std::set<std::string>> values;
    Diagnostics ignored("");
    expand(workflow, {}, ignored, [&](const Variant& variant) {
        for (const ExpandedStep& step : variant.steps)
            if (const FilterSpec* spec = library.find(step.syntax->filter))
                for (const ChosenArgument& argument : step.arguments)
                    if (const ParameterSpec* parameter = spec->parameter(argument.parameter->name))
                        for (const ReplacedName& replaced : argument.replaced)
                            for (const std::string& value : values_of(*parameter))
                                values[replaced.use->name].insert(value);
    });
    for (const WorkflowParameter& parameter : workflow.parameters)
        print_setting(parameter.name, values[parameter.name]);
}

/// The completion scripts call this with the words after `scanmill` on the command line so far.
int complete_set(const std::vector<std::string>& words) {
    const FilterLibrary library = open_library();
    if (!words.empty() && words.front() == "measure") {
        for (const std::string& filter : measuring_filters(library))
            for (const ParameterSpec& parameter : library.find(filter)->parameters)
                print_setting(parameter.name, values_of(parameter));
        return done;
    }
    for (std::size_t i = 1; i < words.size(); ++i) {
        std::string file;
        try {
            file = workflow_file(words[i], [](const std::string&) {});
        } catch (const Error&) {
            continue;  // a word that is neither a file nor a name, such as an incomplete one
        }
        if (!std::filesystem::is_regular_file(file) || !file.ends_with(".yaml")) continue;
        Diagnostics ignored(file);
        print_settings(parse_workflow(read_workflow_file(file), ignored), library);
        break;
    }
    return done;
}

}  // namespace

void add_completion(CLI::App& app, Action& chosen) {
    auto [command, options] = add_command<CompletionOptions>(
        app, chosen, "completion", "Prints a script that completes commands, options and their values", completion);
    options.app = &app;
    command.add_option("SHELL", options.shell, "The shell")->required()->check(CLI::IsMember({"bash", "zsh", "fish"}));
    command.footer(
        "In ~/.bashrc: source <(scanmill completion bash)\n"
        "In ~/.zshrc, after compinit: source <(scanmill completion zsh)\n"
        "In ~/.config/fish/config.fish: scanmill completion fish | source");
    CLI::App* hidden = app.add_subcommand("complete-set")->group("")->prefix_command();
    hidden->callback([&chosen, hidden] { chosen = [hidden] { return complete_set(hidden->remaining()); }; });
}

}  // namespace scanmill::runner
