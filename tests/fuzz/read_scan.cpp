// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "fuzz/targets.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/format.hpp"
#include "scanmill/formats/files.hpp"

namespace scanmill::test {

namespace {

void require_sound(const ColumnTable& columns, std::size_t rows) {
    for (const Column& column : columns) {
        require_law(column.rows() == rows, "a column has another number of rows than its element");
        const std::size_t numbers = column.bytes().size() / size_of(column.type());
        if (!column.is_list()) {
            require_law(numbers == rows * column.components(), "a column has not its rows' numbers");
            continue;
        }
        require_law(
            std::ranges::is_sorted(column.offsets()) && column.offsets()[0] == 0 && column.offsets()[rows] == numbers,
            "the offsets of a list column do not fit");
    }
}

void require_sound(const PointCloud& cloud) { require_sound(cloud.columns, cloud.size()); }

void require_sound(const TriangleMesh& mesh) {
    require_consistent(mesh);
    require_sound(mesh.vertex_columns, mesh.positions.size());
    require_sound(mesh.face_columns, mesh.triangles.size());
    require_sound(mesh.edge_columns, mesh.edges.size());
    require_law(!mesh.triangles.empty(), "a mesh without a face");
    const auto in_order = [](const Edge& edge) { return edge[0] <= edge[1]; };
    require_law(std::ranges::all_of(mesh.edges, in_order), "an edge with its larger index first");
    const auto rises = std::ranges::adjacent_find(mesh.sharp_edges, std::ranges::greater_equal{});
    require_law(rises == mesh.sharp_edges.end(), "sharp edges unsorted or repeated");
}

template <class Action>
decltype(auto) with_geometry(const Value& value, Action&& action) {
    if (const auto* mesh = value.find<TriangleMesh>()) return action(*mesh);
    return action(*value.get<PointCloud>());
}

Array<Vec3> world_positions(const Value& value) {
    return with_geometry(value, [](const auto& geometry) {
        Array<Vec3> world;
        for (const Vec3& position : geometry.positions) world.push_back(geometry.frame.origin + position);
        return world;
    });
}

bool is_finite(const Array<Vec3>& positions) {
    return std::ranges::all_of(positions, [](const Vec3& position) { return position.allFinite(); });
}

/// Once written and read, nothing changes any more: bytes stay bytes.
void require_lasting_ply(const Value& value) {
    const std::string once = write_bytes("copy.ply", value);
    const Value copy = read_bytes(once, "copy.ply").value;
    const Array<Vec3> positions = world_positions(value);
    if (!is_finite(positions)) return;  // those around a NaN may lose their last bit
    require_law(world_positions(copy) == positions, "PLY moves points");
    require_law(write_bytes("copy.ply", copy) == once, "PLY that was read and written again differs");
}

/// A picture has all its pixels, and PNG keeps them with the caption.
void require_lasting(const Picture& picture, const Value& value) {
    require_law(picture.pixels.size() == std::size_t(picture.width) * picture.height && !picture.pixels.empty(),
                "a picture has another number of pixels than its size");
    const LoadedFile copy = read_bytes(write_bytes("copy.png", value), "copy.png");
    const auto& again = *copy.value.get<Picture>();
    require_law(again.width == picture.width && std::ranges::equal(again.pixels, picture.pixels), "PNG changes pixels");
    require_law(again.caption == picture.caption, "PNG changes the caption");
}

void require_coming_back(const Value& value, const Format& format) {
    const std::string name = "copy." + std::string(format.extensions.front());
    std::string bytes;
    try {
        bytes = write_bytes(name, value);
    } catch (const Error&) {
        return;  // coordinates beyond what the format has
    }
    if (format.is_refused) return;  // written only
    const Value copy = read_bytes(bytes, name).value;
    if (format.name == "STL") return;  // merges corners, keeps single precision
    const Array<Vec3> positions = world_positions(value);
    require_law(!is_finite(positions) || world_positions(copy) == positions,
                std::string(format.name) + " moves points");
}

}  // namespace

bool read_scan(std::string_view extension, std::string_view bytes) {
    const std::string name = "scan." + std::string(extension);
    read_stream(extension, bytes);
    LoadedFile loaded;
    try {
        loaded = read_bytes(bytes, name, {[](const std::string&) {}});
    } catch (const Error& error) {
        require_law(error.sentence().starts_with("'" + name + "': "), "an error that does not name its file");
        return false;
    }
    if (const auto* picture = loaded.value.find<Picture>()) {
        require_lasting(*picture, loaded.value);
        return true;
    }
    with_geometry(loaded.value, [](const auto& geometry) {
        require_sound(geometry);
        require_law(!geometry.positions.empty(), "a scan without points");
        require_law(geometry.frame.origin.allFinite(), "an origin that is no point");
    });
    require_lasting_ply(loaded.value);
    for (const Format& format : formats())
        if (format.writer(kind_of(loaded.value)) && format.name != "PLY") require_coming_back(loaded.value, format);
    return true;
}

}  // namespace scanmill::test
