// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/ply/detail/ply_header.hpp"

#include <algorithm>
#include <charconv>

#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/reading.hpp"

namespace scanmill {

namespace {

struct TypeName {
    std::string_view name;
    ScalarType type;
};
constexpr std::array<TypeName, 18> type_names{{
    {"char", ScalarType::int8},
    {"int8", ScalarType::int8},
    {"uchar", ScalarType::uint8},
    {"uint8", ScalarType::uint8},
    {"short", ScalarType::int16},
    {"int16", ScalarType::int16},
    {"ushort", ScalarType::uint16},
    {"uint16", ScalarType::uint16},
    {"int", ScalarType::int32},
    {"int32", ScalarType::int32},
    {"uint", ScalarType::uint32},
    {"uint32", ScalarType::uint32},
    {"int64", ScalarType::int64},
    {"uint64", ScalarType::uint64},
    {"float", ScalarType::float32},
    {"float32", ScalarType::float32},
    {"double", ScalarType::float64},
    {"float64", ScalarType::float64},
}};

std::string_view word(std::string_view& line) {
    const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!line.empty() && blank(line.front())) line.remove_prefix(1);
    std::size_t length = 0;
    while (length < line.size() && !blank(line[length])) ++length;
    const std::string_view found = line.substr(0, length);
    line.remove_prefix(length);
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

    static std::string_view trimmed(std::string_view text) {
        while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
        while (!text.empty() && (text.back() == '\r' || text.back() == ' ')) text.remove_suffix(1);
        return text;
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
        const auto found = std::ranges::find(type_names, name, &TypeName::name);
        if (found == type_names.end())
            throw Error(
                "line {}: the property type {} is unknown; PLY has char, uchar, short, ushort, int, uint, "
                "float, double, and list",
                header_.lines, quote(name));
        return found->type;
    }

    void parse_property(std::string_view line) {
        constexpr std::size_t most_properties = 1000;
        if (header_.elements.empty())
            throw Error("line {}: a property before the first element; it belongs to nothing", header_.lines);
        PlyElement& element = header_.elements.back();
        PlyProperty property;
        std::string_view type = word(line);
        if (type == "list") {
            property.count_type = parse_type(word(line));
            if (*property.count_type == ScalarType::float32 || *property.count_type == ScalarType::float64)
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

/// Bytes that a row takes at the least: in binary exactly its scalars and the lengths of empty lists, in ascii a digit
/// and a separator for each.
u64 least_row(const PlyElement& element, PlyEncoding encoding) {
    u64 bytes = 0;
    for (const PlyProperty& property : element.properties)
        bytes += encoding == PlyEncoding::ascii ? 2 : size_of(property.count_type.value_or(property.type));
    return bytes;
}

}  // namespace

const PlyProperty* PlyElement::find(std::string_view property) const {
    const auto found = std::ranges::find(properties, property, &PlyProperty::name);
    return found == properties.end() ? nullptr : &*found;
}

bool PlyElement::has_lists() const { return std::ranges::any_of(properties, &PlyProperty::is_list); }

PlyHeader parse_ply_header(std::string_view file) { return HeaderParser(file).parse(); }

void require_room(const PlyElement& element, PlyEncoding encoding, std::size_t left) {
    const u64 row = least_row(element, encoding);
    if (row == 0) return;
    // The last row of a text needs no line end.
    const u64 fitting = (left + (encoding == PlyEncoding::ascii ? 1 : 0)) / row;
    if (element.count > fitting)
        throw Error("the header promises {} of element {}, each at least {} long; the {} that follow hold at most {}",
                    count_text(element.count, "row", "rows"), quote(element.name), count_text(row, "byte", "bytes"),
                    count_text(left, "byte", "bytes"), fitting)
            .hint("the file is truncated or its header is wrong: fetch or export it again");
}

}  // namespace scanmill
