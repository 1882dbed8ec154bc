// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/common/built_in.hpp"
#include "scanmill/formats/common/colours.hpp"
#include "scanmill/formats/common/polygons.hpp"
#include "scanmill/formats/common/writing.hpp"

namespace scanmill {

namespace {

/// The data of each vertex, besides its coordinates, that the keyword declares.
struct Keyword {
    bool texture = false, colour = false, normal = false;
};

/// The prefixes of a keyword such as "STCNOFF"; nullopt for other words.
std::optional<Keyword> keyword_of(std::string_view word) {
    Keyword keyword;
    const auto remove = [&word](std::string_view prefix) {
        const bool found = word.starts_with(prefix);
        if (found) word.remove_prefix(prefix.size());
        return found;
    };
    keyword.texture = remove("ST");
    keyword.colour = remove("C");
    keyword.normal = remove("N");
    if (word == "OFF") return keyword;
    return std::nullopt;
}

bool is_refused_keyword(std::string_view word) {
    return word.size() > 3 && word.size() <= 8 && word.ends_with("OFF") &&
           word.find_first_not_of("STCN4nOF") == std::string_view::npos;
}

/// "OFF8 6 12" → 3: the length of the keyword if a count follows without a blank, as some programs write it; else 0.
std::size_t glued_keyword(std::string_view word) {
    return word.starts_with("OFF") && word.size() > 3 && word[3] >= '0' && word[3] <= '9' ? 3 : 0;
}

class OffReader {
public:
    OffReader(const FileBytes& file, const ReadOptions& options)
        : bytes_(file.bytes),
          options_(options),
          text_(file.bytes, {.comment = '#'}) {}

    LoadedFile read() {
        read_keyword();
        read_counts();
        read_vertices();
        read_faces();
        if (text_.next_row())
            warn(options_.on_warning, "the text from line {} on belongs to no face and was ignored", text_.line());
        return loaded_file("OFF", "ascii", text_.comments().texts(), std::move(positions_), std::move(mesh_), options_);
    }

private:
    void read_keyword() {
        if (!text_.next_row()) throw Error("holds no points: only blanks and comments");
        const std::string_view word = text_.token();
        if (const auto keyword = keyword_of(word)) {
            keyword_ = *keyword;
            TextCursor ahead = text_;
            if (ahead.more() && ahead.token() == "BINARY")
                throw Error("line {}: binary OFF is not read", text_.line()).hint("convert it to text OFF or PLY");
        } else if (is_refused_keyword(word)) {
            throw Error("line {}: {} does not hold points of three dimensions; OFF, COFF, NOFF and STOFF are read",
                        text_.line(), quote(word));
        } else if (const std::size_t length = glued_keyword(word)) {
            text_.put_back(word.substr(length));
        } else {
            text_.put_back(word);  // the keyword is missing: this may be the first count
        }
    }

    void read_counts() {
        if (!text_.more() && !text_.next_row()) throw Error("the text ends before the numbers of vertices and faces");
        for (u64* count : {&vertices_, &faces_}) {
            if (!text_.more())
                throw Error("line {}: expected the numbers of vertices, faces and edges, found less", text_.line());
            if (!text_.number(*count))
                throw Error("line {}: expected the keyword OFF or the numbers of vertices, faces and edges, found {}",
                            text_.line(), quote(text_.last_token()));
        }
        if (vertices_ == 0) throw Error("holds no points: line {} declares 0 vertices", text_.line());
        require_countable(vertices_, "vertices");
        // The shortest row of a vertex is "0 0 0" and a line end, the shortest row of a face "0" and a line end.
        constexpr u64 least_vertex = 6, least_face = 2;
        if (vertices_ > bytes_.size() / least_vertex || faces_ > bytes_.size() / least_face)
            throw Error("line {} promises {} and {}; the file has only {}", text_.line(),
                        count_text(vertices_, "vertex", "vertices"), count_text(faces_, "face", "faces"),
                        count_text(bytes_.size(), "byte", "bytes"))
                .hint(truncated_hint);
    }

    void read_numbers(double* numbers, int size, u64 row, std::string_view what) {
        for (int i = 0; i < size; ++i) numbers[i] = next_number(text_, "the {} of vertex {}", what, row);
    }

