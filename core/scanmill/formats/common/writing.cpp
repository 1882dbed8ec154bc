// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/common/writing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scanmill/data/quantity.hpp"
#include "scanmill/formats/common/rounding.hpp"

namespace scanmill {

namespace {

/// The exact error when origin + position is rounded to double (Knuth's two-sum).
double rounding_error(double origin, double position) {
    const double sum = origin + position;
    const double part = sum - origin;
    return (origin - (sum - part)) + (position - part);
}

/// The length in bytes of the UTF-8 character at the beginning of the text; 0 for control characters and invalid
/// characters. RFC 3629 allows the shortest form only, no surrogates and nothing above U+10FFFF. XML also refuses
/// U+FFFE and U+FFFF.
std::size_t character_length(std::string_view text) {
    const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
    const unsigned first = byte(0);
    const std::size_t length = first < 0x80 ? 1 : first >> 5 == 6 ? 2 : first >> 4 == 14 ? 3 : first >> 3 == 30 ? 4 : 0;
    if (length == 0) return 0;
    unsigned code = length == 1 ? first : first & (0x7f >> length);
    for (std::size_t i = 1; i < length; ++i) {
        if (byte(i) >> 6 != 2) return 0;
        code = code << 6 | (byte(i) & 0x3f);
    }
    constexpr std::array<unsigned, 5> least{0, ' ', 0x80, 0x800, 0x10000};
    const bool is_surrogate = code >= 0xd800 && code <= 0xdfff;
    return code < least[length] || code == 0x7f || is_surrogate || code == 0xfffe || code == 0xffff || code > 0x10ffff
               ? 0
               : length;
}

template <class T>
void put_numbers(const Column& column, std::size_t row, OutputBuffer& out) {
    for (const T value : column.values<T>().subspan(row * column.components(), column.components())) {
        out.text(" ");
        out.number(value);
    }
}

}  // namespace

bool all_floats(const Frame& frame, std::span<const Vec3> positions) {
    for (const Vec3& position : positions) {
        const Vec3 p = world(frame, position);
        for (int axis = 0; axis < 3; ++axis)
            if (rounded_to_float(p[axis]) != p[axis] && !std::isnan(p[axis])) return false;
    }
    return true;
}

void warn_lost_precision(const Frame& frame, std::span<const Vec3> positions, bool as_float, std::string_view format,
                         const WriteOptions& options) {
    constexpr double bearable = 1e-6;
    double worst = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
        if (!positions[i].allFinite()) continue;
        const Vec3 p = world(frame, positions[i]);
        for (int axis = 0; axis < 3; ++axis) {
            const double written = as_float ? rounded_to_float(p[axis]) : p[axis];
            if (!std::isfinite(written))
                throw Error("point {} has the coordinate {}, beyond what {} can write", i, number_text(p[axis]), format)
                    .hint("write PLY, or change the unit");
            const double lost = std::abs((written - p[axis]) - rounding_error(frame.origin[axis], positions[i][axis]));
            worst = std::max(worst, lost);
        }
    }
    const double diagonal = bounding_box(positions).diagonal();
    if (worst <= bearable * diagonal) return;
    warn(options.on_warning, "coordinates moved by up to {:.2g}, {:.2g} of the diagonal: {} has {} precision; {}",
         worst, worst / diagonal, format, as_float ? "single" : "double",
         as_float ? "PLY keeps them" : "write it in a frame nearer to the scan");
}

void warn_left_out(const ColumnTable& columns, std::string_view element, std::string_view format,
                   const WriteOptions& options, std::span<const std::string_view> kept) {
    std::vector<std::string_view> names;
    for (const Column& column : columns)
        if (std::ranges::find(kept, column.name()) == kept.end() && !options.added_columns.contains(column.name()))
            names.push_back(column.name());
    if (!names.empty())
        warn(options.on_warning, "{} left out {} of the {} ({}); PLY keeps them", format,
             count_text(names.size(), "column", "columns"), element, fmt::join(names, ", "));
}

TriangleMesh with_used_vertices(const TriangleMesh& mesh, std::string_view format, const WriteOptions& options) {
    std::vector<bool> is_used(mesh.positions.size(), false);
    for (const Triangle& triangle : mesh.triangles)
        for (const u32 vertex : triangle) is_used[vertex] = true;
    const auto unused = static_cast<std::size_t>(std::ranges::count(is_used, false));
    if (unused == 0) return mesh;  // shares its arrays
    warn(options.on_warning, "{} left out {} that no triangle uses; PLY keeps them", format,
         count_text(unused, "vertex", "vertices"));
    return without_unused_vertices(mesh);
}

