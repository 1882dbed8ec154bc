// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plan/output_template.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill {

namespace {

const std::array<std::string, 4> placeholders{"scan", "folder", "variant", "workflow"};

bool leaves_folder(const std::filesystem::path& path) {
    const std::filesystem::path normal = path.lexically_normal();
    return path.is_absolute() || normal.empty() || *normal.begin() == "..";
}

bool names_a_folder(const std::filesystem::path& path) {
    return !path.has_filename() || path.filename() == "." || path.filename() == "..";
}

/// Bytes of the longest part between slashes; what the placeholders will stand for does not count.
std::size_t longest_name(const std::string& file) {
    std::size_t longest = 0, length = 0;
    bool inside = false;
    for (char c : file) {
        if (c == '{') inside = true;
        length = c == '/' ? 0 : length + (inside ? 0 : 1);
        longest = std::max(longest, length);
        if (c == '}') inside = false;
    }
    return longest;
}

}  // namespace

bool mentions(const std::string& file, const std::string& placeholder) {
    return file.find("{" + placeholder + "}") != std::string::npos;
}

void check_template(const std::string& file, Position position, Diagnostics& diagnostics) {
    for (std::size_t at = 0; at < file.size(); ++at) {
        if (file[at] == '}') diagnostics.error(position, fmt::format("'{}' has a }} without its {{", file));
        if (file[at] != '{') continue;
        const std::size_t end = file.find('}', at);
        if (end == std::string::npos) {
            diagnostics.error(position, fmt::format("'{}' has a {{ without its }}", file));
            return;
        }
        const std::string name = file.substr(at + 1, end - at - 1);
        if (std::ranges::find(placeholders, name) == placeholders.end())
            diagnostics.error(
                position,
                fmt::format(
                    "'{}' has no meaning for {{{}}}; expected {{scan}}, {{folder}}, {{variant}} or {{workflow}}{}",
                    file, name, did_you_mean(name, placeholders)));
        at = end;
    }
    if (file.find('\0') != std::string::npos) diagnostics.error(position, "a file's name has a zero byte");
    constexpr std::size_t most = 255;  // of nearly every file system
    if (const std::size_t bytes = longest_name(file); bytes > most)
        diagnostics.error(position, fmt::format("a file's name has {} bytes; expected at most {}", bytes, most));
    if (leaves_folder(file))
        diagnostics.error(
            position,
            fmt::format("'{}' lies outside the output folder; expected a path below it, as \"{{scan}}.stl\"", file));
    else if (names_a_folder(file))
        diagnostics.error(position, fmt::format("'{}' names a folder; expected a file, as \"{{scan}}.stl\"", file));
    else if (const std::string normal = std::filesystem::path(file).lexically_normal().string(); normal != file)
        diagnostics.error(position, fmt::format("'{}' is a roundabout path; expected '{}'", file, normal));
}

std::string expand_template(const std::string& file, const TemplateValues& values) {
    std::string name;
    for (std::size_t at = 0; at < file.size(); ++at) {
        if (file[at] != '{') {
            name += file[at];
            continue;
        }
        const std::size_t end = file.find('}', at);
        const std::string placeholder = file.substr(at + 1, end - at - 1);
        name += placeholder == "scan"      ? values.scan
                : placeholder == "folder"  ? values.folder
                : placeholder == "variant" ? values.variant
                                           : values.workflow;
        at = end;
    }
    if (leaves_folder(name) || names_a_folder(name))
        throw Error("'{}' becomes '{}', which is no file below the output folder", file, name).hint("rename the scan");
    return std::filesystem::path(name).lexically_normal().string();
}

}  // namespace scanmill
