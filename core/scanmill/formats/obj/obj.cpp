// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <ranges>
#include <unordered_set>

#include "scanmill/formats/common/built_in.hpp"
#include "scanmill/formats/common/colours.hpp"
#include "scanmill/formats/common/polygons.hpp"
#include "scanmill/formats/common/writing.hpp"
#include "scanmill/formats/obj/detail/corner_values.hpp"

namespace scanmill {

namespace {

constexpr TextRules rules{.comment = '#', .continuation = '\\'};

/// A corner of a face as the file spells it; 0 without a texture or normal.
struct Corner {
    std::int64_t vertex = 0, texture = 0, normal = 0;
};

/// Parses "7", "7/5", "7//3", "7/5/3"; also "7/" and "7//", which some programs write. nullopt for other tokens.
std::optional<Corner> parse_corner(std::string_view token) {
    Corner corner;
    const char* at = token.data();
    const char* const end = at + token.size();
    const auto read_number = [&](std::int64_t& number) {
        const auto [rest, error] = std::from_chars(at, end, number);
        at = rest;
        return error == std::errc();
    };
    const auto skip_slash = [&] { return at != end && *at == '/' && (++at, true); };
    const auto at_number = [&] { return at != end && *at != '/'; };
    if (!read_number(corner.vertex)) return std::nullopt;
    if (skip_slash()) {
        if (at_number() && !read_number(corner.texture)) return std::nullopt;
        if (skip_slash() && at_number() && !read_number(corner.normal)) return std::nullopt;
    }
    if (at != end) return std::nullopt;
    return corner;
}

/// The subject of a row, by the keyword that it begins with. Rows with the subject `shape` are read; other rows are
/// left out.
enum class Subject { shape, object, group, material, smoothing, library, line, point, free_form, display, unknown };

/// The keywords of each subject, from the manual and from the older versions that the manual lists.
constexpr std::array<std::string_view, 10> keywords_of{
    " v vn vt f fo ",
    " o ",
    " g ",
    " usemtl ",
    " s ",
    " mtllib ",
    " l ",
    " p ",
    " vp cstype deg bmat step curv curv2 surf parm trim hole scrv sp end con mg bsp bzp cdc cdp res ctech stech ",
    " bevel c_interp d_interp lod maplib usemap shadow_obj trace_obj call csh ",
};

Subject subject_of(std::string_view keyword) {
    const std::string word = fmt::format(" {} ", keyword);
    const auto has_word = [&](std::string_view keywords) { return keywords.find(word) != std::string_view::npos; };
    return static_cast<Subject>(std::ranges::find_if(keywords_of, has_word) - keywords_of.begin());
}

/// The rest of the row: a name of several words, one word or none.
std::string_view rest_of_row(TextCursor& text) {
    if (!text.more()) return {};
    const std::string_view first = text.token();
    std::string_view last = first;
    while (text.more()) last = text.token();
    return {first.data(), last.data() + last.size()};
}

/// Counts the rows that are not read, and warns about them.
class LeftOut {
public:
    /// Counts the row whose keyword was just read, and reads its name. The text must outlive this object.
    void add_row(std::string_view keyword, TextCursor& text) {
        constexpr std::size_t most_keywords = 4;
        const Subject subject = subject_of(keyword);
        Rows& rows = rows_[static_cast<std::size_t>(subject)];
        if (rows.count++ == 0) rows.first_line = text.line();
        if (subject >= Subject::object && subject <= Subject::library) {
            const std::string_view name = rest_of_row(text);
            if (rows.names.insert(name).second && rows.names.size() == 1) rows.first_name = name;
        } else if (rows.keywords.size() < most_keywords &&
                   std::ranges::find(rows.keywords, keyword) == rows.keywords.end()) {
            rows.keywords.push_back(keyword);
        }
    }

