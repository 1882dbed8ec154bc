// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "scanmill/base/error.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/formats/common/colours.hpp"
#include "scanmill/formats/common/polygons.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/obj/detail/obj_corner_values.hpp"
#include "scanmill/formats/obj/detail/obj_left_out.hpp"
#include "scanmill/formats/obj/obj.hpp"

namespace scanmill {

namespace {

constexpr TextRules rules{.comment = '#', .continuation = '\\'};

/// A corner of a face as the file spells it; 0 where it names no texture or normal.
struct Corner {
    std::int64_t vertex = 0, texture = 0, normal = 0;
};

/// "7", "7/5", "7//3", "7/5/3"; also "7/" and "7//", which some programs write. Nothing when it is none of these.
std::optional<Corner> parse_corner(std::string_view token) {
    Corner corner;
    const char* at = token.data();
    const char* const end = at + token.size();
    const auto pass_number = [&](std::int64_t& number) {
        const auto [rest, error] = std::from_chars(at, end, number);
        at = rest;
        return error == std::errc();
    };
    const auto pass_slash = [&] { return at != end && *at == '/' && (++at, true); };
    const auto at_number = [&] { return at != end && *at != '/'; };
    if (!pass_number(corner.vertex)) return std::nullopt;
    if (pass_slash()) {
        if (at_number() && !pass_number(corner.texture)) return std::nullopt;
        if (pass_slash() && at_number() && !pass_number(corner.normal)) return std::nullopt;
    }
    if (at != end) return std::nullopt;
    return corner;
}

class ObjReader {
public:
    ObjReader(const FileBytes& file, const ReadOptions& options)
        : options_(options),
          text_(without_byte_order_mark(file.bytes), rules) {
        // What a mesh usually takes for a vertex and the two faces that come with it.
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
        return assembled();
    }

private:
    double number(std::string_view row, int needed) {
        double value = 0;
        if (!text_.more())
            throw Error("line {}: {} has {}, here are fewer", text_.line(), row,
                        count_text(static_cast<u64>(needed), "number", "numbers"));
        if (!text_.number(value))
            throw Error("line {}: {} is no number for {}", text_.line(), quote(text_.last_token()), row);
        return value;
    }

    void read_vertex() {
        Vec3 position;
        for (int axis = 0; axis < 3; ++axis) position[axis] = number("a vertex (v)", 3);
        positions_.push_back(position);
        if (text_.more() && text_.count_tokens() == 1) weighted_ += number("a vertex (v)", 3) != 1;
        colours_.read_row(text_);
    }

    void read_normal() {
        for (int axis = 0; axis < 3; ++axis) normals_.add_number(number("a normal (vn)", 3));
        pass_rest();
    }

    void read_texture() {
        constexpr std::string_view row = "a texture coordinate (vt)";
        textures_.add_number(number(row, 1));
        textures_.add_number(text_.more() ? number(row, 1) : 0);
        if (text_.more() && number(row, 1) != 0) ++deep_textures_;
        pass_rest();
    }

    /// Notes when a row has more than it may.
    void pass_rest() {
        if (text_.more() && overlong_++ == 0) first_overlong_ = text_.line();
    }

    void read_face() {
        while (text_.more()) {
            const std::string_view token = text_.token();
            const std::optional<Corner> corner = parse_corner(token);
            if (!corner) throw Error("line {}: {} is no corner of a face", text_.line(), quote(token));
            if (corner->texture != 0) textures_.add_reference(corners_.size(), corner->texture);
            if (corner->normal != 0) normals_.add_reference(corners_.size(), corner->normal);
            corners_.push_back(vertex_of(corner->vertex));
        }
        offsets_.push_back(corners_.size());
    }

    u32 vertex_of(std::int64_t spelled) {
        const std::size_t known = positions_.size();
        if (spelled > 0) {
            const auto index = static_cast<u64>(spelled) - 1;
            if (index >= known && (ahead_.empty() || index > ahead_.back().index))
                ahead_.push_back({index, text_.line()});
            return static_cast<u32>(index);  // one that does not fit is missing, and refused at the end
        }
        if (spelled == 0) throw Error("line {}: a face names vertex 0; vertices are numbered from 1", text_.line());
        if (static_cast<u64>(-(spelled + 1)) >= known)
            throw Error("line {}: a face names vertex {}, backwards from here; there are {} before it", text_.line(),
                        spelled, count_text(known, "vertex", "vertices"));
        return static_cast<u32>(known - static_cast<u64>(-(spelled + 1)) - 1);
    }

