// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <charconv>

#include "scanmill/formats/ply/detail/ply_elements.hpp"

namespace scanmill {

namespace {

/// Removes and returns the first word of the line.
std::string_view word(std::string_view& line) {
    line = trimmed(line);
    const std::string_view found = line.substr(0, line.find_first_of(" \t\r"));
    line.remove_prefix(found.size());
    return found;
}

class HeaderParser {
public:
    explicit HeaderParser(std::string_view file) : file_(file), line_end_(line_end_of(file)) {}

    PlyHeader parse() {
        std::string_view line = next_line();
        if (word(line) != "ply") throw Error("line 1: a PLY file begins with 'ply', this one with {}", quote(file_));
        for (;;) {
            line = next_line();
            const std::string_view keyword = word(line);
            if (keyword == "end_header") break;
            if (keyword == "format")
                parse_format(line);
            else if (keyword == "element")
                parse_element(line);
            else if (keyword == "property")
                parse_property(line);
            else if (keyword == "comment" || keyword == "obj_info")
                header_.comments.emplace_back(trimmed(line));
            else if (!keyword.empty())
                throw Error(
                    "line {}: the PLY header has {}; expected format, comment, obj_info, element, property or "
                    "end_header",
                    header_.lines, quote(keyword));
        }
        if (!formatted_) throw Error("line {}: the PLY header ends without a format line", header_.lines);
        header_.size = at_;
        return std::move(header_);
    }

private:
    static std::string_view line_end_of(std::string_view file) {
        const std::size_t first = file.find_first_of("\r\n");
        if (first == std::string_view::npos || file[first] == '\n') return "\n";
        return file.substr(first, 2) == "\r\n" ? "\n" : "\r";  // a CR before LF is a blank
    }

    std::string_view next_line() {
        const std::size_t end = file_.find(line_end_, at_);
        // A header that ends the file needs no line end after its last word.
        if (end == std::string_view::npos && at_ >= file_.size())
            throw Error("the file ends after {} inside its PLY header; 'end_header' is missing",
                        count_text(header_.lines, "line", "lines"));
        const std::string_view line = file_.substr(at_, end == std::string_view::npos ? end : end - at_);
        at_ = end == std::string_view::npos ? file_.size() : end + 1;
        ++header_.lines;
        return line;
    }

    void parse_format(std::string_view line) {
        const std::string_view name = word(line);
        if (name == "ascii")
            header_.encoding = PlyEncoding::ascii;
        else if (name == "binary_little_endian")
            header_.encoding = PlyEncoding::binary_little_endian;
        else if (name == "binary_big_endian")
            header_.encoding = PlyEncoding::binary_big_endian;
        else
            throw Error("line {}: the format {} is unknown; PLY has ascii, binary_little_endian and binary_big_endian",
                        header_.lines, quote(name));
        formatted_ = true;
    }

    void parse_element(std::string_view line) {
        constexpr std::size_t most_elements = 1000;
        PlyElement element;
        element.name = word(line);
        const std::string_view digits = word(line);
        const auto [rest, error] = std::from_chars(digits.data(), digits.data() + digits.size(), element.count);
        if (element.name.empty() || digits.empty() || error != std::errc() || rest != digits.data() + digits.size())
            throw Error("line {}: expected 'element NAME COUNT' with a count from 0 to 2^64 - 1, found element {} {}",
                        header_.lines, quote(element.name), quote(digits));
        if (header_.elements.size() == most_elements)
            throw Error("line {}: more than {} elements", header_.lines, most_elements);
        for (const PlyElement& other : header_.elements)
            if (other.name == element.name)
                throw Error("line {}: the element {} is declared twice", header_.lines, quote(element.name));
        header_.elements.push_back(std::move(element));
    }

    ScalarType parse_type(std::string_view name) const {
        for (std::size_t i = 0; i < ply_type_names.size(); ++i)
            if (const auto type = static_cast<ScalarType>(i); name == ply_type_names[i] || name == name_of(type))
                return type;
        throw Error(
            "line {}: the property type {} is unknown; PLY has char, uchar, short, ushort, int, uint, float, double, "
            "and list",
            header_.lines, quote(name));
    }

    void parse_property(std::string_view line) {
        constexpr std::size_t most_properties = 1000;
        if (header_.elements.empty()) throw Error("line {}: a property before the first element", header_.lines);
        PlyElement& element = header_.elements.back();
        PlyProperty property;
        std::string_view type = word(line);
        if (type == "list") {
            property.count_type = parse_type(word(line));
            if (is_floating(*property.count_type))
                throw Error("line {}: the length of a list must be of an integer type", header_.lines);
            type = word(line);
        }
        property.type = parse_type(type);
        property.name = word(line);
        if (property.name.empty()) throw Error("line {}: the property has no name", header_.lines);
        if (element.find(property.name))
            throw Error("line {}: the element {} has two properties called {}", header_.lines, quote(element.name),
                        quote(property.name));
        if (element.properties.size() == most_properties)
            throw Error("line {}: the element {} has more than {} properties", header_.lines, quote(element.name),
                        most_properties);
        element.properties.push_back(std::move(property));
    }

    std::string_view file_;
    std::string_view line_end_;
    std::size_t at_ = 0;
    bool formatted_ = false;
    PlyHeader header_;
};

}  // namespace

const PlyProperty* PlyElement::find(std::string_view property) const {
    const auto found = std::ranges::find(properties, property, &PlyProperty::name);
    return found == properties.end() ? nullptr : &*found;
}

std::size_t PlyElement::row_size() const {
    std::size_t size = 0;
    for (const PlyProperty& property : properties) size += size_of(property.type);
    return size;
}

bool PlyElement::has_lists() const { return std::ranges::any_of(properties, &PlyProperty::is_list); }

PlyHeader parse_ply_header(std::string_view file) { return HeaderParser(file).parse(); }

void require_room(const PlyElement& element, PlyEncoding encoding, std::size_t left) {
    const bool is_text = encoding == PlyEncoding::ascii;
    // The least size of a row. A binary row has the scalars and the lengths of empty lists; a row of text has a digit
    // and a separator for each property.
    u64 row = 0;
    for (const PlyProperty& property : element.properties)
        row += is_text ? 2 : size_of(property.count_type.value_or(property.type));
    if (row == 0) return;
    // The last row of a text needs no line end.
    const u64 fitting = (left + (is_text ? 1 : 0)) / row;
    if (element.count > fitting)
        throw Error("the header promises {} of element {}, each at least {} long; the {} that follow hold at most {}",
                    count_text(element.count, "row", "rows"), quote(element.name), count_text(row, "byte", "bytes"),
                    count_text(left, "byte", "bytes"), fitting)
            .hint(truncated_hint);
}

}  // namespace scanmill
