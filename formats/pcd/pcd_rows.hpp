// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The rows of an ascii PCD file. PCL's own reader takes for zeros what it cannot read, so these are read here.

#include <pcl/PCLPointCloud2.h>

#include "pcd/pcd_header.hpp"

namespace scanmill::pcd {

/// Fills `cloud.data` as the fields say. Throws Error with the line: a row with another count of numbers than a point
/// has, a number that its field's type cannot hold, fewer or more rows than the header promises.
/// Pre: the cloud has the fields and the size of `header`, which is checked_header() of the bytes.
void read_rows(std::string_view bytes, const PcdHeader& header, pcl::PCLPointCloud2& cloud);

}  // namespace scanmill::pcd