    void require_vertices() const {
        if (positions_.empty()) throw Error("holds no points: no row is a vertex (v){}", left_out_.first_unknown());
        require_countable(positions_.size(), "vertices");
        // The first missing one is larger than all before it, so it is in the list.
        for (const Ahead& ahead : ahead_)
            if (ahead.index >= positions_.size())
                throw Error("line {}: a face names vertex {}; there {} {}, numbered from 1", ahead.line,
                            ahead.index + 1, by_count(positions_.size(), "is", "are"),
                            count_text(positions_.size(), "vertex", "vertices"))
                    .hint("the file is truncated or wrong: fetch or export it again");
    }

    ColumnTable vertex_columns() {
        ColumnTable columns;
        normals_.add_column(columns, corners_, positions_.size(), options_.on_warning);
        colours_.add_columns(columns, "vertices", options_.on_warning);
        textures_.add_column(columns, corners_, positions_.size(), options_.on_warning);
        return columns;
    }

    void warn_left_out() const {
        left_out_.tell(options_.on_warning);
        if (weighted_ > 0)
            warn(options_.on_warning,
                 "the weights of {} of {} vertices are not 1 and were left out: only free-form "
                 "curves and surfaces have a use for them",
                 weighted_, positions_.size());
        if (deep_textures_ > 0)
            warn(options_.on_warning, "the third number of {} left out",
                 count_text(deep_textures_, "texture coordinate (vt) was", "texture coordinates (vt) was"));
        if (overlong_ > 0)
            warn(options_.on_warning,
                 "{} more numbers than OBJ knows there, first in line {}; the rest was passed over",
                 count_text(overlong_, "row has", "rows have"), first_overlong_);
    }

    LoadedFile assembled() {
        require_vertices();
        LoadedFile loaded;
        loaded.format = "OBJ";
        loaded.encoding = "ascii";
        loaded.comments = text_.comments().texts();
        TriangleMesh mesh;
        mesh.frame = declared_frame(loaded.comments, options_);
        warn_left_out();
        mesh.vertex_columns = vertex_columns();
        const Column faces("corners", Buffer(std::move(offsets_)), Buffer(std::move(corners_)));
        put_faces(mesh, triangulated(faces, positions_.size()), {}, options_.on_warning);
        move_near_origin(positions_, bounding_box(positions_), mesh.frame);
        mesh.positions = std::move(positions_);
        if (mesh.triangles.empty())
            loaded.value = std::make_shared<const PointCloud>(
                PointCloud{mesh.frame, std::move(mesh.positions), std::move(mesh.vertex_columns)});
        else
            loaded.value = std::make_shared<const TriangleMesh>(std::move(mesh));
        return loaded;
    }

    /// A vertex named before it stands in the file.
    struct Ahead {
        u64 index;
        std::size_t line;
    };

    const ReadOptions& options_;
    TextCursor text_;
    Array<Vec3> positions_;
    Array<u32> corners_;   // the vertex of each corner
    Array<u64> offsets_;   // where in corners_ each face begins, and the end
    std::vector<Ahead> ahead_;  // the largest so far, each time there is a larger one
    ObjCornerValues normals_{"normal", "normals (vn)", 3};
    ObjCornerValues textures_{"texture", "texture coordinates (vt)", 2};
    RowColours colours_{RowColours::Bytes::fractions};
    ObjLeftOut left_out_;
    std::size_t weighted_ = 0, deep_textures_ = 0;
    std::size_t overlong_ = 0, first_overlong_ = 0;
};

/// Whether the row, whose keyword was just read, holds what makes an OBJ file.
bool is_shape(std::string_view keyword, TextCursor& text) {
    if (!text.more()) return false;
    if (keyword == "f" || keyword == "fo") return parse_corner(text.token()).has_value();
    double ignored = 0;
    return text.number(ignored);
}

}  // namespace

Recognition recognise_obj(std::string_view head, u64 file_size) {
    // The last line may be cut.
    if (head.size() < file_size) head = head.substr(0, head.find_last_of("\r\n") + 1);
    TextCursor text(without_byte_order_mark(head), rules);
    Recognition recognition = Recognition::no;
    while (text.next_row()) {
        const std::string_view keyword = text.token();
        const ObjSubject subject = obj_subject(keyword);
        if (subject == ObjSubject::unknown) return Recognition::no;
        if (subject == ObjSubject::shape && is_shape(keyword, text))
            recognition = Recognition::certain;
        else if (recognition == Recognition::no)
            recognition = Recognition::plausible;
    }
    return recognition;
}

LoadedFile read_obj(const FileBytes& file, const ReadOptions& options) { return ObjReader(file, options).read(); }

}  // namespace scanmill
