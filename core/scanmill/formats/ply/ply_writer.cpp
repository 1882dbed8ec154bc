// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstring>

#include "scanmill/formats/common/writing.hpp"
#include "scanmill/formats/ply/detail/ply_elements.hpp"

namespace scanmill {

namespace {

/// The column in a type that PLY has: 64-bit integers become double.
Column carried(const Column& column, const WriteOptions& options) {
    if (column.type() != ScalarType::int64 && column.type() != ScalarType::uint64) return column;
    Array<double> wide;
    bool exact = true;
    visit_scalar(column.type(), [&](auto zero) {
        using T = decltype(zero);
        const double beyond = std::ldexp(1.0, std::numeric_limits<T>::digits);
        for (const T value : column.values<T>()) {
            const auto number = static_cast<double>(value);
            exact = exact && number < beyond && static_cast<T>(number) == value;
            wide.push_back(number);
        }
    });
    warn(options.on_warning, "the column {} of 64-bit integers is written as double, because PLY has no such type; {}",
         quote(column.name()), exact ? "every number is kept" : "numbers beyond 2^53 were rounded");
    const Buffer<double> numbers(std::move(wide));
    const Column carried = column.is_list() ? Column(column.name(), column.offsets(), numbers)
                                            : Column(column.name(), column.components(), numbers);
    return carried.with_length_exponent(column.length_exponent());
}

struct Header {
    std::string comments, elements;
};

/// The columns of one element as properties. Characters that PLY forbids in names, and names that are taken, are
/// changed with a warning.
class Properties {
public:
    Properties(const ColumnTable& columns, std::vector<std::string> taken, std::string_view element,
               const WriteOptions& options) {
        const auto is_taken = [&](const std::string& name) { return std::ranges::find(taken, name) != taken.end(); };
        for (const Column& column : columns) {
            std::string name = column.name().empty() ? "column" : column.name();
            for (char& c : name)
                if (static_cast<unsigned char>(c) <= ' ' || c == '\x7f') c = '_';
            while (std::ranges::any_of(ply_component_names(column.renamed(name)), is_taken)) name += "_";
            if (name != column.name())
                warn(options.on_warning,
                     "the column {} of the {} is written as '{}': PLY needs distinct names without blanks",
                     quote(column.name()), element, name);
            const Column& added = columns_.emplace_back(carried(column, options).renamed(name));
            std::ranges::move(ply_component_names(added), std::back_inserter(taken));
            u64 longest = 0;
            for (std::size_t row = 0; added.is_list() && row < added.rows(); ++row)
                longest = std::max(longest, added.offsets()[row + 1] - added.offsets()[row]);
            has_short_lists_.push_back(longest <= 255);
        }
    }

    /// Declares an element; `lines` come before its properties. Comments declare which properties form one column, and
    /// which columns are lengths.
    void declare(std::string_view lines, Header& header) const {
        header.elements += lines;
        for (std::size_t i = 0; i < columns_.size(); ++i) {
            const Column& column = columns_[i];
            if (const std::string exponent = exponent_comment(column); !exponent.empty())
                header.comments += fmt::format("comment {}\n", exponent);
            const std::vector<std::string> names = ply_component_names(column);
            if (column.components() > 1 && names.front() == column.name() + "_0")
                header.comments += fmt::format("comment components {} {}\n", column.components(), column.name());
            const std::string_view type = ply_type_names[static_cast<std::size_t>(column.type())];
            const char* const list = !column.is_list() ? "" : has_short_lists_[i] ? "list uchar " : "list uint ";
            for (const std::string& name : names)
                header.elements += fmt::format("property {}{} {}\n", list, type, name);
        }
    }

