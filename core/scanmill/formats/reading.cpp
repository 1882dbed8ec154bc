// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/reading.hpp"

#include <algorithm>
#include <cctype>

#include "scanmill/filter/error.hpp"

namespace scanmill {

namespace {

/// What follows `keyword` and a blank in `line`, without blanks around it; empty when the line does not begin so.
std::string_view declared(std::string_view line, std::string_view keyword) {
    const auto trim = [&line] {
        while (!line.empty() && (line.front() == ' ' || line.front() == '\t')) line.remove_prefix(1);
        while (!line.empty() && (line.back() == ' ' || line.back() == '\t')) line.remove_suffix(1);
    };
    trim();
    if (!line.starts_with(keyword) || line.size() == keyword.size() || line[keyword.size()] != ' ') return {};
    line.remove_prefix(keyword.size());
    trim();
    return line;
}

}  // namespace

std::string quote(std::string_view bytes) {
    constexpr std::size_t longest = 40;
    std::string text = "'";
    for (char c : bytes.substr(0, longest)) text += c >= ' ' && c <= '~' ? c : '?';
    return text + (bytes.size() > longest ? "…'" : "'");
}

std::string shell_word(const std::filesystem::path& path) {
    const std::string text = path.string();
    const auto plain = [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) ||
               std::string_view("/._-+,%@:=").find(c) != std::string::npos;
    };
    if (!text.empty() && text.front() != '-' && std::ranges::all_of(text, plain)) return text;
    std::string word = "'";
    for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return word + "'";
}

std::string counted(u64 count, std::string_view singular, std::string_view plural) {
    return fmt::format("{} {}", count, count == 1 ? singular : plural);
}

std::string_view without_byte_order_mark(std::string_view text) {
    constexpr std::string_view mark = "\xef\xbb\xbf";
    if (text.starts_with(mark)) text.remove_prefix(mark.size());
    return text;
}

Frame declared_frame(const std::vector<std::string>& comments, const ReadOptions& options) {
    Frame frame;
    for (const std::string& comment : comments) {
        if (const std::string_view text = declared(comment, "unit"); !text.empty()) {
            if (const auto unit = length_unit(text)) {
                if (frame.unit != LengthUnit::unknown && frame.unit != *unit)
                    warn(options.on_warning, "the file says both 'unit {}' and 'unit {}'; the last counts",
                         symbol(frame.unit), symbol(*unit));
                frame.unit = *unit;
            } else if (text.find(' ') == std::string_view::npos)  // else it is prose that happens to begin with "unit"
                warn(options.on_warning, "the unit {} is unknown and was passed over; known are {}", quote(text),
                     length_unit_symbols());
        }
        if (const std::string_view name = declared(comment, "frame"); !name.empty()) frame.name = name;
    }
    if (options.unit != LengthUnit::unknown) {
        if (frame.unit != LengthUnit::unknown && frame.unit != options.unit)
            warn(options.on_warning, "the file says 'unit {}'; it was taken to be in {}, as was asked for",
                 symbol(frame.unit), symbol(options.unit));
        frame.unit = options.unit;
    }
    return frame;
}

void require_countable(u64 count, std::string_view elements) {
    constexpr u64 most = ~u32(0);
    if (count > most) throw Error("holds {} {}; at most {} can be numbered", count, elements, most);
}

void move_near_origin(Array<Vec3>& positions, const BoundingBox& box, Frame& frame) {
    frame.origin = distant_origin(box);
    if (frame.origin == Vec3::Zero()) return;
    for (Vec3& p : positions) p -= frame.origin;
}

}  // namespace scanmill
