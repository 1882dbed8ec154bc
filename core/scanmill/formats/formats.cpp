// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cctype>
#include <iterator>

#include "scanmill/filter/error.hpp"
#include "scanmill/filter/module.hpp"
#include "scanmill/formats/e57.hpp"
#include "scanmill/formats/features_json.hpp"
#include "scanmill/formats/format_modules.hpp"
#include "scanmill/formats/las.hpp"
#include "scanmill/formats/metrics_json.hpp"
#include "scanmill/formats/obj.hpp"
#include "scanmill/formats/off.hpp"
#include "scanmill/formats/ply.hpp"
#include "scanmill/formats/ptx.hpp"
#include "scanmill/formats/reading.hpp"
#include "scanmill/formats/stl.hpp"
#include "scanmill/formats/xyz.hpp"

namespace scanmill {

namespace {

std::vector<Format> built_in() {
    return {
        {"PLY", {"ply"}, recognise_ply, read_ply, {{Kind::points, write_ply_points}, {Kind::mesh, write_ply_mesh}}},
        {"STL", {"stl"}, recognise_stl, read_stl, {{Kind::mesh, write_stl}}},
        {"OFF", {"off"}, recognise_off, read_off, {{Kind::mesh, write_off}}},
        {"OBJ", {"obj"}, recognise_obj, read_obj, {{Kind::mesh, write_obj}}},
        {"XYZ", {"xyz", "txt"}, recognise_xyz, read_xyz, {{Kind::points, write_xyz}}},
        // Read alike, but not written: commas, a count or normals are expected of them.
        {"CSV", {"csv", "pts", "pwn", "asc"}, recognise_xyz, read_xyz, {}},
        {"PTX", {"ptx"}, recognise_ptx, read_ptx, {}},
        {"LAS", {"las", "laz"}, recognise_las, read_las, {}},
        {"E57", {"e57"}, recognise_e57, refuse_e57, {}, true},
        {"JSON",
         {"json"},
         recognise_json,
         refuse_json,
         {{Kind::metrics, write_metrics_json}, {Kind::features, write_features_json}},
         true},
    };
}

}  // namespace

std::span<const Format> formats() {
    static const std::vector<Format> table = [] {
        std::vector<Format> rows = built_in();
        std::ranges::move(format_modules(installed_format_folder()), std::back_inserter(rows));
        return rows;
    }();
    return table;
}

std::string plain_extension(std::string_view extension) {
    if (extension.starts_with('.')) extension.remove_prefix(1);
    std::string plain(extension);
    for (char& c : plain) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return plain;
}

bool Format::has_extension(std::string_view extension) const {
    return std::ranges::find(extensions, plain_extension(extension)) != extensions.end();
}

Format::Write Format::writer(Kind kind) const {
    for (const auto& [written, write] : writers)
        if (written == kind) return write;
    return {};
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