    void put_row(std::size_t row, OutputBuffer& out) const {
        for (std::size_t i = 0; i < columns_.size(); ++i) {
            const Column& column = columns_[i];
            std::size_t begin = row * column.components(), count = column.components();
            if (column.is_list()) {
                begin = column.offsets()[row];
                count = column.offsets()[row + 1] - begin;
                if (has_short_lists_[i])
                    out.binary(static_cast<u8>(count));
                else
                    out.binary(static_cast<u32>(count));
            }
            if (count == 0) continue;
            const std::size_t width = size_of(column.type());
            char* const destination = out.room(count * width);
            std::memcpy(destination, column.bytes().data() + begin * width, count * width);
            if constexpr (std::endian::native == std::endian::big)
                for (std::size_t j = 0; j < count; ++j)
                    std::reverse(destination + j * width, destination + (j + 1) * width);
        }
    }

private:
    std::vector<Column> columns_;
    std::vector<bool> has_short_lists_;  // indexed by column; true if all lengths fit into a byte
};

void write_ply(const TriangleMesh& mesh, std::string_view vertices, bool has_faces, OutputBuffer& out,
               const WriteOptions& options) {
    // Adding the origin may lose digits.
    if (mesh.frame.origin != Vec3::Zero())
        warn_lost_precision(mesh.frame, mesh.positions.span(), false, "PLY", options);
    const bool as_float = all_floats(mesh.frame, mesh.positions.span());
    const Properties of_vertices(mesh.vertex_columns, {"x", "y", "z"}, vertices, options);
    const Properties of_faces(mesh.face_columns, {"vertex_indices", "vertex_index"}, "faces", options);
    const Properties of_edges(mesh.edge_columns, {"vertex1", "vertex2"}, "edges", options);

    Header header;
    of_vertices.declare(fmt::format("element vertex {1}\nproperty {0} x\nproperty {0} y\nproperty {0} z\n",
                                    as_float ? "float" : "double", mesh.positions.size()),
                        header);
    // Most readers expect int here, not uint, so int is used if the numbers fit.
    const bool fits_int = mesh.positions.size() <= (std::size_t(1) << 31);
    if (has_faces)
        of_faces.declare(fmt::format("element face {}\nproperty list uchar {} vertex_indices\n", mesh.triangles.size(),
                                     fits_int ? "int" : "uint"),
                         header);
    const auto edge_lines = [](std::string_view name, std::size_t count) {
        return fmt::format("element {} {}\nproperty uint vertex1\nproperty uint vertex2\n", name, count);
    };
    if (!mesh.edges.empty()) of_edges.declare(edge_lines("edge", mesh.edges.size()), header);
    if (!mesh.sharp_edges.empty()) header.elements += edge_lines("sharp_edge", mesh.sharp_edges.size());
    out.text("ply\nformat binary_little_endian 1.0\ncomment written by scanmill\n");
    out.text(comment_lines(mesh.frame, "comment ") + header.comments + header.elements + "end_header\n");

    for (std::size_t row = 0; row < mesh.positions.size(); ++row) {
        const Vec3 p = world(mesh.frame, mesh.positions[row]);
        for (const double coordinate : p)
            if (as_float)
                out.binary(static_cast<float>(coordinate));
            else
                out.binary(coordinate);
        of_vertices.put_row(row, out);
    }
    for (std::size_t row = 0; row < mesh.triangles.size(); ++row) {
        out.binary(u8(3));
        for (u32 vertex : mesh.triangles[row]) out.binary(vertex);
        of_faces.put_row(row, out);
    }
    for (std::size_t row = 0; row < mesh.edges.size(); ++row) {
        for (u32 vertex : mesh.edges[row]) out.binary(vertex);
        of_edges.put_row(row, out);
    }
    for (const Edge& edge : mesh.sharp_edges)
        for (u32 vertex : edge) out.binary(vertex);
}

}  // namespace

void write_ply_points(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const PointCloud& cloud = *value.get<PointCloud>();
    TriangleMesh vertices;
    vertices.frame = cloud.frame;
    vertices.positions = cloud.positions;
    vertices.vertex_columns = cloud.columns;
    write_ply(vertices, "points", false, out, options);
}

void write_ply_mesh(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    write_ply(*value.get<TriangleMesh>(), "vertices", true, out, options);
}

}  // namespace scanmill
