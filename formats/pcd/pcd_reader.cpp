// SPDX-License-Identifier: GPL-3.0-or-later
#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>

#include <sstream>

#include "pcd/pcd.hpp"
#include "pcd/pcd_fields.hpp"
#include "pcd/pcd_header.hpp"
#include "pcd/pcd_rows.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/formats/common/reading.hpp"

namespace scanmill::pcd {

namespace {

using Encoding = PcdHeader::Encoding;

/// PCL splits the lines of a broken header in another way than we do, and then its fields reach beyond the points.
void require_fields_inside(const pcl::PCLPointCloud2& cloud, const PcdHeader& header) {
    bool fits = cloud.point_step == header.row_bytes && cloud.data.size() == header.points * header.row_bytes;
    for (const pcl::PCLPointField& field : cloud.fields) {
        const std::optional<ScalarType> type = scalar_type(field.datatype);
        if (!type) throw Error("the field {} has the unknown type {}", quote(field.name), field.datatype);
        fits = fits && field.offset + u64(field.count) * size_of(*type) <= cloud.point_step;
    }
    if (!fits)
        throw Error("its header names fields that do not add up to {} per point",
                    counted(header.row_bytes, "byte", "bytes"))
            .hint("SIZE, TYPE and COUNT must have an entry for every field");
}

pcl::PCLPointCloud2 read_cloud(std::string_view bytes, const PcdHeader& header) {
    pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);  // what PCL has to say goes into our own sentence
    pcl::PCDReader reader;
    pcl::PCLPointCloud2 cloud;
    Eigen::Vector4f origin;
    Eigen::Quaternionf orientation;
    int version = 0, data_type = 0;
    unsigned int body = 0;
    std::istringstream text{std::string(bytes.substr(0, header.body))};
    int trouble = reader.readHeader(text, cloud, origin, orientation, version, data_type, body);
    if (trouble >= 0) require_fields_inside(cloud, header);
    if (trouble >= 0 && header.encoding == Encoding::ascii) {
        read_rows(bytes, header, cloud);
    } else if (trouble >= 0) {
        const auto* from = reinterpret_cast<const unsigned char*>(bytes.data());
        trouble = reader.readBodyBinary(from, cloud, version, header.encoding == Encoding::compressed,
                                        static_cast<unsigned int>(header.body));
    }
    if (trouble < 0)
        throw Error("PCL cannot make {} of {} of {} data", counted(header.points, "point", "points"),
                    counted(bytes.size() - header.body, "byte", "bytes"), name_of(header.encoding))
            .hint("the file is damaged: fetch or export it again");
    return cloud;
}

}  // namespace

LoadedFile read_pcd(const FileBytes& file, const ReadOptions& options) {
    const PcdHeader header = checked_header(file.bytes);
    const pcl::PCLPointCloud2 cloud = read_cloud(file.bytes, header);
    if (header.height > 1 && header.width > 1)
        warn(options.on_warning, "the grid of {} × {} points became a list in file order", header.width, header.height);
    if (header.bytes_behind > 0)
        warn(options.on_warning, "{} behind the last point and left out",
             counted(header.bytes_behind, "byte was", "bytes were"));
    if (header.has_viewpoint)
        warn(options.on_warning, "the sensor's pose (VIEWPOINT {}) was left out; coordinates are as in the file",
             header.viewpoint);
    LoadedFile loaded;
    loaded.format = "PCD";
    loaded.encoding = name_of(header.encoding);
    loaded.comments = header.comments;
    PointCloud points;
    points.frame = declared_frame(loaded.comments, options);
    Array<Vec3> positions = positions_of(cloud);
    move_near_origin(positions, bounding_box(positions), points.frame);
    points.positions = std::move(positions);
    points.columns = with_exponents(columns_of(cloud, options), loaded.comments);
    loaded.value = std::make_shared<const PointCloud>(std::move(points));
    return loaded;
}

}  // namespace scanmill::pcd