    /// Warns once for each subject. Objects, groups, materials and smoothing groups only divide the mesh, so there is
    /// no warning about a single object, group, material or smoothing group.
    void warn_all(const std::function<void(std::string)>& on_warning) const {
        constexpr std::array<std::pair<Subject, std::string_view>, 4> divisions{
            {{Subject::object, "objects (o)"},
             {Subject::group, "groups (g)"},
             {Subject::material, "materials (usemtl)"},
             {Subject::smoothing, "smoothing groups (s)"}}};
        std::vector<std::string> merged;
        for (const auto& [subject, name] : divisions)
            if (const std::size_t count = of(subject).names.size(); count > 1)
                merged.push_back(fmt::format("{} {}", count, name));
        if (!merged.empty())
            warn(on_warning, "{} were merged; the division of the faces was left out", fmt::join(merged, ", "));
        if (const Rows& rows = of(Subject::library); rows.count > 0)
            warn(on_warning, "{} not read: materials and their images were left out, the first of {}",
                 count_text(rows.names.size(), "material library (mtllib) was", "material libraries (mtllib) were"),
                 quote(rows.first_name));
        if (const Rows& rows = of(Subject::line); rows.count > 0)
            warn(on_warning, "{} left out, first in line {}", count_text(rows.count, "line (l) was", "lines (l) were"),
                 rows.first_line);
        if (const Rows& rows = of(Subject::point); rows.count > 0)
            warn(on_warning, "{} left out, first in line {}; all vertices are kept",
                 count_text(rows.count, "row of points (p) was", "rows of points (p) were"), rows.first_line);
        constexpr std::array<std::pair<Subject, std::string_view>, 3> others{
            {{Subject::free_form, "free-form curves and surfaces are not read"},
             {Subject::display, "they only concern the display"},
             {Subject::unknown, "OBJ has no such keyword"}}};
        for (const auto& [subject, reason] : others)
            if (const Rows& rows = of(subject); rows.count > 0)
                warn(on_warning, "{} left out, first in line {}: {} ({})",
                     count_text(rows.count, "row was", "rows were"), rows.first_line, reason,
                     fmt::join(rows.keywords | std::views::transform(quote), ", "));
    }

    /// "; line 1 begins with 'solid', which is not an OBJ keyword", for the message about a file without vertices.
    /// Empty if there is no such row.
    std::string first_unknown() const {
        const Rows& rows = of(Subject::unknown);
        if (rows.count == 0) return {};
        return fmt::format("; line {} begins with {}, which is not an OBJ keyword", rows.first_line,
                           quote(rows.keywords.front()));
    }

private:
    struct Rows {
        std::size_t count = 0;
        std::size_t first_line = 0;
        std::vector<std::string_view> keywords;  // distinct, the first few
        std::unordered_set<std::string_view> names;
        std::string_view first_name;
    };
    const Rows& of(Subject subject) const { return rows_[static_cast<std::size_t>(subject)]; }

    std::array<Rows, keywords_of.size() + 1> rows_;
};

class ObjReader {
public:
    ObjReader(const FileBytes& file, const ReadOptions& options)
        : options_(options),
          text_(without_byte_order_mark(file.bytes), rules) {
        // The usual numbers of bytes and corners per vertex, with two faces for each vertex.
        constexpr std::size_t usual_text = 64, usual_corners = 6;
        const std::size_t guess = file.bytes.size() / usual_text;
        positions_.reserve(guess);
        corners_.reserve(usual_corners * guess);
        offsets_.push_back(0);
    }

    LoadedFile read() {
        while (text_.next_row()) {
            const std::string_view keyword = text_.token();
            if (keyword == "v")
                read_vertex();
            else if (keyword == "f" || keyword == "fo")
                read_face();
            else if (keyword == "vn")
                read_normal();
            else if (keyword == "vt")
                read_texture();
            else
                left_out_.add_row(keyword, text_);
        }
        return finished();
    }

private:
    void read_vertex() {
        Vec3 position;
        for (double& coordinate : position) coordinate = next_number(text_, "a coordinate of a vertex (v)");
        positions_.push_back(position);
        if (text_.more() && text_.count_tokens() == 1)
            weighted_ += next_number(text_, "the weight of a vertex (v)") != 1;
        colours_.read_row(text_);
    }

    void read_normal() {
        for (int axis = 0; axis < 3; ++axis) normals_.add_number(next_number(text_, "a normal (vn)"));
        skip_rest();
    }

    void read_texture() {
        const auto number = [&] { return next_number(text_, "a texture coordinate (vt)"); };
        textures_.add_number(number());
        textures_.add_number(text_.more() ? number() : 0);
        if (text_.more() && number() != 0) ++deep_textures_;
        skip_rest();
    }

