// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "commands/load.hpp"
#include "output/error_output.hpp"
#include "output/printable.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/describe/file_info.hpp"

namespace scanmill::runner {

namespace {

using Json = nlohmann::ordered_json;

/// Coordinates have more digits than lengths: micrometres at a distance of 10^6 m.
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
        if (item.is_object()) {
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

int info(const std::vector<std::string>& files, bool as_json) {
    Json all{{"scanmill", 1}, {"files", Json::array()}};
    int code = done;
    for (const std::string& file : files) {
        try {
            Json described = file_info(file);
            if (as_json) {
                all["files"].push_back(std::move(described));
                continue;
            }
            if (files.size() > 1 && &file != &files.front()) fmt::print("\n");
            for (const auto& [key, value] : described.items())
                if (!(value.is_array() && value.empty()))
                    fmt::print("{:<15} {}\n", key, printable_line(value_text(value)));
        } catch (const Error& error) {
            code = some_failed;
            if (as_json)
                all["files"].push_back({{"file", file}, {"error", error.what()}});
            else
                print(error, false);
        }
    }
    if (as_json) fmt::print("{}\n", all.dump(2, ' ', false, Json::error_handler_t::replace));
    return code;
}

}  // namespace

void add_info(CLI::App& app, Action& chosen) {
    struct Options {
        std::vector<std::string> files;
        bool json = false;
    };
    CLI::App* command = app.add_subcommand("info", "Says what files hold: counts, columns, size, unit, topology");
    auto options = std::make_shared<Options>();
    command->add_option("FILE", options->files, "Scans or meshes")->required();
    command->add_flag("--json", options->json, "Print it as JSON");
    command->callback([&chosen, options] { chosen = [options] { return info(options->files, options->json); }; });
}

}  // namespace scanmill::runner
