// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <iterator>
#include <optional>

#include "scanmill/formats/common/built_in.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/files.hpp"

namespace scanmill {

namespace {

/// E57 (ASTM E2807), where its module was not built: recognised, so that its refusal can name a converter.
Format e57_format() {
    static constexpr std::string_view magic = "ASTM-E57";
    const auto recognise = [](std::string_view head, u64) {
        return head.starts_with(magic) ? Recognition::certain : Recognition::no;
    };
    const auto refuse = [](const FileBytes& file, const ReadOptions&) -> LoadedFile {
        if (!file.bytes.starts_with(magic)) throw Error("is not an E57 file: it does not begin with {}", magic);
        throw Error("is an E57 file; E57 is not read, because its module was not built")
            .hint(fmt::format("convert it with a free program: CloudCompare -SILENT -O {0} -C_EXPORT_FMT PLY "
                              "-SAVE_CLOUDS, or: pdal translate {0} out.las",
                              shell_word(file.path)));
    };
    return {"E57", {"e57"}, recognise, refuse, {}, true};
}

}  // namespace

std::string plain_extension(std::string_view extension) {
    if (extension.starts_with('.')) extension.remove_prefix(1);
    std::string plain(extension);
    for (char& c : plain) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return plain;
}

namespace {

/// The parts of a name that ends in '#' and a number: "a.e57" and "2" of "a.e57#2". Empty for other names.
std::optional<std::pair<std::string, std::string>> parts_of_view(const std::string& name) {
    const std::size_t mark = name.rfind('#');
    if (mark == std::string::npos || mark == 0 || mark + 1 == name.size()) return std::nullopt;
    std::string number = name.substr(mark + 1);
    const bool is_number = number.find_first_not_of("0123456789") == std::string::npos && number[0] != '0';
    if (!is_number) return std::nullopt;
    return std::pair(name.substr(0, mark), std::move(number));
}

}  // namespace

FileView file_view(const std::filesystem::path& name) {
    std::error_code ignored;
    const auto parts = parts_of_view(name.string());
    if (!parts || std::filesystem::exists(name, ignored) || !std::filesystem::is_regular_file(parts->first, ignored))
        return {name, 0};
    u32 view = 0;
    const std::string& number = parts->second;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), view);
    return error == std::errc() ? FileView{parts->first, view} : FileView{name, 0};
}

std::filesystem::path view_name(const std::filesystem::path& file, u32 view) {
    return view == 0 ? file : std::filesystem::path(file.string() + "#" + std::to_string(view));
}

std::string extension_of(const std::filesystem::path& path) {
    if (const auto parts = parts_of_view(path.filename().string())) return extension_of(parts->first);
    std::string extension = plain_extension(path.extension().string());
    if (extension == "gz") extension = plain_extension(path.stem().extension().string());
    return extension;
}

std::string stem_of(const std::filesystem::path& path) {
    if (const auto parts = parts_of_view(path.filename().string())) return stem_of(parts->first) + "-" + parts->second;
    const std::filesystem::path stem = path.stem();
    return plain_extension(path.extension().string()) == "gz" ? stem.stem().string() : stem.string();
}

bool Format::has_extension(std::string_view extension) const {
    return std::ranges::find(extensions, plain_extension(extension)) != extensions.end();
}

Format::Write Format::writer(Kind kind) const {
    for (const auto& [written, write] : writers)
        if (written == kind) return write;
    return {};
}

std::span<const Format> formats() {
    static const std::vector<Format> table = [] {
        std::vector<Format> rows{ply_format(), stl_format(), off_format(), obj_format()};
        std::ranges::move(text_formats(), std::back_inserter(rows));
        for (const auto& format : {probes_csv_format, ptx_format, las_format, dmis_format, json_format})
            rows.push_back(format());
        std::ranges::move(module_formats(), std::back_inserter(rows));
        // Formats that only a module reads are refused by name where the module is not built.
        for (const auto& format : {refused_laz_format, e57_format})
            if (Format row = format(); std::ranges::find(rows, row.name, &Format::name) == rows.end())
                rows.push_back(std::move(row));
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
    const std::string extension = extension_of(file.path);
    for (const Format& format : formats())
        if (format.has_extension(extension)) return format;
    if (plausible) return *plausible;

    std::vector<std::string> readable;
    for (const Format& format : formats())
        if (!format.is_refused) readable.push_back(format.name);
    constexpr std::size_t shown = 16;
    throw Error("is in an unknown format: it begins with {} and has {}", quote(head.substr(0, shown)),
                extension.empty() ? std::string("no extension") : "the extension '." + extension + "'")
        .hint(fmt::format("formats that are read: {}", fmt::join(readable, ", ")));
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

std::vector<std::string> readable_kinds() {
    std::vector<std::string> names;
    for (const Kind kind : all_kinds())
        if (kind == kind_of<PointCloud>() || kind == kind_of<TriangleMesh>() || kind.has_json())
            names.emplace_back(kind.name());
    return names;
}

std::string writable_extensions(Kind kind) {
    std::vector<std::string> extensions;
    for (const Format& format : formats())
        if (format.writer(kind)) std::ranges::copy(format.extensions, std::back_inserter(extensions));
    return fmt::format("{}", fmt::join(extensions, ", "));
}

}  // namespace scanmill