void warn_bare_triangles(const TriangleMesh& mesh, std::string_view format, const WriteOptions& options,
                         std::span<const std::string_view> kept_of_vertices,
                         std::span<const std::string_view> kept_of_faces) {
    warn_left_out(mesh.vertex_columns, "vertices", format, options, kept_of_vertices);
    warn_left_out(mesh.face_columns, "faces", format, options, kept_of_faces);
    warn_left_out(mesh.edge_columns, "edges", format, options);
    if (!mesh.sharp_edges.empty())
        warn(options.on_warning, "{} left out that {} are sharp; PLY keeps it", format,
             count_text(mesh.sharp_edges.size(), "edge", "edges"));
}

std::string one_line(std::string_view name) {
    std::string line(name);
    for (char& c : line)
        if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = ' ';
    const std::size_t begin = line.find_first_not_of(' ');
    return begin == std::string::npos ? "" : line.substr(begin, line.find_last_not_of(' ') + 1 - begin);
}

std::string exponent_comment(const Column& column) {
    if (column.length_exponent() == 0) return {};
    return fmt::format("length-exponent {} {}", column.length_exponent(), column.name());
}

std::string comment_lines(const Frame& frame, std::string_view prefix) {
    std::string lines;
    if (frame.unit != LengthUnit::unknown) lines += fmt::format("{}unit {}\n", prefix, symbol(frame.unit));
    if (const std::string name = one_line(frame.name); !name.empty())
        lines += fmt::format("{}frame {}\n", prefix, name);
    return lines;
}

std::string valid_text(std::string_view text) {
    std::string valid;
    while (!text.empty()) {
        const std::size_t length = character_length(text);
        valid += length == 0 ? "_" : text.substr(0, length);
        text.remove_prefix(std::max<std::size_t>(length, 1));
    }
    return valid;
}

std::string xml_escaped(std::string_view text) {
    std::string xml;
    for (const char c : text) {
        switch (c) {
            case '&': xml += "&amp;"; break;
            case '<': xml += "&lt;"; break;
            case '>': xml += "&gt;"; break;
            case '"': xml += "&quot;"; break;
            default: xml += c;
        }
    }
    return xml;
}

WrittenNames::WrittenNames(std::string_view format, const WriteOptions& options, std::set<std::string> taken)
    : format_(format),
      options_(&options),
      taken_(std::move(taken)) {}

std::string WrittenNames::add(std::string_view column, std::string wanted, std::string_view expected) {
    while (!taken_.insert(wanted).second) wanted += "_2";
    if (wanted != expected)
        warn(options_->on_warning, "{} holds the column '{}' under the name '{}'", format_, column, wanted);
    return wanted;
}

bool has_floats(const Column& column, u32 components) {
    return column.components() == components &&
           (column.type() == ScalarType::float32 || column.type() == ScalarType::float64);
}

TextColumns::TextColumns(const ColumnTable& columns)
    : normal(columns.find("normal")),
      colour(columns.find("colour")),
      texture(columns.find("texture")) {
    if (normal && !has_floats(*normal, 3)) normal = nullptr;
    if (texture && !has_floats(*texture, 2)) texture = nullptr;
    if (colour && (colour->type() != ScalarType::uint8 || colour->components() < 3 || colour->components() > 4))
        colour = nullptr;
}

std::vector<std::string_view> TextColumns::names() const {
    std::vector<std::string_view> names;
    for (const Column* column : {normal, colour, texture})
        if (column) names.push_back(column->name());
    return names;
}

void put_position(const Frame& frame, const Vec3& position, OutputBuffer& out) {
    const Vec3 p = world(frame, position);
    for (int axis = 0; axis < 3; ++axis) {
        if (axis > 0) out.text(" ");
        out.number(p[axis]);
    }
}

void put_row_text(const Column& column, std::size_t row, OutputBuffer& out) {
    switch (column.type()) {
        case ScalarType::float32: return put_numbers<float>(column, row, out);
        case ScalarType::float64: return put_numbers<double>(column, row, out);
        default: return put_numbers<u8>(column, row, out);
    }
}

}  // namespace scanmill
