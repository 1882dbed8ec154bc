// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "scanmill/formats/common/built_in.hpp"
#include "scanmill/formats/common/polygons.hpp"
#include "scanmill/formats/ply/detail/ply_elements.hpp"
#include "scanmill/formats/ply/detail/range_grid.hpp"

namespace scanmill {

namespace {

class PlyReader {
public:
    PlyReader(const FileBytes& file, const ReadOptions& options)
        : bytes_(file.bytes),
          options_(options),
          header_(parse_ply_header(bytes_)),
          text_(bytes_.substr(header_.size), {.line = header_.lines + 1}),
          at_(header_.size) {}

    LoadedFile read() {
        refuse_without_points();
        for (const PlyElement& element : header_.elements) {
            require_room(element, header_.encoding, bytes_.size() - at_);
            if (element.name == "vertex")
                read_vertices(element);
            else if (element.name == "face")
                faces_ = read_lists(element);
            else if (element.name == "tristrips")
                strips_ = read_lists(element);
            else if (element.name == "edge" || element.name == "sharp_edge")
                read_edges(element);
            else if (element.name == "range_grid" && element.count > 0)
                read_grid(element);
            else
                skip(element);
        }
        warn_trailing_bytes();
        return finished();
    }

private:
    struct Lists {
        Column vertices;
        ColumnTable columns;
    };
    struct Edges {
        Column first, second;
        ColumnTable columns;
    };

    bool ascii() const { return header_.encoding == PlyEncoding::ascii; }

    void refuse_without_points() const {
        const auto vertex = std::ranges::find(header_.elements, "vertex", &PlyElement::name);
        if (vertex == header_.elements.end()) throw Error("holds no points: the PLY header has no element 'vertex'");
        if (vertex->count == 0) throw Error("holds no points: the PLY header declares 'element vertex 0'");
        require_countable(vertex->count, "vertices");
        for (const std::string_view axis : ply_axes) {
            const PlyProperty* property = vertex->find(axis);
            if (!property) throw Error("the element 'vertex' has no property '{}'; positions need x, y and z", axis);
            if (property->is_list()) throw Error("the property '{}' of the element 'vertex' is a list", axis);
        }
    }

    void decode(const PlyElement& element, std::span<const PlySlot> slots) {
        if (!ascii()) {
            at_ += decode_ply_binary(bytes_.substr(at_), at_, element,
                                     header_.encoding == PlyEncoding::binary_big_endian, slots);
            return;
        }
        const OverlongRows overlong = decode_ply_ascii(text_, element, slots);
        if (overlong.count > 0)
            warn(options_.on_warning,
                 "{} of element {} hold more values than the header has properties, first in line {}; the rest of the "
                 "line was ignored",
                 count_text(overlong.count, "row", "rows"), quote(element.name), overlong.first_line);
    }

    void read_vertices(const PlyElement& element) {
        PlyTable table(element, header_.comments, ply_axes);
        positions_.resize(element.count);
        const auto bounds = widen_packed_positions(bytes_.substr(at_), element, header_.encoding, positions_);
        if (!bounds) place_axes(table.slots(), positions_.data());
        decode(element, table.slots());
        box_ = bounds ? bounds->box : bounding_box(positions_);
        columns_ = table.columns();
    }

    std::optional<Lists> read_lists(const PlyElement& element) {
        PlyTable table(element, header_.comments);
        decode(element, table.slots());
        for (const char* name : {"vertex_indices", "vertex_index"}) {
            const PlyProperty* property = element.find(name);
            if (!property || !property->is_list()) continue;
            Column vertices = *table.take(name);
            return Lists{std::move(vertices), table.columns()};
        }
        if (element.count > 0)
            warn(options_.on_warning, "element '{}' has no list vertex_indices: its {} left out", element.name,
                 count_text(element.count, "row was", "rows were"));
        return std::nullopt;
    }

    void read_edges(const PlyElement& element) {
        PlyTable table(element, header_.comments);
        decode(element, table.slots());
        std::optional<Column> first = table.take("vertex1");
        std::optional<Column> second = table.take("vertex2");
        if (first && second && !first->is_list() && !second->is_list()) {
            (element.name == "edge" ? edges_ : sharp_edges_) =
                Edges{std::move(*first), std::move(*second), table.columns()};
        } else if (element.count > 0) {
            warn(options_.on_warning, "element '{}' has no vertex1 and vertex2: its {} left out", element.name,
                 count_text(element.count, "row was", "rows were"));
        }
    }

    /// The number in the comment "num_cols N", which the scans of the Stanford repository have; 0 without this comment.
    std::size_t grid_columns() const {
        for (const std::string& comment : header_.comments) {
            TextCursor text(comment);
            std::size_t columns = 0;
            if (text.next_row() && text.token() == "num_cols" && text.more() && text.number(columns)) return columns;
        }
        return 0;
    }

