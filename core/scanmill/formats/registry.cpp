// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/registry.hpp"

#include <algorithm>
#include <iterator>

#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/e57/e57.hpp"
#include "scanmill/formats/json/json.hpp"
#include "scanmill/formats/las/las.hpp"
#include "scanmill/formats/obj/obj.hpp"
#include "scanmill/formats/off/off.hpp"
#include "scanmill/formats/ply/ply.hpp"
#include "scanmill/formats/ptx/ptx.hpp"
#include "scanmill/formats/stl/stl.hpp"
#include "scanmill/formats/text/text.hpp"

namespace scanmill {

namespace {

std::vector<std::pair<Kind, Format::Write>> json_writers() {
    std::vector<std::pair<Kind, Format::Write>> writers;
    for (const Kind kind : all_kinds())
        if (kind.has_json()) writers.emplace_back(kind, write_json);
    return writers;
}

std::vector<Format> built_in() {
    return {
        {"PLY",
         {"ply"},
         recognise_ply,
         read_ply,
         {{kind_of<PointCloud>(), write_ply_points}, {kind_of<TriangleMesh>(), write_ply_mesh}}},
        {"STL", {"stl"}, recognise_stl, read_stl, {{kind_of<TriangleMesh>(), write_stl}}},
        {"OFF", {"off"}, recognise_off, read_off, {{kind_of<TriangleMesh>(), write_off}}},
        {"OBJ", {"obj"}, recognise_obj, read_obj, {{kind_of<TriangleMesh>(), write_obj}}},
        {"XYZ", {"xyz", "txt"}, recognise_xyz, read_xyz, {{kind_of<PointCloud>(), write_xyz}}},
        // Read alike, but not written: commas, a count or normals are expected of them.
        {"CSV", {"csv", "pts", "pwn", "asc"}, recognise_xyz, read_xyz, {}},
        {"PTX", {"ptx"}, recognise_ptx, read_ptx, {}},
        {"LAS", {"las", "laz"}, recognise_las, read_las, {}},
        {"E57", {"e57"}, recognise_e57, refuse_e57, {}, true},
        {"JSON", {"json"}, recognise_json, read_json, json_writers()},
    };
}

}  // namespace

std::span<const Format> formats() {
    static const std::vector<Format> table = [] {
        std::vector<Format> rows = built_in();
        std::ranges::move(module_formats(), std::back_inserter(rows));
        return rows;
    }();
    return table;
}

const Format& format_of(const FileBytes& file) {
    const std::string_view head = file.bytes.substr(0, head_size);
    const Format* plausible = nullptr;
    for (const Format& format : formats()) {
        const Recognition recognition = format.recognises(head, file.bytes.size());
        if (recognition == Recognition::certain) return format;
        if (recognition == Recognition::plausible && !plausible) plausible = &format;
    }
    const std::string extension = file.path.extension().string();
    for (const Format& format : formats())
        if (format.has_extension(extension)) return format;
    if (plausible) return *plausible;

    std::string known;
    for (const Format& format : formats())
        if (!format.is_refused) known.append(known.empty() ? "" : ", ").append(format.name);
    constexpr std::size_t shown = 16;
    throw Error("is of no known format: it begins with {} and has {}", quote(head.substr(0, shown)),
                extension.empty() ? std::string("no extension") : "the extension '" + extension + "'")
        .hint("formats that are read: " + known);
}

bool can_write(std::string_view extension, Kind kind) {
    return std::ranges::any_of(
        formats(), [&](const Format& format) { return format.has_extension(extension) && format.writer(kind); });
}

std::string why_unusable(std::string_view extension) {
    for (const Format& format : formats())
        if (format.has_extension(extension) && !format.unusable.empty()) return format.unusable;
    return {};
}

std::string writable_extensions(Kind kind) {
    std::string extensions;
    for (const Format& format : formats())
        if (format.writer(kind))
            for (const std::string& extension : format.extensions)
                extensions.append(extensions.empty() ? "" : ", ").append(extension);
    return extensions;
}

}  // namespace scanmill
