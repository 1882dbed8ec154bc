// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstring>

#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/writing.hpp"
#include "scanmill/formats/ply/detail/ply_table.hpp"
#include "scanmill/formats/ply/ply.hpp"
#include "scanmill/io/output_buffer.hpp"

namespace scanmill {

namespace {

std::string_view ply_name(ScalarType type) {
    constexpr std::array<std::string_view, 10> names{"char", "uchar",  "short",  "ushort", "int",
                                                     "uint", "double", "double", "float",  "double"};
    return names[static_cast<std::size_t>(type)];
}

template <class T>
Column as_double(const Column& column, bool& exact) {
    const auto values = column.values<T>();
    Array<double> wide(values.size());
    constexpr double beyond = 2.0 * static_cast<double>(u64(1) << 63);
    for (std::size_t i = 0; i < wide.size(); ++i) {
        wide[i] = static_cast<double>(values[i]);
        exact = exact && wide[i] < beyond && static_cast<T>(wide[i]) == values[i];
    }
    const Buffer<double> numbers(std::move(wide));
    const Column as_double = column.is_list() ? Column(column.name(), column.offsets(), numbers)
                                              : Column(column.name(), column.components(), numbers);
    return as_double.with_length_exponent(column.length_exponent());
}

/// PLY has no 64-bit integers.
Column carried(const Column& column, const WriteOptions& options) {
    if (column.type() != ScalarType::int64 && column.type() != ScalarType::uint64) return column;
    bool exact = true;
    Column wide = column.type() == ScalarType::int64 ? as_double<std::int64_t>(column, exact)
                                                     : as_double<std::uint64_t>(column, exact);
    warn(options.on_warning, "the column {} of 64-bit integers is written as double, which PLY has; {}",
         quote(column.name()), exact ? "every number is kept" : "numbers beyond 2^53 were rounded");
    return wide;
}

/// A column with the names that its properties get: what PLY forbids in a name, and names already taken, are changed.
class Properties {
public:
    Properties(const ColumnTable& columns, std::vector<std::string> taken, std::string_view element,
               const WriteOptions& options)
        : taken_(std::move(taken)) {
        for (const Column& column : columns) {
            std::string name = printable(column.name());
            while (is_taken(ply_component_names(column.renamed(name)))) name += "_";
            if (name != column.name())
                warn(options.on_warning,
                     "the column {} of the {} is written as '{}': PLY needs names without blanks, "
                     "each only once",
                     quote(column.name()), element, name);
            columns_.push_back(carried(column, options).renamed(name));
            for (std::string& property : ply_component_names(columns_.back())) taken_.push_back(std::move(property));
        }
    }

    std::string header() const {
        std::string lines;
        for (const Column& column : columns_) {
            const std::string type(ply_name(column.type()));
            if (column.is_list()) {
                lines += fmt::format("property list {} {} {}\n", has_short_lists(column) ? "uchar" : "uint", type,
                                     column.name());
                continue;
            }
            for (const std::string& name : ply_component_names(column))
                lines += fmt::format("property {} {}\n", type, name);
        }
        return lines;
    }

    /// Comments from which a reader learns which properties were one column, and which are lengths.
    std::string comments() const {
        std::string lines;
        for (const Column& column : columns_) {
            if (const std::string exponent = exponent_comment(column); !exponent.empty())
                lines += fmt::format("comment {}\n", exponent);
            if (column.components() > 1 && ply_component_names(column).front() == column.name() + "_0")
                lines += fmt::format("comment components {} {}\n", column.components(), column.name());
        }
        return lines;
    }

    void put_row(std::size_t row, OutputBuffer& out) const {
        for (const Column& column : columns_) {
            const std::size_t width = size_of(column.type());
            std::size_t begin = row * column.components(), count = column.components();
            if (column.is_list()) {
                begin = column.offsets()[row];
                count = column.offsets()[row + 1] - begin;
                if (has_short_lists(column))
                    out.binary(static_cast<u8>(count));
                else
                    out.binary(static_cast<u32>(count));
            }
            put_numbers(column.bytes().data() + begin * width, count, width, out);
        }
    }

    bool empty() const { return columns_.empty(); }

private:
    static std::string printable(std::string_view name) {
        std::string result(name.empty() ? "column" : name);
        for (char& c : result)
            if (static_cast<unsigned char>(c) <= ' ' || c == '\x7f') c = '_';
        return result;
    }

    bool is_taken(const std::vector<std::string>& names) const {
        return std::ranges::any_of(names,
                                   [&](const auto& name) { return std::ranges::find(taken_, name) != taken_.end(); });
    }

    static void put_numbers(const std::byte* source, std::size_t count, std::size_t width, OutputBuffer& out) {
        if (count == 0) return;
        char* place = out.room(count * width);
        std::memcpy(place, source, count * width);
        if constexpr (std::endian::native == std::endian::big)
            for (std::size_t i = 0; i < count; ++i) std::reverse(place + i * width, place + (i + 1) * width);
    }

