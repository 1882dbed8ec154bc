// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/describe/file_info.hpp"

#include <algorithm>

#include "scanmill/formats/files.hpp"
#include "scanmill/kinds/document.hpp"
#include "scanmill/kinds/length_scale.hpp"
#include "scanmill/session/session.hpp"

namespace scanmill {

namespace {

void add_columns(Json& json, const char* name, const ColumnTable& table) {
    Json rows = Json::array();
    for (const Column& column : table)
        rows.push_back(
            {{"name", column.name()}, {"type", name_of(column.type())}, {"components", column.components()}});
    json[name] = std::move(rows);
}

/// Adds the columns of every table of a value to a JSON object, under the table's name.
class ListColumns : public FieldVisitor {
public:
    explicit ListColumns(Json& json) : json_(json) {}
    void columns(const char* name, ColumnTable& table) override {
        add_columns(json_, std::string_view(name) == "vertex-columns" ? "columns" : name, table);
    }

private:
    Json& json_;
};

void add_box(Json& json, const BoundingBox& box, const Frame& frame) {
    json["low"] = json_of(Vec3(box.low + frame.origin));
    json["high"] = json_of(Vec3(box.high + frame.origin));
    json["diagonal"] = box.diagonal();
}

void add_frame(Json& json, const Frame& frame) {
    if (!frame.name.empty()) json["frame"] = frame.name;
    if (frame.origin != Vec3::Zero()) json["origin"] = json_of(frame.origin);
}

/// Adds the number of stray points as `stray`. If there are any, also adds the diagonal to which `%diag` refers, and
/// the first stray points.
void add_stray_points(const RobustBox& box, const Frame& frame, Json& json) {
    constexpr std::size_t shown = 5;
    json["stray"] = box.stray.size();
    if (box.stray.empty()) return;
    json["robust-diagonal"] = box.diagonal();
    Json& points = json["stray-points"] = Json::array();
    for (std::size_t i = 0; i < std::min(shown, box.stray.size()); ++i)
        points.push_back(
            {{"number", box.stray[i].row}, {"position", json_of(Vec3(box.stray[i].position + frame.origin))}});
}

/// The output for a scan that is read in chunks.
Json stream_info(const std::string& file, const PointStream& scan) {
    Json json{{"file", file}, {"kind", name_of(kind_of<PointCloud>())}, {"points", scan.size()}};
    add_columns(json, "columns", scan.read_columns(0));
    add_box(json, scan.bounds(), scan.frame());
    add_stray_points(scan.robust_box(), scan.frame(), json);
    json["not-finite"] = 0;
    json["unit"] = json_of(scan.frame().unit);
    add_frame(json, scan.frame());
    return json;
}

}  // namespace

Json file_info(const std::string& file, u64 memory) {
    std::vector<std::string> warnings;
    ReadOptions options;
    options.on_warning = [&](std::string text) { warnings.push_back(std::move(text)); };
    if (memory_to_read(file) > memory) {
        const auto scan = may_be_point_stream(file) ? open_point_stream(file, options, usable_cores()) : nullptr;
        if (!scan) require_memory_to_read(file, memory);
        Json json = stream_info(file, *scan);
        warnings.push_back("the file was read in chunks, because it may not fit into memory; the spacing is not known");
        json["warnings"] = warnings;
        return json;
    }
    const LoadedFile loaded = read_file(file, options);
    const Value& value = loaded.value;
    Json json{{"file", file}, {"format", loaded.format}, {"encoding", loaded.encoding}, {"kind", value.kind().name()}};
    for (const Metric& property : properties_of(value).values)
        json[property.name] =
            property.unit == Unit::boolean ? Json(property.value != 0) : Json(static_cast<long long>(property.value));
    if (const u32 views = file_view(file).view > 0 ? 1 : count_views(file); views > 1) json["views"] = views;
    ListColumns columns(json);
    visited(value, columns);
    const Buffer<Vec3> positions = positions_of(value);
    const Frame frame = frame_of(value).value_or(Frame{});
    if (const BoundingBox box = bounding_box(positions.span()); !box.empty()) {
        add_box(json, box, frame);
        json["spacing"] = length_scale(value).spacing();
    }
    if (value.find<PointCloud>()) add_stray_points(robust_box(positions.span()), frame, json);
    if (is_geometric(value.kind())) {
        json["not-finite"] = std::ranges::count_if(positions, [](const Vec3& p) { return !p.allFinite(); });
        json["unit"] = json_of(frame.unit);
    }
    add_frame(json, frame);
    if (!loaded.comments.empty()) json["comments"] = loaded.comments;
    if (!warnings.empty()) json["warnings"] = warnings;
    return json;
}

}  // namespace scanmill
