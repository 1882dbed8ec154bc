// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>

#include "scanmill/formats/common/built_in.hpp"
#include "scanmill/formats/common/position_merger.hpp"
#include "scanmill/formats/common/rounding.hpp"
#include "scanmill/formats/common/text_cursor.hpp"
#include "scanmill/formats/common/writing.hpp"
#include "scanmill/io/output_buffer.hpp"

namespace scanmill {

namespace {

constexpr std::size_t header_size = 80, facet_size = 50;
constexpr std::string_view signature = "binary STL by scanmill";
constexpr std::string_view unit_key = "; unit ";
constexpr std::string_view shift_key = "; shift ";
constexpr std::string_view frame_key = "; frame ";

std::string header_of(const Frame& frame, const Vec3& shift) {
    std::string header(signature);
    if (frame.unit != LengthUnit::unknown) header.append(unit_key).append(symbol(frame.unit));
    if (shift != Vec3::Zero()) header.append(shift_key).append(shift_text(shift));
    if (!frame.name.empty()) header.append(frame_key).append(frame.name);
    header.resize(header_size, ' ');
    return header;
}

/// The comments "unit mm", "shift X Y Z" and "frame NAME" of a header from header_of(). For other headers, the whole
/// text.
std::vector<std::string> header_comments(std::string_view header) {
    header = trimmed(header.substr(0, header.find('\0')));
    if (header.empty()) return {};
    if (!header.starts_with(signature)) return {std::string(header)};
    std::vector<std::string> comments;
    header.remove_prefix(signature.size());
    // The frame's name is last and may contain anything, also semicolons.
    for (std::string_view key : {unit_key, shift_key, frame_key}) {
        if (!header.starts_with(key)) continue;
        header.remove_prefix(2);
        const std::size_t end = key == frame_key ? std::string_view::npos : header.find(';');
        comments.emplace_back(header.substr(0, end));
        header.remove_prefix(comments.back().size());
    }
    return comments;
}

bool same_word(std::string_view text, std::string_view lower) {
    return std::ranges::equal(text, lower, [](unsigned char a, unsigned char b) { return std::tolower(a) == b; });
}

/// Whether the file begins with the word "solid" and is text.
bool is_ascii(std::string_view head) {
    TextCursor text(head);
    return text.next_row() && same_word(text.token(), "solid") && head.find('\0') == std::string_view::npos;
}

bool has_binary_size(std::string_view head, u64 file_size) {
    if (head.size() < header_size + 4) return false;
    return file_size == header_size + 4 + u64(little_endian<u32>(head.data() + header_size)) * facet_size;
}

struct Soup {
    /// A closed triangulation has about two facets per vertex.
    explicit Soup(std::size_t facets) : merger(facets / 2) { triangles.reserve(facets); }

    LoadedFile mesh(std::vector<std::string> comments, std::string encoding, const ReadOptions& options) {
        if (triangles.empty()) throw Error("holds no points: the STL file has no facets");
        const auto has_equal_corners = [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; };
        const auto is_finite = [&](const Triangle& t) {
            return std::ranges::all_of(t, [&](u32 corner) { return merger.positions[corner].allFinite(); });
        };
        u64 count = 0, not_finite = 0;
        for (const Triangle& triangle : triangles)
            if (has_equal_corners(triangle)) ++(is_finite(triangle) ? count : not_finite);
        if (count + not_finite == triangles.size()) refuse(count, not_finite);
        if (count > 0)
            warn(options.on_warning, "{} of {} {} degenerate (two equal corners); {} kept", count,
                 count_text(triangles.size(), "facet", "facets"), by_count(count, "is", "are"),
                 by_count(count, "it is", "they are"));
        TriangleMesh mesh;
        mesh.triangles = std::move(triangles);
        mesh.face_columns = std::move(columns);
        return loaded_file("STL", std::move(encoding), std::move(comments), std::move(merger.positions),
                           std::move(mesh), options);
    }

