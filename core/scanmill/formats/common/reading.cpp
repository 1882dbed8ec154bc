// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/common/reading.hpp"

#include "scanmill/data/mesh.hpp"

namespace scanmill {

std::function<void(std::string)> warnings_with_file_name(const std::filesystem::path& path,
                                                         const std::function<void(std::string)>& on_warning) {
    if (!on_warning) return {};
    return [path, &on_warning](const std::string& sentence) { on_warning("'" + path.string() + "': " + sentence); };
}

std::string_view without_byte_order_mark(std::string_view text) {
    constexpr std::string_view mark = "\xef\xbb\xbf";
    if (text.starts_with(mark)) text.remove_prefix(mark.size());
    return text;
}

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blanks = " \t\v\f\r";
    text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
    return text.substr(0, text.find_last_not_of(blanks) + 1);
}

std::string_view declaration_in(std::string_view comment, std::string_view keyword) {
    comment = trimmed(comment);
    if (!comment.starts_with(keyword) || comment.size() == keyword.size() || comment[keyword.size()] != ' ') return {};
    comment = trimmed(comment.substr(keyword.size()));
    const bool is_prose = keyword == "unit" && comment.find(' ') != std::string_view::npos;
    return is_prose ? std::string_view() : comment;
}

LengthUnit chosen_unit(LengthUnit declared, const ReadOptions& options) {
    if (options.unit == LengthUnit::unknown) return declared;
    if (declared != LengthUnit::unknown && declared != options.unit)
        warn(options.on_warning, "the file declares 'unit {}'; it was read in {}, as requested", symbol(declared),
             symbol(options.unit));
    return options.unit;
}

Frame declared_frame(const std::vector<std::string>& comments, const ReadOptions& options) {
    Frame frame;
    for (const std::string& comment : comments) {
        if (const std::string_view text = declaration_in(comment, "unit"); !text.empty()) {
            const auto unit = length_unit(text);
            if (!unit) {
                warn(options.on_warning, "the unit {} is unknown and was ignored; known units are {}", quote(text),
                     length_unit_symbols());
                continue;
            }
            if (frame.unit != LengthUnit::unknown && frame.unit != *unit)
                warn(options.on_warning, "the file declares both 'unit {}' and 'unit {}'; the last counts",
                     symbol(frame.unit), symbol(*unit));
            frame.unit = *unit;
        }
        if (const std::string_view name = declaration_in(comment, "frame"); !name.empty()) frame.name = name;
    }
    frame.unit = chosen_unit(frame.unit, options);
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

namespace {

void move_to(const Vec3& origin, Array<Vec3>& positions, Frame& frame) {
    frame.origin = origin;
    if (frame.origin == Vec3::Zero()) return;
    for (Vec3& p : positions) p -= frame.origin;
}

}  // namespace

void move_near_origin(Array<Vec3>& positions, Frame& frame, std::optional<BoundingBox> box) {
    move_to(distant_origin(robust_box(positions, box ? *box : bounding_box(positions))), positions, frame);
}

LoadedFile loaded_file(std::string format, std::string encoding, std::vector<std::string> comments,
                       Array<Vec3> positions, TriangleMesh mesh, const ReadOptions& options,
                       std::optional<BoundingBox> box) {
    mesh.frame = declared_frame(comments, options);
    if (mesh.triangles.empty())
        move_near_origin(positions, mesh.frame, box);
    else
        move_to(distant_origin(box ? *box : bounding_box(positions)), positions, mesh.frame);
    mesh.positions = std::move(positions);
    Value value = mesh.triangles.empty() ? Value(std::make_shared<const PointCloud>(points_of(mesh)))
                                         : Value(std::make_shared<const TriangleMesh>(std::move(mesh)));
    return {std::move(value), std::move(format), std::move(encoding), std::move(comments)};
}

}  // namespace scanmill
