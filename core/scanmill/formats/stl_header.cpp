// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/stl.hpp"

namespace scanmill {

namespace {
constexpr std::string_view signature = "binary STL by scanmill";
constexpr std::string_view unit_key = "; unit ";
constexpr std::string_view frame_key = "; frame ";
}  // namespace

std::string stl_header(const Frame& frame) {
    std::string header(signature);
    if (frame.unit != LengthUnit::unknown) header.append(unit_key).append(symbol(frame.unit));
    if (!frame.name.empty()) header.append(frame_key).append(frame.name);
    header.resize(stl_header_size, ' ');
    return header;
}

std::vector<std::string> stl_header_comments(std::string_view header) {
    // Others end their text with zeros.
    header = header.substr(0, header.find('\0'));
    while (header.ends_with(' ')) header.remove_suffix(1);
    if (!header.starts_with(signature)) {
        if (header.empty()) return {};
        return {std::string(header)};
    }
    std::vector<std::string> comments;
    header.remove_prefix(signature.size());
    // The frame's name is last and may hold anything, semicolons too.
    for (std::string_view key : {unit_key, frame_key}) {
        if (!header.starts_with(key)) continue;
        header.remove_prefix(2);
        const std::size_t end = key == unit_key ? header.find(frame_key) : std::string_view::npos;
        comments.emplace_back(header.substr(0, end));
        header.remove_prefix(comments.back().size());
    }
    return comments;
}

}  // namespace scanmill
