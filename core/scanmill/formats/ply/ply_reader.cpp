// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>
#include <cstring>

#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/polygons.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/ply/detail/ply_positions.hpp"
#include "scanmill/formats/ply/detail/ply_table.hpp"
#include "scanmill/formats/ply/ply.hpp"

namespace scanmill {

namespace {

struct PackedPositions {
    ScalarType type;
    std::size_t offset = 0;    ///< of x in a row
    std::size_t row_size = 0;
};

std::optional<PackedPositions> packed_positions(const PlyElement& vertex, PlyEncoding encoding) {
    const bool native = encoding == (std::endian::native == std::endian::little ? PlyEncoding::binary_little_endian
                                                                                : PlyEncoding::binary_big_endian);
    if (!native || vertex.has_lists()) return {};
    PackedPositions packed{vertex.find("x")->type};
    if (packed.type != ScalarType::float32 && packed.type != ScalarType::float64) return {};
    constexpr std::array<std::string_view, 3> axes{"x", "y", "z"};
    std::size_t seen = 0;
    for (const PlyProperty& property : vertex.properties) {
        if (seen < 3 && property.name == axes[seen] && property.type == packed.type) {
            if (seen++ == 0) packed.offset = packed.row_size;
        } else if (seen == 1 || seen == 2) {
            return {};
        }
        packed.row_size += size_of(property.type);
    }
    if (seen != 3) return {};
    return packed;
}

/// `source` is the first row's x, rows are `stride` bytes apart. One pass: bounds and doubles together.
template <class Scalar>
FiniteBounds widen_positions(const char* source, std::size_t stride, Array<Vec3>& positions) {
    FiniteBounds all;
    constexpr std::size_t block = 1024;
    for (std::size_t first = 0; first < positions.size(); first += block) {
        const std::size_t rows = std::min(block, positions.size() - first);
        Scalar low[3], high[3], poison[3] = {0, 0, 0};
        std::memcpy(low, source, sizeof low);
        std::memcpy(high, source, sizeof high);
        for (std::size_t row = 0; row < rows; ++row, source += stride) {
            Scalar p[3];
            std::memcpy(p, source, sizeof p);
            for (int axis = 0; axis < 3; ++axis) {
                low[axis] = p[axis] < low[axis] ? p[axis] : low[axis];
                high[axis] = p[axis] > high[axis] ? p[axis] : high[axis];
                poison[axis] += p[axis] * 0;  // 0, unless the coordinate is NaN or infinite: then NaN, and so it stays
                positions[first + row][axis] = static_cast<double>(p[axis]);
            }
        }
        FiniteBounds bounds{{Vec3(low[0], low[1], low[2]), Vec3(high[0], high[1], high[2])},
                            poison[0] + poison[1] + poison[2] == 0};
        if (!bounds.finite) bounds.box = bounding_box({positions.data() + first, rows});
        all.add(bounds);
    }
    return all;
}

}  // namespace

std::optional<FiniteBounds> widen_packed_positions(std::string_view body, const PlyElement& vertex,
                                                   PlyEncoding encoding, Array<Vec3>& positions) {
    const auto packed = packed_positions(vertex, encoding);
    if (!packed) return std::nullopt;
    const char* source = body.data() + packed->offset;
    return packed->type == ScalarType::float32 ? widen_positions<float>(source, packed->row_size, positions)
                                               : widen_positions<double>(source, packed->row_size, positions);
}

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
            else
                pass_over(element);
        }
        warn_trailing_bytes();
        return assembled();
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
        if (vertex->count == 0) throw Error("holds no points: the PLY header says 'element vertex 0'");
        require_countable(vertex->count, "vertices");
        for (const char* axis : {"x", "y", "z"}) {
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
                 "{} of element {} hold more values than the header has properties, first in line "
                 "{}; the rest of the line was passed over",
                 count_text(overlong.count, "row", "rows"), quote(element.name), overlong.first_line);
    }

    void read_vertices(const PlyElement& element) {
        constexpr std::array<std::string_view, 3> axes{"x", "y", "z"};
        PlyTable table(element, header_.comments, axes);
        positions_.resize(element.count);
        if (const auto bounds = widen_packed_positions(bytes_.substr(at_), element, header_.encoding, positions_)) {
            box_ = bounds->box;
            decode(element, table.slots());
        } else {
            for (PlySlot& slot : table.slots()) {
                const auto axis = std::ranges::find(axes, slot.property->name);
                if (axis == axes.end()) continue;
                slot.widened = true;
                slot.stride = sizeof(Vec3);
                slot.place = reinterpret_cast<std::byte*>(positions_.data()) + (axis - axes.begin()) * sizeof(double);
            }
            decode(element, table.slots());
            box_ = bounding_box(positions_);
        }
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

    void pass_over(const PlyElement& element) {
        std::vector<PlySlot> slots;
        for (const PlyProperty& property : element.properties) slots.push_back({.property = &property});
        decode(element, slots);
        if (element.count > 0)
            warn(options_.on_warning,
                 "the element {} with its {} was left out: only vertex, face, tristrips, edge "
                 "and sharp_edge have a meaning here",
                 quote(element.name), count_text(element.count, "row", "rows"));
    }

    void warn_trailing_bytes() {
        if (ascii()) {
            if (text_.next_row())
                warn(options_.on_warning, "the text from line {} on belongs to no element and was passed over",
                     text_.line());
            return;
        }
        const std::string_view rest = bytes_.substr(at_);
        if (rest.find_first_not_of("\r\n") != std::string_view::npos)
            warn(options_.on_warning, "{} after the last element passed over at the file's end",
                 count_text(rest.size(), "byte", "bytes"));
    }

    Array<Edge> numbered(const Edges& edges, std::string_view element) const {
        const Array<u32> first = vertex_numbers(edges.first, positions_.size(), element);
        const Array<u32> second = vertex_numbers(edges.second, positions_.size(), element);
        Array<Edge> result(first.size());
        for (std::size_t i = 0; i < result.size(); ++i) result[i] = make_edge(first[i], second[i]);
        return result;
    }

    void put_triangles(TriangleMesh& mesh) const {
        if (faces_)
            put_faces(mesh, triangulated(faces_->vertices, positions_.size()), faces_->columns, options_.on_warning);
        if (!strips_) return;
        Array<Triangle> triangles = triangles_of_strips(strips_->vertices, positions_.size());
        if (mesh.triangles.empty()) {
            mesh.face_columns = {};
        } else {
            if (!mesh.face_columns.empty() && !triangles.empty()) {
                warn(options_.on_warning, "{} left out: the triangle strips have none",
                     count_text(mesh.face_columns.size(), "column of the faces was", "columns of the faces were"));
                mesh.face_columns = {};
            }
            triangles.insert(triangles.begin(), mesh.triangles.begin(), mesh.triangles.end());
            require_countable(triangles.size(), "triangles");
        }
        mesh.triangles = std::move(triangles);
    }

    void put_edges(TriangleMesh& mesh) const {
        if (edges_ && edges_->columns.empty() && edges_->first.rows() > 0)
            warn(options_.on_warning, "{} left out: no column says anything about them",
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

    LoadedFile assembled() {
        TriangleMesh mesh;
        mesh.frame = declared_frame(header_.comments, options_);
        put_triangles(mesh);
        put_edges(mesh);
        move_near_origin(positions_, box_, mesh.frame);

        LoadedFile loaded;
        loaded.format = "PLY";
        loaded.encoding = ascii()                                                 ? "ascii"
                          : header_.encoding == PlyEncoding::binary_little_endian ? "binary little-endian"
                                                                                  : "binary big-endian";
        loaded.comments = header_.comments;
        if (mesh.triangles.empty()) {
            if (const std::size_t edges = mesh.edges.size() + mesh.sharp_edges.size(); edges > 0)
                warn(options_.on_warning, "{} left out: without a face the file is a point cloud",
                     count_text(edges, "edge was", "edges were"));
            loaded.value =
                std::make_shared<const PointCloud>(PointCloud{mesh.frame, std::move(positions_), std::move(columns_)});
        } else {
            mesh.positions = std::move(positions_);
            mesh.vertex_columns = std::move(columns_);
            loaded.value = std::make_shared<const TriangleMesh>(std::move(mesh));
        }
        return loaded;
    }

    std::string_view bytes_;
    const ReadOptions& options_;
    PlyHeader header_;
    TextCursor text_;  // of the body, when it is text
    std::size_t at_;  // the next byte, when it is binary
    Array<Vec3> positions_;
    BoundingBox box_;
    ColumnTable columns_;
    std::optional<Lists> faces_, strips_;
    std::optional<Edges> edges_, sharp_edges_;
};

}  // namespace

Recognition recognise_ply(std::string_view head, u64) {
    if (!head.starts_with("ply") || head.size() < 4) return Recognition::no;
    return std::string_view("\n\r \t").find(head[3]) != std::string_view::npos ? Recognition::certain : Recognition::no;
}

LoadedFile read_ply(const FileBytes& file, const ReadOptions& options) { return PlyReader(file, options).read(); }

}  // namespace scanmill
