// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>
#include <cctype>
#include <cstring>

#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/text_cursor.hpp"
#include "scanmill/formats/stl/detail/corner_merger.hpp"
#include "scanmill/formats/stl/stl.hpp"
#include "scanmill/io/output_buffer.hpp"

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

namespace {

bool same_word(std::string_view text, std::string_view lower) {
    return std::ranges::equal(text, lower, [](unsigned char a, unsigned char b) { return std::tolower(a) == b; });
}

/// Blanks, then "solid" as a word of its own.
bool begins_with_solid(std::string_view head) {
    TextCursor text(head);
    return text.next_row() && same_word(text.token(), "solid");
}

bool has_binary_size(std::string_view head, u64 file_size) {
    if (head.size() < stl_header_size + 4) return false;
    return file_size == stl_header_size + 4 + u64(little_endian<u32>(head.data() + stl_header_size)) * stl_facet_size;
}

struct Soup {
    explicit Soup(std::size_t facets) : merger(3 * facets) { triangles.reserve(facets); }

    CornerMerger merger;
    Array<Triangle> triangles;
    ColumnTable columns;
};

LoadedFile assembled(Soup soup, std::vector<std::string> comments, std::string encoding, const ReadOptions& options) {
    if (soup.triangles.empty()) throw Error("holds no points: the STL file has no facets");
    const auto degenerate = std::ranges::count_if(
        soup.triangles, [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
    if (const auto count = static_cast<u64>(degenerate); count > 0)
        warn(options.on_warning, "{} of {} {} degenerate (two corners at one place); {} kept", degenerate,
             count_text(soup.triangles.size(), "facet", "facets"), by_count(count, "is", "are"),
             by_count(count, "it is", "they are"));
    TriangleMesh mesh;
    mesh.frame = declared_frame(comments, options);
    Array<Vec3> positions = soup.merger.take_positions();
    move_near_origin(positions, bounding_box(positions), mesh.frame);
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(soup.triangles);
    mesh.face_columns = std::move(soup.columns);
    return {std::make_shared<const TriangleMesh>(std::move(mesh)), "STL", std::move(encoding), std::move(comments)};
}

LoadedFile read_binary(std::string_view bytes, const ReadOptions& options) {
    constexpr std::size_t body = stl_header_size + 4;
    if (bytes.size() < body)
        throw Error("is {} long; a binary STL file has a header of {} bytes and a count of 4",
                    count_text(bytes.size(), "byte", "bytes"), stl_header_size);
    const std::size_t facets = little_endian<u32>(bytes.data() + stl_header_size);
    const std::size_t fitting = (bytes.size() - body) / stl_facet_size;
    if (facets > fitting)
        throw Error("the STL header promises {} of {} bytes; the {} that follow hold {}",
                    count_text(facets, "facet", "facets"), stl_facet_size,
                    count_text(bytes.size() - body, "byte", "bytes"), fitting)
            .hint("the file is truncated or no STL at all: fetch or export it again");
    if (const std::size_t rest = bytes.size() - body - facets * stl_facet_size; rest > 0)
        warn(options.on_warning, "{} after the last facet passed over at the file's end",
             count_text(rest, "byte", "bytes"));

    Soup soup(facets);
    Array<std::uint16_t> attributes(facets);
    std::uint16_t any_attribute = 0;
    const char* facet = bytes.data() + body;
    for (std::size_t i = 0; i < facets; ++i, facet += stl_facet_size) {
        Triangle triangle;
        for (std::size_t corner = 0; corner < 3; ++corner) {
            // The stored normal comes first: twelve bytes.
            const char* place = facet + 12 * (corner + 1);
            triangle[corner] = soup.merger.add(
                {little_endian<float>(place), little_endian<float>(place + 4), little_endian<float>(place + 8)});
        }
        soup.triangles.push_back(triangle);
        attributes[i] = little_endian<std::uint16_t>(facet + 48);
        any_attribute |= attributes[i];
    }
    if (any_attribute != 0) soup.columns.add(Column("attribute", 1, Buffer(std::move(attributes))));
    return assembled(std::move(soup), stl_header_comments(bytes.substr(0, stl_header_size)), "binary", options);
}

class AsciiReader {
public:
    AsciiReader(std::string_view bytes, const ReadOptions& options)
        : options_(options),
          text_(bytes),
          soup_(bytes.size() / usual_facet_text) {}

    LoadedFile read() {
        bool inside = false;
        while (text_.next_row()) {
            const std::string_view word = text_.token();
            if (!inside && same_word(word, "solid")) {
                inside = true;
                ++solids_;
                begin_solid();
            } else if (inside && same_word(word, "endsolid")) {
                inside = false;
            } else if (inside && same_word(word, "facet")) {
                read_facet();
            } else {
                throw Error("line {}: found {}; expected {}", text_.line(), quote(word),
                            inside ? "facet or endsolid" : "solid");
            }
        }
        if (inside)
            throw Error("line {}: the text ends inside a solid, after {}; 'endsolid' is missing", text_.line(),
                        count_text(soup_.triangles.size(), "facet", "facets"))
                .hint("the file is truncated: fetch or export it again");
        if (solids_ > 1) soup_.columns.add(Column("solid", 1, Buffer(std::move(solid_of_))));
        return assembled(std::move(soup_), std::move(comments_), "ascii", options_);
    }

private:
    static constexpr std::size_t usual_facet_text = 200;

    /// The solid's name may be any words, keywords too: it ends with its line.
    void begin_solid() {
        std::string name;
        while (text_.more()) name.append(name.empty() ? "" : " ").append(text_.token());
        if (!name.empty()) comments_.push_back(std::move(name));
    }

    /// Keywords may lie on one line or on several.
    std::string_view next_word(std::string_view expected) {
        if (!text_.more() && !text_.next_row())
            throw Error("line {}: the text ends inside facet {}; expected '{}'", text_.line(), soup_.triangles.size(),
                        expected)
                .hint("the file is truncated: fetch or export it again");
        return text_.token();
    }

    void expect(std::string_view keyword) {
        const std::string_view word = next_word(keyword);
        if (!same_word(word, keyword))
            throw Error("line {}: found {} inside facet {}; expected '{}'", text_.line(), quote(word),
                        soup_.triangles.size(), keyword);
    }

    double number() {
        double value = 0;
        if (!text_.more()) throw Error("line {}: a vertex has three numbers, here are fewer", text_.line());
        if (!text_.number(value))
            throw Error("line {}: {} is no number for a vertex", text_.line(), quote(text_.last_token()));
        return value;
    }

    void read_facet() {
        require_countable(soup_.triangles.size() + 1, "facets");
        // The normal is not kept, so whatever is written there will do, "nan(ind)" too.
        while (text_.more()) {
            if (same_word(text_.token(), "outer")) return read_loop();
        }
        expect("outer");
        read_loop();
    }

    void read_loop() {
        expect("loop");
        Triangle triangle;
        for (u32& corner : triangle) {
            expect("vertex");
            const double x = number(), y = number(), z = number();
            corner = soup_.merger.add({x, y, z});
        }
        expect("endloop");
        expect("endfacet");
        soup_.triangles.push_back(triangle);
        solid_of_.push_back(solids_ - 1);
    }

    const ReadOptions& options_;
    TextCursor text_;
    Soup soup_;
    Array<u32> solid_of_;
    u32 solids_ = 0;
    std::vector<std::string> comments_;
};

}  // namespace

Recognition recognise_stl(std::string_view head, u64 file_size) {
    if (has_binary_size(head, file_size)) return Recognition::certain;
    // A zero byte is no text: then it is a broken binary file, if its extension says that it is one at all.
    if (begins_with_solid(head) && head.find('\0') == std::string_view::npos) return Recognition::certain;
    return Recognition::no;
}

LoadedFile read_stl(const FileBytes& file, const ReadOptions& options) {
    const std::string_view head = file.bytes.substr(0, head_size);
    const bool text = begins_with_solid(head) && head.find('\0') == std::string_view::npos;
    if (text && !has_binary_size(head, file.bytes.size())) return AsciiReader(file.bytes, options).read();
    return read_binary(file.bytes, options);
}

}  // namespace scanmill