    /// Whether every list's length fits into a byte.
    static bool has_short_lists(const Column& column) {
        for (std::size_t row = 0; row < column.rows(); ++row)
            if (column.offsets()[row + 1] - column.offsets()[row] > 255) return false;
        return true;
    }

    std::vector<std::string> taken_;
    std::vector<Column> columns_;
};

struct Header {
    std::string comments, elements;

    std::string text(const Frame& frame) const {
        std::string lines = "ply\nformat binary_little_endian 1.0\ncomment written by scanmill\n";
        if (frame.unit != LengthUnit::unknown) lines += fmt::format("comment unit {}\n", symbol(frame.unit));
        if (const std::string name = one_line(frame.name); !name.empty())
            lines += fmt::format("comment frame {}\n", name);
        return lines + comments + elements + "end_header\n";
    }
};

void declare_vertices(Header& header, std::size_t count, bool as_float, const Properties& properties) {
    const std::string_view type = as_float ? "float" : "double";
    header.elements += fmt::format("element vertex {}\n", count);
    for (char axis : {'x', 'y', 'z'}) header.elements += fmt::format("property {} {}\n", type, axis);
    header.elements += properties.header();
    header.comments += properties.comments();
}

template <class Scalar>
void put_vertices(const Frame& frame, std::span<const Vec3> positions, const Properties& properties,
                  OutputBuffer& out) {
    for (std::size_t row = 0; row < positions.size(); ++row) {
        const Vec3 p = world(frame, positions[row]);
        for (int axis = 0; axis < 3; ++axis) out.binary(static_cast<Scalar>(p[axis]));
        if (!properties.empty()) properties.put_row(row, out);
    }
}

void put_vertices(const Frame& frame, std::span<const Vec3> positions, bool as_float, const Properties& properties,
                  OutputBuffer& out) {
    if (as_float)
        put_vertices<float>(frame, positions, properties, out);
    else
        put_vertices<double>(frame, positions, properties, out);
}

/// Tells what the sum with the origin loses on the way.
bool coordinates_fit_float(const Frame& frame, std::span<const Vec3> positions, const WriteOptions& options) {
    if (frame.origin != Vec3::Zero()) warn_lost_precision(frame, positions, false, "PLY", options);
    return all_floats(frame, positions);
}

void declare_edges(Header& header, std::string_view name, std::size_t count) {
    header.elements += fmt::format("element {} {}\nproperty uint vertex1\nproperty uint vertex2\n", name, count);
}

const std::vector<std::string> axes{"x", "y", "z"};

}  // namespace

void write_ply_points(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const PointCloud& cloud = *value.get<PointCloud>();
    const bool as_float = coordinates_fit_float(cloud.frame, cloud.positions.span(), options);
    const Properties properties(cloud.columns, axes, "points", options);
    Header header;
    declare_vertices(header, cloud.size(), as_float, properties);
    out.text(header.text(cloud.frame));
    put_vertices(cloud.frame, cloud.positions.span(), as_float, properties, out);
}

void write_ply_mesh(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const TriangleMesh& mesh = *value.get<TriangleMesh>();
    const bool as_float = coordinates_fit_float(mesh.frame, mesh.positions.span(), options);
    const Properties of_vertices(mesh.vertex_columns, axes, "vertices", options);
    const Properties of_faces(mesh.face_columns, {"vertex_indices", "vertex_index"}, "faces", options);
    const Properties of_edges(mesh.edge_columns, {"vertex1", "vertex2"}, "edges", options);

    Header header;
    declare_vertices(header, mesh.positions.size(), as_float, of_vertices);
    // Most readers know int here, not uint: it is used while the numbers fit.
    const bool fits_int = mesh.positions.size() <= (std::size_t(1) << 31);
    header.elements += fmt::format("element face {}\nproperty list uchar {} vertex_indices\n{}", mesh.triangles.size(),
                                   fits_int ? "int" : "uint", of_faces.header());
    header.comments += of_faces.comments();
    if (!mesh.edges.empty()) {
        declare_edges(header, "edge", mesh.edges.size());
        header.elements += of_edges.header();
        header.comments += of_edges.comments();
    }
    if (!mesh.sharp_edges.empty()) declare_edges(header, "sharp_edge", mesh.sharp_edges.size());

    out.text(header.text(mesh.frame));
    put_vertices(mesh.frame, mesh.positions.span(), as_float, of_vertices, out);
    for (std::size_t row = 0; row < mesh.triangles.size(); ++row) {
        out.binary(u8(3));
        for (u32 vertex : mesh.triangles[row]) out.binary(vertex);
        if (!of_faces.empty()) of_faces.put_row(row, out);
    }
    const auto put_edge = [&](const Edge& edge) {
        for (u32 vertex : edge) out.binary(vertex);
    };
    for (std::size_t row = 0; row < mesh.edges.size(); ++row) {
        put_edge(mesh.edges[row]);
        if (!of_edges.empty()) of_edges.put_row(row, out);
    }
    for (const Edge& edge : mesh.sharp_edges) put_edge(edge);
}

}  // namespace scanmill
