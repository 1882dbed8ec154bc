// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "commands/load.hpp"
#include "output/error_output.hpp"
#include "output/printable.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/kinds/length_scale.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill::runner {

namespace {

using Json = nlohmann::ordered_json;

Json to_json(const ColumnTable& columns) {
    Json json = Json::array();
    for (const Column& column : columns)
        json.push_back(
            {{"name", column.name()}, {"type", name_of(column.type())}, {"components", column.components()}});
    return json;
}

Json to_json(const Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); }

std::size_t count_unfinite(std::span<const Vec3> positions) {
    return static_cast<std::size_t>(std::ranges::count_if(positions, [](const Vec3& p) { return !p.allFinite(); }));
}

/// Everything that `info` knows of a file; the text form prints the same, numbers rounded.
Json describe(const std::string& file) {
    std::vector<std::string> warnings;
    ReadOptions options;
    options.on_warning = [&](std::string text) { warnings.push_back(std::move(text)); };
    const LoadedFile loaded = read_file(file, options);
    const std::optional<Frame> own_frame = frame_of(loaded.value);
    const Frame frame = own_frame.value_or(Frame{});
    Json json{{"file", file},
              {"format", loaded.format},
              {"encoding", loaded.encoding},
              {"kind", name_of(kind_of(loaded.value))}};
    const Metrics facts = properties_of(loaded.value);
    for (const Metric& fact : facts.values)
        json[fact.name] = fact.unit == Unit::boolean ? Json(fact.value != 0) : Json(static_cast<long long>(fact.value));
    std::span<const Vec3> positions;
    if (const auto* points = loaded.value.find<PointCloud>()) {
        positions = points->positions.span();
        json["columns"] = to_json(points->columns);
    } else if (const auto* mesh = loaded.value.find<TriangleMesh>()) {
        positions = mesh->positions.span();
        json["columns"] = to_json(mesh->vertex_columns);
        json["face-columns"] = to_json(mesh->face_columns);
        json["edge-columns"] = to_json(mesh->edge_columns);
    }
    const BoundingBox box = bounding_box(positions);
    if (!box.empty()) {
        json["low"] = to_json(box.low + frame.origin);
        json["high"] = to_json(box.high + frame.origin);
        json["diagonal"] = box.diagonal();
        json["spacing"] = length_scale(loaded.value).spacing();
    }
    json["not-finite"] = count_unfinite(positions);
    json["unit"] = frame.unit == LengthUnit::unknown ? Json(nullptr) : Json(symbol(frame.unit));
    if (!frame.name.empty()) json["frame"] = frame.name;
    if (frame.origin != Vec3::Zero()) json["origin"] = to_json(frame.origin);
    if (!loaded.comments.empty()) json["comments"] = loaded.comments;
    if (!warnings.empty()) json["warnings"] = warnings;
    return json;
}

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
            Json described = describe(file);
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
