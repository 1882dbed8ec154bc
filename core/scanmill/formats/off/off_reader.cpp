// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/colours.hpp"
#include "scanmill/formats/common/polygons.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/text_cursor.hpp"
#include "scanmill/formats/off/off.hpp"

namespace scanmill {

namespace {

/// What the keyword promises for each vertex beside its coordinates.
struct Keyword {
    bool texture = false, colour = false, normal = false;
};

/// "STCNOFF" → its prefixes; nothing when the word is no OFF keyword. Some writers glue the counts to it: "OFF8".
std::optional<Keyword> keyword_of(std::string_view word) {
    Keyword keyword;
    const auto pass = [&word](std::string_view prefix) {
        const bool found = word.starts_with(prefix);
        if (found) word.remove_prefix(prefix.size());
        return found;
    };
    keyword.texture = pass("ST");
    keyword.colour = pass("C");
    keyword.normal = pass("N");
    if (word == "OFF") return keyword;
    return std::nullopt;
}

bool is_refused_keyword(std::string_view word) {
    return word.size() > 3 && word.size() <= 8 && word.ends_with("OFF") &&
           word.find_first_not_of("STCN4nOF") == std::string_view::npos;
}

/// "OFF8 6 12" → 3: the keyword's length when a count is glued to it.
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
            warn(options_.on_warning, "the text from line {} on belongs to no face and was passed over", text_.line());
        return assembled();
    }

private:
    void read_keyword() {
        if (!text_.next_row()) throw Error("holds no points: nothing but blanks and comments");
        const std::string_view word = text_.token();
        if (const auto keyword = keyword_of(word)) {
            keyword_ = *keyword;
            TextCursor ahead = text_;
            if (ahead.more() && ahead.token() == "BINARY")
                throw Error("line {}: binary OFF is not read", text_.line()).hint("convert it to text OFF or PLY");
        } else if (is_refused_keyword(word)) {
            throw Error("line {}: {} holds points of other than three dimensions; OFF, COFF, NOFF and STOFF are read",
                        text_.line(), quote(word));
        } else if (const std::size_t length = glued_keyword(word)) {
            text_.put_back(word.substr(length));
        } else {
            text_.put_back(word);  // the keyword may be missing: then these are the counts
        }
    }

    void read_counts() {
        if (!text_.more() && !text_.next_row()) throw Error("the text ends before the numbers of vertices and faces");
        std::array<u64, 2> counts{};
        for (u64& count : counts) {
            if (!text_.more())
                throw Error("line {}: expected the numbers of vertices, faces and edges, found less", text_.line());
            if (!text_.number(count))
                throw Error("line {}: expected the keyword OFF or the numbers of vertices, faces and edges, found {}",
                            text_.line(), quote(text_.last_token()));
        }
        std::tie(vertices_, faces_) = std::pair(counts[0], counts[1]);
        if (vertices_ == 0) throw Error("holds no points: line {} says 0 vertices", text_.line());
        require_countable(vertices_, "vertices");
        // A vertex takes at least "0 0 0" and a line end, a face "3 0 0 0"; a face of one corner is "1 0".
        constexpr u64 least_vertex = 6, least_face = 2;
        if (vertices_ > bytes_.size() / least_vertex || faces_ > bytes_.size() / least_face)
            throw Error("line {} promises {} and {}; the file has only {}", text_.line(),
                        count_text(vertices_, "vertex", "vertices"), count_text(faces_, "face", "faces"),
                        count_text(bytes_.size(), "byte", "bytes"))
                .hint("the file is truncated or its header is wrong: fetch or export it again");
    }

    void next_row(u64 row, u64 rows, std::string_view element) {
        if (!text_.next_row())
            throw Error("line {}: the text ends after {} of {} {}", text_.line(), row, rows, element)
                .hint("the file is truncated or its header is wrong: fetch or export it again");
    }

    double number(u64 row, std::string_view what) {
        double value = 0;
        if (!text_.more()) throw Error("line {}: vertex {} ends before its {}", text_.line(), row, what);
        if (!text_.number(value))
            throw Error("line {}: {} is no number for the {} of vertex {}", text_.line(), quote(text_.last_token()),
                        what, row);
        return value;
    }

    void read_vertices() {
        positions_.resize(vertices_);
        Array<double> normals(keyword_.normal ? 3 * vertices_ : 0);
        Array<double> texture(keyword_.texture ? 2 * vertices_ : 0);
        RowColours colours;
        for (u64 row = 0; row < vertices_; ++row) {
            next_row(row, vertices_, "vertices");
            for (int axis = 0; axis < 3; ++axis) positions_[row][axis] = number(row, "coordinates");
            for (std::size_t axis = 0; axis < 3 && keyword_.normal; ++axis)
                normals[3 * row + axis] = number(row, "normal");
            // Texture coordinates come last, behind a colour of unsaid length.
            colours.read_row(text_, keyword_.texture ? 2 : 0);
            for (std::size_t i = 0; i < 2 && keyword_.texture; ++i)
                texture[2 * row + i] = number(row, "texture coordinates");
        }
        if (keyword_.normal) vertex_columns_.add(Column("normal", 3, Buffer(std::move(normals))));
        colours.add_columns(vertex_columns_, "vertices", options_.on_warning);
        if (keyword_.texture) vertex_columns_.add(Column("texture", 2, Buffer(std::move(texture))));
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
            next_row(row, faces_, "faces");
            u64 length = 0;
            if (!text_.number(length))
                throw Error("line {}: {} is no number of corners for face {}", text_.line(), quote(text_.last_token()),
                            row);
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
        colours.add_columns(face_columns_, "faces", options_.on_warning);
        fans_ = triangulated(Column("corners", Buffer(std::move(offsets)), Buffer(std::move(corners))), vertices_);
    }

    LoadedFile assembled() {
        LoadedFile loaded;
        loaded.format = "OFF";
        loaded.encoding = "ascii";
        loaded.comments = text_.comments().texts();
        TriangleMesh mesh;
        mesh.frame = declared_frame(loaded.comments, options_);
        move_near_origin(positions_, bounding_box(positions_), mesh.frame);
        put_faces(mesh, std::move(fans_), face_columns_, options_.on_warning);
        if (mesh.triangles.empty()) {
            loaded.value = std::make_shared<const PointCloud>(
                PointCloud{mesh.frame, std::move(positions_), std::move(vertex_columns_)});
        } else {
            mesh.positions = std::move(positions_);
            mesh.vertex_columns = std::move(vertex_columns_);
            loaded.value = std::make_shared<const TriangleMesh>(std::move(mesh));
        }
        return loaded;
    }

    std::string_view bytes_;
    const ReadOptions& options_;
    TextCursor text_;
    Keyword keyword_;
    u64 vertices_ = 0, faces_ = 0;
    Array<Vec3> positions_;
    ColumnTable vertex_columns_, face_columns_;
    Fans fans_;
};

}  // namespace

Recognition recognise_off(std::string_view head, u64) {
    TextCursor text(head, {.comment = '#'});
    if (!text.next_row()) return Recognition::no;
    const std::string_view word = text.token();
    if (keyword_of(word) || is_refused_keyword(word) || glued_keyword(word) > 0) return Recognition::certain;
    return Recognition::no;
}

LoadedFile read_off(const FileBytes& file, const ReadOptions& options) { return OffReader(file, options).read(); }

}  // namespace scanmill