    PositionMerger merger;
    Array<Triangle> triangles;
    ColumnTable columns;

private:
    /// Throws Error for a file whose facets all have equal corners. The coordinates of `finite` facets are finite,
    /// those of `not_finite` facets are not.
    [[noreturn]] static void refuse(u64 finite, u64 not_finite) {
        const u64 facets = finite + not_finite;
        const std::string all = facets > 1 ? fmt::format("all {} facets", facets) : std::string("the only facet");
        if (not_finite > 0)
            throw Error("holds no surface: {} of the STL file {} two equal corners{} NaN or infinite coordinates", all,
                        by_count(facets, "has", "have"),
                        finite > 0 ? fmt::format(", {} of them with", not_finite) : std::string(" with"))
                .hint("the program that wrote it failed to compute the positions: export the object again");
        throw Error("holds no surface: {} of the STL file {} two equal corners", all, by_count(facets, "has", "have"))
            .hint(
                "the program that wrote it lost digits, as single precision does far from zero: move the object near "
                "zero there, or export it as PLY");
    }
};

LoadedFile read_binary(std::string_view bytes, const ReadOptions& options) {
    constexpr std::size_t body = header_size + 4;
    if (bytes.size() < body)
        throw Error("is {} long; a binary STL file has a header of {} bytes and a count of 4",
                    count_text(bytes.size(), "byte", "bytes"), header_size);
    const std::size_t facets = little_endian<u32>(bytes.data() + header_size);
    const std::size_t fitting = (bytes.size() - body) / facet_size;
    if (facets > fitting)
        throw Error("the STL header promises {} of {} bytes; the {} that follow hold {}",
                    count_text(facets, "facet", "facets"), facet_size, count_text(bytes.size() - body, "byte", "bytes"),
                    fitting)
            .hint("the file is truncated or not an STL file: fetch or export it again");
    if (const std::size_t rest = bytes.size() - body - facets * facet_size; rest > 0)
        warn(options.on_warning, "{} after the last facet ignored", count_text(rest, "byte", "bytes"));

    Soup soup(facets);
    Array<std::uint16_t> attributes(facets);
    std::uint16_t any_attribute = 0;
    const char* facet = bytes.data() + body;
    for (std::size_t i = 0; i < facets; ++i, facet += facet_size) {
        Triangle triangle;
        for (std::size_t corner = 0; corner < 3; ++corner) {
            // The stored normal comes first: twelve bytes.
            const char* source = facet + 12 * (corner + 1);
            triangle[corner] = soup.merger.add(
                {little_endian<float>(source), little_endian<float>(source + 4), little_endian<float>(source + 8)});
        }
        soup.triangles.push_back(triangle);
        attributes[i] = little_endian<std::uint16_t>(facet + 48);
        any_attribute |= attributes[i];
    }
    if (any_attribute != 0) soup.columns.add(Column("attribute", 1, Buffer(std::move(attributes))));
    std::vector<std::string> comments = header_comments(bytes.substr(0, header_size));
    for (const std::string& comment : comments)
        if (const std::string_view shift = declaration_in(comment, "shift"); !shift.empty())
            warn(options.on_warning,
                 "its coordinates are relative to {}: add these three numbers for world coordinates", quote(shift));
    return soup.mesh(std::move(comments), "binary", options);
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
        return soup_.mesh(std::move(comments_), "ascii", options_);
    }

private:
    static constexpr std::size_t usual_facet_text = 200;

    /// The solid's name ends with its line and may be any words, also keywords.
    void begin_solid() {
        std::string name;
        while (text_.more()) name.append(name.empty() ? "" : " ").append(text_.token());
        if (!name.empty()) comments_.push_back(std::move(name));
    }

    /// The next word of the facet. Keywords may be on one line or on several lines.
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

