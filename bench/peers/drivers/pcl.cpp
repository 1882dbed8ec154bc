// SPDX-License-Identifier: GPL-3.0-or-later
/// PCL's grids, as its tutorials call them: points of 16 bytes, float, one thread.

#include <pcl/filters/uniform_sampling.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/pcl_config.h>
#include <pcl/point_types.h>

#include "answer.hpp"

namespace {

using peers::Json;
using Cloud = pcl::PointCloud<pcl::PointXYZ>;

Json load(Cloud& cloud, const Json& request) {
    const peers::RawInput raw = peers::read_raw(request.at("path"));
    cloud.clear();
    for (const auto& [x, y, z] : raw.points)
        cloud.emplace_back(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
    return raw.counts();
}

/// Keeps the point nearest each bin's centre.
Json sample_uniformly(const Cloud::Ptr& cloud, const Json& request) {
    Cloud left;
    const double seconds = peers::seconds_of([&] {
        pcl::UniformSampling<pcl::PointXYZ> filter;
        filter.setInputCloud(cloud);
        filter.setRadiusSearch(request.at("bin_size").get<double>());
        filter.filter(left);
    });
    return {{"seconds", seconds}, {"kept", left.size()}};
}

/// Makes each bin's centroid.
Json average(const Cloud::Ptr& cloud, const Json& request) {
    const auto size = request.at("bin_size").get<float>();
    Cloud left;
    const double seconds = peers::seconds_of([&] {
        pcl::VoxelGrid<pcl::PointXYZ> filter;
        filter.setInputCloud(cloud);
        filter.setLeafSize(size, size, size);
        filter.filter(left);
    });
    return {{"seconds", seconds}, {"kept", left.size()}};
}

}  // namespace

int main() {
    const auto cloud = pcl::make_shared<Cloud>();
    return peers::answer({{"load", [&](const Json& request) { return load(*cloud, request); }},
                          {"uniform-sampling", [&](const Json& request) { return sample_uniformly(cloud, request); }},
                          {"voxel-grid", [&](const Json& request) { return average(cloud, request); }}},
                         {{"PCL", PCL_VERSION_PRETTY}});
}
