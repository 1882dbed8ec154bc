// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/common/reading.hpp"

#include <algorithm>

#include "scanmill/base/error.hpp"

namespace scanmill {

std::string_view without_byte_order_mark(std::string_view text) {
    constexpr std::string_view mark = "\xef\xbb\xbf";
    if (text.starts_with(mark)) text.remove_prefix(mark.size());
    return text;
}

std::string_view declaration_in(std::string_view comment, std::string_view keyword) {
    const auto trim = [&comment] {
        while (!comment.empty() && (comment.front() == ' ' || comment.front() == '\t')) comment.remove_prefix(1);
        while (!comment.empty() && (comment.back() == ' ' || comment.back() == '\t')) comment.remove_suffix(1);
    };
    trim();
    if (!comment.starts_with(keyword) || comment.size() == keyword.size() || comment[keyword.size()] != ' ') return {};
    comment.remove_prefix(keyword.size());
    trim();
    return comment;
}

bool is_prose(std::string_view unit) { return unit.find(' ') != std::string_view::npos; }

Frame declared_frame(const std::vector<std::string>& comments, const ReadOptions& options) {
    Frame frame;
    for (const std::string& comment : comments) {
        if (const std::string_view text = declaration_in(comment, "unit"); !text.empty()) {
            if (const auto unit = length_unit(text)) {
                if (frame.unit != LengthUnit::unknown && frame.unit != *unit)
                    warn(options.on_warning, "the file says both 'unit {}' and 'unit {}'; the last counts",
                         symbol(frame.unit), symbol(*unit));
                frame.unit = *unit;
            } else if (!is_prose(text))
                warn(options.on_warning, "the unit {} is unknown and was passed over; known are {}", quote(text),
                     length_unit_symbols());
        }
        if (const std::string_view name = declaration_in(comment, "frame"); !name.empty()) frame.name = name;
    }
    if (options.unit != LengthUnit::unknown) {
        if (frame.unit != LengthUnit::unknown && frame.unit != options.unit)
            warn(options.on_warning, "the file says 'unit {}'; it was taken to be in {}, as was asked for",
                 symbol(frame.unit), symbol(options.unit));
        frame.unit = options.unit;
    }
    return frame;
}

std::map<std::string, int, std::less<>> declared_exponents(const std::vector<std::string>& comments) {
    std::map<std::string, int, std::less<>> exponents;
    for (const std::string& comment : comments) {
        const std::string_view declared = declaration_in(comment, "length-exponent");
        for (const auto& [text, exponent] : {std::pair<std::string_view, int>("1 ", 1), {"-1 ", -1}})
            if (declared.starts_with(text)) exponents.emplace(declared.substr(text.size()), exponent);
    }
    return exponents;
}

ColumnTable with_exponents(const ColumnTable& columns, const std::vector<std::string>& comments) {
    const auto exponents = declared_exponents(comments);
    ColumnTable all;
    for (const Column& column : columns) {
        const auto found = exponents.find(column.name());
        all.add(found == exponents.end() ? column : column.with_length_exponent(found->second));
    }
    return all;
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