    /// Counts the row if it has superfluous numbers.
    void skip_rest() {
        if (text_.more() && overlong_++ == 0) first_overlong_ = text_.line();
    }

    void read_face() {
        while (text_.more()) {
            const std::string_view token = text_.token();
            const std::optional<Corner> corner = parse_corner(token);
            if (!corner) throw Error("line {}: {} is not a corner of a face", text_.line(), quote(token));
            if (corner->texture != 0) textures_.add_reference(corners_.size(), corner->texture);
            if (corner->normal != 0) normals_.add_reference(corners_.size(), corner->normal);
            corners_.push_back(vertex_of(corner->vertex));
        }
        offsets_.push_back(corners_.size());
    }

    u32 vertex_of(std::int64_t spelled) {
        const std::size_t count = positions_.size();
        if (spelled > 0) {
            const auto index = static_cast<u64>(spelled) - 1;
            if (index >= count && (ahead_.empty() || index > ahead_.back().index))
                ahead_.push_back({index, text_.line()});
            return static_cast<u32>(index);  // an index beyond 32 bits is missing, and refused at the end
        }
        if (spelled == 0) throw Error("line {}: a face names vertex 0; vertices are numbered from 1", text_.line());
        if (static_cast<u64>(-(spelled + 1)) >= count)
            throw Error("line {}: a face names vertex {}, counted backwards; there are {} before it", text_.line(),
                        spelled, count_text(count, "vertex", "vertices"));
        return static_cast<u32>(count - static_cast<u64>(-(spelled + 1)) - 1);
    }

    void require_vertices() const {
        if (positions_.empty()) throw Error("holds no points: no row is a vertex (v){}", left_out_.first_unknown());
        require_countable(positions_.size(), "vertices");
        // `ahead_` contains every index that is larger than all indices before it, and so the first missing index.
        for (const Ahead& ahead : ahead_)
            if (ahead.index >= positions_.size())
                throw Error("line {}: a face names vertex {}; there {} {}, numbered from 1", ahead.line,
                            ahead.index + 1, by_count(positions_.size(), "is", "are"),
                            count_text(positions_.size(), "vertex", "vertices"))
                    .hint("the file is truncated or wrong: fetch or export it again");
    }

    void warn_left_out() const {
        left_out_.warn_all(options_.on_warning);
        if (weighted_ > 0)
            warn(options_.on_warning,
                 "the weights of {} of {} vertices are not 1 and were left out: only free-form curves and surfaces use "
                 "them",
                 weighted_, positions_.size());
        if (deep_textures_ > 0)
            warn(options_.on_warning, "the third number of {} left out",
                 count_text(deep_textures_, "texture coordinate (vt) was", "texture coordinates (vt) was"));
        if (overlong_ > 0)
            warn(options_.on_warning, "{} more numbers than OBJ allows there, first in line {}; the rest was ignored",
                 count_text(overlong_, "row has", "rows have"), first_overlong_);
    }

    LoadedFile finished() {
        require_vertices();
        warn_left_out();
        const std::size_t vertices = positions_.size();
        TriangleMesh mesh;
        normals_.add_column(mesh.vertex_columns, corners_, vertices, options_.on_warning);
        colours_.add_columns(mesh.vertex_columns, "vertices", options_.on_warning);
        textures_.add_column(mesh.vertex_columns, corners_, vertices, options_.on_warning);
        put_faces(mesh, Column("corners", Buffer(std::move(offsets_)), Buffer(std::move(corners_))), vertices, {},
                  options_.on_warning);
        return loaded_file("OBJ", "ascii", text_.comments().texts(), std::move(positions_), std::move(mesh), options_);
    }

    /// The index of a vertex that a face refers to before the vertex's own row.
    struct Ahead {
        u64 index;
        std::size_t line;
    };

