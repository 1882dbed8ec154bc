// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "output/error_output.hpp"
#include "output/terminal.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/describe/file_info.hpp"

namespace scanmill::runner {

namespace {

using Json = nlohmann::ordered_json;

struct Options {
    std::vector<std::string> files;
    bool json = false;
};

/// The value as text. Coordinates get more digits than lengths: micrometres at a distance of 10^6 m.
std::string value_text(const Json& value, int digits = 9) {
    constexpr int digits_of_coordinates = 13;
    if (value.is_null()) return "not declared";
    if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
    if (value.is_string()) return value.get<std::string>();
    if (value.is_number_float()) return fmt::format("{:.{}g}", value.get<double>(), digits);
    if (!value.is_array()) return value.dump();
    std::string text;
    for (const Json& item : value) {
        std::string part;
        if (item.contains("position")) {
            part =
                fmt::format("number {} at {}", item.at("number").get<std::size_t>(), value_text(item.at("position")));
        } else if (item.is_object()) {
            const unsigned components = item.at("components");
            part = fmt::format("{} ({}{})", item.at("name").get<std::string>(), item.at("type").get<std::string>(),
                               components == 0   ? " lists"
                               : components == 1 ? ""
                                                 : " x " + std::to_string(components));
        } else {
            part = value_text(item, digits_of_coordinates);
        }
        text += (text.empty() ? "" : item.is_number() ? " " : ", ") + part;
    }
    return text.empty() ? "none" : text;
}

int info(const Options& options) {
    Json all{{"scanmill", 1}, {"files", Json::array()}};
    int code = done;
    for (const std::string& file : options.files) {
        try {
            Json described = file_info(file);
            if (options.json) {
                all["files"].push_back(std::move(described));
                continue;
            }
            if (&file != &options.files.front()) fmt::print("\n");
            for (const auto& [key, value] : described.items())
                if (!(value.is_array() && value.empty()))
                    fmt::print("{:<15} {}\n", key, printable_line(value_text(value)));
        } catch (const Error& error) {
            code = some_failed;
            if (options.json)
                all["files"].push_back({{"file", file}, {"error", error.what()}});
            else
                print(error, false);
        }
    }
    if (options.json) print_json(all);
    return code;
}

}  // namespace

void add_info(CLI::App& app, Action& chosen) {
    auto [command, options] = add_command<Options>(
        app, chosen, "info", "Prints the content of files: counts, columns, size, unit, topology", info);
    command.add_option("FILE", options.files, "Scans or meshes")->required();
    command.add_flag("--json", options.json, "Print the result as JSON");
}

}  // namespace scanmill::runner
