// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Between PCL's rows of bytes and our columns.

#include <pcl/PCLPointCloud2.h>

#include "scanmill/data/points.hpp"
#include "scanmill/formats/files.hpp"

namespace scanmill::pcd {

/// Nothing for a datatype that PCL does not know.
std::optional<ScalarType> scalar_type(std::uint8_t datatype);
std::uint8_t datatype(ScalarType type);

/// The field of that name, or nullptr.
const pcl::PCLPointField* field_named(const pcl::PCLPointCloud2& cloud, std::string_view name);

/// x, y and z of every row. Throws Error when one of the fields is missing or no number.
Array<Vec3> positions_of(const pcl::PCLPointCloud2& cloud);

/// Everything else, by the names that pcd.hpp gives.
/// A field whose name another column has taken (beside packed colours and normals) gets one of its own, which is told.
ColumnTable columns_of(const pcl::PCLPointCloud2& cloud, const ReadOptions& options);

}  // namespace scanmill::pcd
