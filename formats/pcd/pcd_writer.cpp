// SPDX-License-Identifier: GPL-3.0-or-later
#include <pcl/PCLPointCloud2.h>
#include <pcl/io/pcd_io.h>

#include "pcd/pcd.hpp"
#include "pcd/pcd_header.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/writing.hpp"
#include "scanmill/io/output_buffer.hpp"

namespace scanmill::pcd {

namespace {

void add_field(pcl::PCLPointCloud2& cloud, std::string name, ScalarType type, std::size_t count) {
    pcl::PCLPointField field;
    field.name = std::move(name);
    field.offset = cloud.point_step;
    field.datatype = datatype(type);
    field.count = static_cast<pcl::uindex_t>(count);
    cloud.point_step += static_cast<pcl::uindex_t>(size_of(type) * count);
    cloud.fields.push_back(std::move(field));
}

bool is_normal(const Column& column) { return column.name() == "normal" && column.components() == 3; }

bool is_colour(const Column& column) {
    return column.name() == "colour" && column.type() == ScalarType::uint8 && column.components() >= 3 &&
           column.components() <= 4;
}

/// Replaces blanks in a name, because blanks separate fields.
std::string field_name(std::string name) {
    for (char& c : name)
        if (static_cast<unsigned char>(c) <= ' ' || c == '\x7f') c = '_';
    return name;
}

struct WrittenColumn {
    const Column* column;
    std::string field;  ///< name of the field; empty for normals and colours
};

/// Gives every column a unique field name. Warns about changed names.
std::vector<WrittenColumn> written_columns(const PointCloud& cloud, const WriteOptions& options) {
    WrittenNames names("PCD", options, {"x", "y", "z", "_", "normal_x", "normal_y", "normal_z", "rgb", "rgba"});
    std::vector<WrittenColumn> columns;
    for (const Column& column : cloud.columns) {
        if (column.is_list()) {
            warn(options.on_warning, "PCD left out the lists of the column '{}'; PLY keeps them", column.name());
            continue;
        }
        const bool has_meaning = is_normal(column) || is_colour(column);
        columns.push_back({&column, has_meaning ? "" : names.add(column.name(), field_name(column.name()))});
    }
    return columns;
}

pcl::PCLPointCloud2 described(const PointCloud& cloud, const std::vector<WrittenColumn>& columns, bool as_float) {
    pcl::PCLPointCloud2 layout;
    layout.width = static_cast<pcl::uindex_t>(cloud.size());
    layout.height = 1;
    for (const char* axis : {"x", "y", "z"})
        add_field(layout, axis, as_float ? ScalarType::float32 : ScalarType::float64, 1);
    for (const auto& [column, name] : columns) {
        if (is_normal(*column))
            for (const char* axis : {"normal_x", "normal_y", "normal_z"}) add_field(layout, axis, column->type(), 1);
        else if (is_colour(*column))
            add_field(layout, column->components() == 4 ? "rgba" : "rgb", ScalarType::uint32, 1);
        else
            add_field(layout, name, column->type(), column->components());
    }
    return layout;
}

void put_row(const Column& column, std::size_t row, OutputBuffer& out) {
    if (is_colour(column)) {
        const u8* rgba = column.values<u8>().data() + row * column.components();
        const u32 alpha = column.components() == 4 ? rgba[3] : 255;
        out.binary(alpha << 24 | u32(rgba[0]) << 16 | u32(rgba[1]) << 8 | u32(rgba[2]));
        return;
    }
    const std::size_t size = size_of(column.type()) * column.components();
    std::memcpy(out.room(size), column.bytes().data() + row * size, size);
}

}  // namespace

void write_pcd(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const PointCloud& cloud = *value.get<PointCloud>();
    const bool as_float = all_floats(cloud.frame, cloud.positions.span());
    warn_lost_precision(cloud.frame, cloud.positions.span(), as_float, "PCD", options);
    const std::vector<WrittenColumn> columns = written_columns(cloud, options);
    const pcl::PCLPointCloud2 layout = described(cloud, columns, as_float);
    std::string header =
        pcl::PCDWriter().generateHeaderBinary(layout, Eigen::Vector4f::Zero(), Eigen::Quaternionf::Identity());
    std::string comments = comment_lines(cloud.frame);
    for (const WrittenColumn& written : columns)
        if (const std::string exponent = exponent_comment(*written.column); !exponent.empty())
            comments += "# " + exponent + "\n";
    header.insert(header.find('\n') + 1, comments);
    out.text(header);
    out.text("DATA binary\n");
    for (std::size_t row = 0; row < cloud.size(); ++row) {
        const Vec3 p = world(cloud.frame, cloud.positions[row]);
        for (int axis = 0; axis < 3; ++axis) {
            if (as_float)
                out.binary(static_cast<float>(p[axis]));
            else
                out.binary(p[axis]);
        }
        for (const WrittenColumn& written : columns) put_row(*written.column, row, out);
    }
}

}  // namespace scanmill::pcd