    void read_vertices() {
        positions_.resize(vertices_);
        Array<double> normals(keyword_.normal ? 3 * vertices_ : 0);
        Array<double> texture(keyword_.texture ? 2 * vertices_ : 0);
        RowColours colours;
        for (u64 row = 0; row < vertices_; ++row) {
            require_row(text_, row, vertices_, "vertices");
            read_numbers(positions_[row].data(), 3, row, "coordinates");
            if (keyword_.normal) read_numbers(&normals[3 * row], 3, row, "normal");
            // Texture coordinates come last, after a colour of undeclared length.
            colours.read_row(text_, keyword_.texture ? 2 : 0);
            if (keyword_.texture) read_numbers(&texture[2 * row], 2, row, "texture coordinates");
        }
        if (keyword_.normal) mesh_.vertex_columns.add(Column("normal", 3, Buffer(std::move(normals))));
        colours.add_columns(mesh_.vertex_columns, "vertices", options_.on_warning);
        if (keyword_.texture) mesh_.vertex_columns.add(Column("texture", 2, Buffer(std::move(texture))));
    }

    void read_faces() {
        constexpr std::size_t usual_corners = 3;
        Array<u64> offsets;
        Array<u32> corners;
        offsets.reserve(faces_ + 1);
        corners.reserve(usual_corners * faces_);
        offsets.push_back(0);
        RowColours colours;
        for (u64 row = 0; row < faces_; ++row) {
            require_row(text_, row, faces_, "faces");
            const u64 length = next_number<u64>(text_, "the corners of face {}", row);
            for (u64 i = 0; i < length; ++i) {
                u64 vertex = 0;
                if (!text_.more())
                    throw Error("line {}: face {} has {} of its {}", text_.line(), row, i,
                                count_text(length, "corner", "corners"));
                const bool is_number = text_.number(vertex);
                if (!is_number || vertex >= vertices_)
                    throw Error("line {}: face {} names vertex {}; there {} {}, numbered from 0", text_.line(), row,
                                is_number ? std::to_string(vertex) : quote(text_.last_token()),
                                by_count(vertices_, "is", "are"), count_text(vertices_, "vertex", "vertices"));
                corners.push_back(static_cast<u32>(vertex));
            }
            offsets.push_back(corners.size());
            colours.read_row(text_);
        }
        ColumnTable columns;
        colours.add_columns(columns, "faces", options_.on_warning);
        put_faces(mesh_, Column("corners", Buffer(std::move(offsets)), Buffer(std::move(corners))), vertices_, columns,
                  options_.on_warning);
    }

    std::string_view bytes_;
    const ReadOptions& options_;
    TextCursor text_;
    Keyword keyword_;
    u64 vertices_ = 0, faces_ = 0;
    Array<Vec3> positions_;
    TriangleMesh mesh_;
};

Recognition recognise(std::string_view head, u64) {
    TextCursor text(head, {.comment = '#'});
    if (!text.next_row()) return Recognition::no;
    const std::string_view word = text.token();
    if (keyword_of(word) || is_refused_keyword(word) || glued_keyword(word) > 0) return Recognition::certain;
    return Recognition::no;
}

LoadedFile read(const FileBytes& file, const ReadOptions& options) { return OffReader(file, options).read(); }

void write(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const TriangleMesh& mesh = *value.get<TriangleMesh>();
    const TextColumns of_vertices(mesh.vertex_columns);
    const Column* const face_colour = TextColumns(mesh.face_columns).colour;
    warn_lost_precision(mesh.frame, mesh.positions.span(), false, "OFF", options);
    std::vector<std::string_view> of_faces;
    if (face_colour) of_faces.push_back(face_colour->name());
    warn_bare_triangles(mesh, "OFF", options, of_vertices.names(), of_faces);

    out.text(fmt::format("{}{}{}OFF\n{}{} {} 0\n", of_vertices.texture ? "ST" : "", of_vertices.colour ? "C" : "",
                         of_vertices.normal ? "N" : "", comment_lines(mesh.frame), mesh.positions.size(),
                         mesh.triangles.size()));
    for (std::size_t row = 0; row < mesh.positions.size(); ++row) {
        put_position(mesh.frame, mesh.positions[row], out);
        for (const Column* column : {of_vertices.normal, of_vertices.colour, of_vertices.texture})
            if (column) put_row_text(*column, row, out);
        out.text("\n");
    }
    for (std::size_t row = 0; row < mesh.triangles.size(); ++row) {
        out.text("3");
        for (u32 vertex : mesh.triangles[row]) {
            out.text(" ");
            out.number(vertex);
        }
        if (face_colour) put_row_text(*face_colour, row, out);
        out.text("\n");
    }
}

}  // namespace

Format off_format() { return {"OFF", {"off"}, recognise, read, {{kind_of<TriangleMesh>(), write}}}; }

}  // namespace scanmill