    /// Reads the grid of a range image and adds the column `approach`.
    void read_grid(const PlyElement& element) {
        PlyTable table(element, header_.comments);
        decode(element, table.slots());
        const std::optional<Column> cells = table.take("vertex_indices");
        std::optional<Vec3> direction;
        if (cells && cells->is_list() && !columns_.find("approach"))
            direction = direction_to_scanner(*cells, grid_columns(), positions_);
        if (!direction) {
            warn_left_out(element);
            return;
        }
        Array<float> approaches;
        for (std::size_t i = 0; i < positions_.size(); ++i)
            for (const double number : *direction) approaches.push_back(static_cast<float>(number));
        columns_.add(Column("approach", 3, Buffer<float>(std::move(approaches))));
        warn(options_.on_warning,
             "the order of the {} in columns and rows was left out; the column 'approach' has the direction to the "
             "scanner",
             count_text(element.count, "cell", "cells"));
    }

    void skip(const PlyElement& element) {
        std::vector<PlySlot> slots;
        for (const PlyProperty& property : element.properties) slots.push_back({.property = &property});
        decode(element, slots);
        warn_left_out(element);
    }

    void warn_left_out(const PlyElement& element) const {
        if (element.count > 0)
            warn(options_.on_warning,
                 "the element {} with its {} was left out: only vertex, face, tristrips, edge and sharp_edge are read",
                 quote(element.name), count_text(element.count, "row", "rows"));
    }

    void warn_trailing_bytes() {
        if (ascii()) {
            if (text_.next_row())
                warn(options_.on_warning, "the text from line {} on belongs to no element and was ignored",
                     text_.line());
            return;
        }
        const std::string_view rest = bytes_.substr(at_);
        if (rest.find_first_not_of("\r\n") != std::string_view::npos)
            warn(options_.on_warning, "{} after the last element ignored", count_text(rest.size(), "byte", "bytes"));
    }

    void put_triangles(TriangleMesh& mesh) const {
        if (faces_) put_faces(mesh, faces_->vertices, positions_.size(), faces_->columns, options_.on_warning);
        if (!strips_) return;
        Array<Triangle> triangles = triangles_of_strips(strips_->vertices, positions_.size());
        if (!mesh.triangles.empty() && !mesh.face_columns.empty() && !triangles.empty())
            warn(options_.on_warning, "{} left out: the triangle strips have none",
                 count_text(mesh.face_columns.size(), "column of the faces was", "columns of the faces were"));
        if (mesh.triangles.empty() || !triangles.empty()) mesh.face_columns = {};
        triangles.insert(triangles.begin(), mesh.triangles.begin(), mesh.triangles.end());
        require_countable(triangles.size(), "triangles");
        mesh.triangles = std::move(triangles);
    }

    Array<Edge> numbered(const Edges& edges, std::string_view element) const {
        const Array<u32> first = vertex_numbers(edges.first, positions_.size(), element);
        const Array<u32> second = vertex_numbers(edges.second, positions_.size(), element);
        Array<Edge> result(first.size());
        std::ranges::transform(first, second, result.begin(), make_edge);
        return result;
    }

    void put_edges(TriangleMesh& mesh) const {
        if (edges_ && edges_->columns.empty() && edges_->first.rows() > 0)
            warn(options_.on_warning, "{} left out: no column describes them",
                 count_text(edges_->first.rows(), "edge was", "edges were"));
        if (edges_ && !edges_->columns.empty()) {
            mesh.edges = numbered(*edges_, "edge");
            mesh.edge_columns = edges_->columns;
        }
        if (sharp_edges_) {
            Array<Edge> sharp = numbered(*sharp_edges_, "sharp edge");
            std::ranges::sort(sharp);
            sharp.erase(std::unique(sharp.begin(), sharp.end()), sharp.end());
            mesh.sharp_edges = std::move(sharp);
        }
    }

    LoadedFile finished() {
        TriangleMesh mesh;
        mesh.vertex_columns = std::move(columns_);
        put_triangles(mesh);
        put_edges(mesh);
        if (const std::size_t edges = mesh.edges.size() + mesh.sharp_edges.size(); mesh.triangles.empty() && edges > 0)
            warn(options_.on_warning, "{} left out: without a face the file is a point cloud",
                 count_text(edges, "edge was", "edges were"));
        constexpr std::array<const char*, 3> encodings{"ascii", "binary little-endian", "binary big-endian"};
        return loaded_file("PLY", encodings[static_cast<std::size_t>(header_.encoding)], header_.comments,
                           std::move(positions_), std::move(mesh), options_, box_);
    }

    std::string_view bytes_;
    const ReadOptions& options_;
    PlyHeader header_;
    TextCursor text_;  // the body, if it is text
    std::size_t at_;  // the next byte, if it is binary
    Array<Vec3> positions_;
    BoundingBox box_;
    ColumnTable columns_;
    std::optional<Lists> faces_, strips_;
    std::optional<Edges> edges_, sharp_edges_;
};

Recognition recognise(std::string_view head, u64) {
    if (!head.starts_with("ply") || head.size() < 4) return Recognition::no;
    return std::string_view("\n\r \t").find(head[3]) != std::string_view::npos ? Recognition::certain : Recognition::no;
}

LoadedFile read(const FileBytes& file, const ReadOptions& options) { return PlyReader(file, options).read(); }

}  // namespace

Format ply_format() {
    Format ply{"PLY",
               {"ply"},
               recognise,
               read,
               {{kind_of<PointCloud>(), write_ply_points}, {kind_of<TriangleMesh>(), write_ply_mesh}}};
    ply.memory_per_byte = 5;
    ply.may_stream = may_be_ply_stream;
    ply.open_stream = open_ply_stream;
    return ply;
}

}  // namespace scanmill