    const ReadOptions& options_;
    TextCursor text_;
    Array<Vec3> positions_;
    Array<u32> corners_;  // the vertex of each corner
    Array<u64> offsets_;  // the first index in corners_ of each face, and the end
    std::vector<Ahead> ahead_;  // with ascending indices
    CornerValues normals_{"normal", "normals (vn)", 3};
    CornerValues textures_{"texture", "texture coordinates (vt)", 2};
    RowColours colours_{RowColours::Bytes::fractions};
    LeftOut left_out_;
    std::size_t weighted_ = 0, deep_textures_ = 0;
    std::size_t overlong_ = 0, first_overlong_ = 0;
};

Recognition recognise(std::string_view head, u64 file_size) {
    // The last line may be incomplete.
    if (head.size() < file_size) head = head.substr(0, head.find_last_of("\r\n") + 1);
    TextCursor text(without_byte_order_mark(head), rules);
    Recognition recognition = Recognition::no;
    while (text.next_row()) {
        const std::string_view keyword = text.token();
        const Subject subject = subject_of(keyword);
        if (subject == Subject::unknown) return Recognition::no;
        double ignored = 0;
        if (recognition == Recognition::no) recognition = Recognition::plausible;
        if (subject == Subject::shape && text.more() &&
            (keyword.starts_with('f') ? parse_corner(text.token()).has_value() : text.number(ignored)))
            recognition = Recognition::certain;
    }
    return recognition;
}

LoadedFile read(const FileBytes& file, const ReadOptions& options) { return ObjReader(file, options).read(); }

/// Warns about lost opacity. It is not written, because many programs do not read a vertex with a fourth channel at
/// all.
void warn_lost_opacity(const Column& colour, const WriteOptions& options) {
    if (colour.components() != 4) return;
    const auto channels = colour.values<u8>();
    std::size_t see_through = 0;
    for (std::size_t row = 0; row < colour.rows(); ++row) see_through += channels[4 * row + 3] != 255;
    if (see_through > 0)
        warn(options.on_warning, "OBJ left out the opacity (the fourth channel of 'colour') of {}; PLY keeps it",
             count_text(see_through, "vertex", "vertices"));
}

void put_list(std::string_view keyword, const Column* column, OutputBuffer& out) {
    for (std::size_t row = 0; column && row < column->rows(); ++row) {
        out.text(keyword);
        put_row_text(*column, row, out);
        out.text("\n");
    }
}

void write(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const TriangleMesh& mesh = *value.get<TriangleMesh>();
    const TextColumns columns(mesh.vertex_columns);
    warn_lost_precision(mesh.frame, mesh.positions.span(), false, "OBJ", options);
    std::vector<std::string_view> kept = columns.names();
    // The channels of colours that are not bytes; the reader keeps them as such columns.
    std::vector<const Column*> channels;
    for (const char* name : {"red", "green", "blue"})
        if (const Column* column = mesh.vertex_columns.find(name); column && has_floats(*column, 1))
            channels.push_back(column);
    if (columns.colour || channels.size() < 3) channels.clear();
    for (const Column* channel : channels) kept.push_back(channel->name());
    warn_bare_triangles(mesh, "OBJ", options, kept);
    if (columns.colour) warn_lost_opacity(*columns.colour, options);

    out.text(comment_lines(mesh.frame));
    const auto fractions = colour_fractions();
    for (std::size_t row = 0; row < mesh.positions.size(); ++row) {
        out.text("v ");
        put_position(mesh.frame, mesh.positions[row], out);
        for (std::size_t channel = 0; channel < 3 && columns.colour; ++channel) {
            out.text(" ");
            out.text(fractions[columns.colour->values<u8>()[row * columns.colour->components() + channel]]);
        }
        for (const Column* channel : channels) put_row_text(*channel, row, out);
        out.text("\n");
    }
    put_list("vt", columns.texture, out);
    put_list("vn", columns.normal, out);
    for (const Triangle& triangle : mesh.triangles) {
        out.text("f");
        for (u32 vertex : triangle) {
            const u64 number = u64(vertex) + 1;
            out.text(" ");
            out.number(number);
            if (columns.texture || columns.normal) out.text("/");
            if (columns.texture) out.number(number);
            if (columns.normal) {
                out.text("/");
                out.number(number);
            }
        }
        out.text("\n");
    }
}

}  // namespace

Format obj_format() { return {"OBJ", {"obj"}, recognise, read, {{kind_of<TriangleMesh>(), write}}}; }

}  // namespace scanmill
