// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "commands/load.hpp"
#include "output/stderr_text.hpp"
#include "output/table.hpp"

namespace scanmill::runner {

namespace {

std::string kinds(const std::vector<PortSpec>& ports) {
    std::string text;
    for (const PortSpec& port : ports)
        text += (text.empty() ? "" : ", ") + kinds_text(port) + (port.list ? "…" : "") + (port.optional ? "?" : "");
    return text.empty() ? "-" : text;
}

void print_json(const FilterLibrary& library) {
    nlohmann::ordered_json json{
        {"scanmill", 1}, {"filters", nlohmann::json::array()}, {"unusable", nlohmann::json::array()}};
    for (const std::string& name : library.names())
        json["filters"].push_back(nlohmann::ordered_json::parse(to_json_text({"", *library.find(name)})));
    for (nlohmann::ordered_json& filter : json["filters"]) {
        filter.erase("scanmill-manifest");
        filter.erase("abi");
    }
    for (const UnusableModule& module : library.unusable())
        json["unusable"].push_back(
            {{"name", module.name}, {"manifest", module.manifest.string()}, {"reason", module.reason}});
    fmt::print("{}\n", json.dump(2));
}

int list(bool json, bool names) {
    const FilterLibrary library = open_library();
    if (json) {
        print_json(library);
        return done;
    }
    if (names) {
        for (const std::string& name : library.names()) fmt::print("{}\n", name);
        return done;
    }
    Table table({"filter", "takes", "gives", "what it does"});
    for (const std::string& name : library.names()) {
        const FilterSpec& spec = *library.find(name);
        table.add({name, kinds(spec.inputs), kinds(spec.outputs), spec.summary});
    }
    fmt::print("{}", table.text());
    for (const UnusableModule& module : library.unusable())
        tell("warning: the filter '{}' cannot be used: '{}' {}\n", module.name, module.manifest.string(),
             module.reason);
    return done;
}

}  // namespace

void add_list(CLI::App& app, Action& chosen) {
    CLI::App* command = app.add_subcommand("list", "Lists the filters at hand");
    auto json = std::make_shared<bool>(false), names = std::make_shared<bool>(false);
    command->add_flag("--json", *json, "Print everything the filters declare as JSON");
    command->add_flag("--names", *names, "Print the names alone, a line each")->excludes("--json");
    command->callback([&chosen, json, names] { chosen = [json, names] { return list(*json, *names); }; });
}

}  // namespace scanmill::runner