    void read_facet() {
        require_countable(soup_.triangles.size() + 1, "facets");
        // The normal is not kept, so it may be any words, also "nan(ind)".
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
            Vec3 position;
            for (double& coordinate : position) coordinate = next_number(text_, "a coordinate of a vertex");
            corner = soup_.merger.add(position);
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

Recognition recognise(std::string_view head, u64 file_size) {
    if (has_binary_size(head, file_size)) return Recognition::certain;
    // A file with a zero byte is not text. It may be a broken binary file if its extension is .stl.
    return is_ascii(head) ? Recognition::certain : Recognition::no;
}

LoadedFile read(const FileBytes& file, const ReadOptions& options) {
    const std::string_view head = file.bytes.substr(0, head_size);
    if (is_ascii(head) && !has_binary_size(head, file.bytes.size())) return AsciiReader(file.bytes, options).read();
    return read_binary(file.bytes, options);
}

/// The unit normal; zero for a triangle without area or with coordinates that are not finite.
Vec3 facet_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
    Vec3 u = b - a, v = c - a;
    // The edges are scaled first, because the cross product of tiny or huge edges would leave the range of double.
    const double scale = std::max(u.cwiseAbs().maxCoeff(), v.cwiseAbs().maxCoeff());
    if (!(scale > 0) || !std::isfinite(scale)) return Vec3::Zero();
    u /= scale;
    v /= scale;
    const Vec3 normal = u.cross(v);
    const double length = normal.stableNorm();
    if (!(length > 0)) return Vec3::Zero();
    return normal / length;
}

void put(const Eigen::Vector3f& p, OutputBuffer& out) {
    for (int axis = 0; axis < 3; ++axis) out.binary(p[axis]);
}

void warn_cut_frame(const Frame& frame, const std::string& header, const WriteOptions& options) {
    const std::vector<std::string> kept = header_comments(header);
    if (!frame.name.empty() && (kept.empty() || kept.back() != "frame " + frame.name))
        warn(options.on_warning,
             "the frame's name of {} bytes does not fit into STL's header and was cut; PLY keeps it",
             frame.name.size());
}

void write(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const TriangleMesh& whole = *value.get<TriangleMesh>();
    if (whole.triangles.empty()) throw Error("nothing to write: the mesh has no triangles, and STL holds nothing else");
    require_countable(whole.triangles.size(), "triangles");
    const TriangleMesh mesh = with_used_vertices(whole, "STL", options);
    const Vec3 shift = shift_for_floats(mesh);
    Frame shifted = mesh.frame;
    shifted.origin -= shift;
    if (shift != Vec3::Zero()) {
        warn(options.on_warning,
             "coordinates are written relative to {}: STL's single precision does not hold them so far from zero; add "
             "these three numbers to get them back, or write PLY",
             shift_text(shift));
        if (options.on_shift) options.on_shift(shift);
    }
    warn_lost_precision(shifted, mesh.positions.span(), true, "STL", options);
    warn_bare_triangles(mesh, "STL", options);
    const JoinedVertices joined = joined_vertices(
        mesh, [&](std::size_t vertex) { return rounded_to_float(world(shifted, mesh.positions[vertex])); });
    const Buffer<Triangle> triangles = triangles_of_positions(mesh, joined, "STL", options);

    Frame frame = mesh.frame;
    frame.name = one_line(frame.name);
    const std::string header = header_of(frame, shift);
    warn_cut_frame(frame, header, options);
    out.text(header);
    out.binary(static_cast<u32>(triangles.size()));
    for (const Triangle& triangle : triangles) {
        const Vec3 &a = mesh.positions[triangle[0]], &b = mesh.positions[triangle[1]], &c = mesh.positions[triangle[2]];
        put(facet_normal(a, b, c).cast<float>(), out);
        for (u32 vertex : triangle) put(world(shifted, mesh.positions[vertex]).cast<float>(), out);
        out.binary(std::uint16_t(0));
    }
}

}  // namespace

Format stl_format() {
    Format stl{"STL", {"stl"}, recognise, read, {{kind_of<TriangleMesh>(), write}}};
    stl.memory_per_byte = 2;
    return stl;
}

}  // namespace scanmill
