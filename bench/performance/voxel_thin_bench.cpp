// SPDX-License-Identifier: GPL-3.0-or-later
/// Compares voxel-thin with PCL's UniformSampling and VoxelGrid, in turn, in one process.
///
/// Equal: the points in memory in random order, the voxel size, whole clouds as input and output. UniformSampling keeps
/// the point nearest the voxel's centre, as voxel-thin does. Not equal: VoxelGrid returns centroids, which are not
/// points of the scan. PCL stores floats (16 bytes per point), Scanmill doubles (24 bytes). PCL uses one thread for
/// both. PCL's grids start at multiples of the voxel size, ours at the bounding box, so counts differ slightly.
///
/// usage: voxel_thin_bench [rounds = 5]

#include <fmt/format.h>
#include <pcl/filters/uniform_sampling.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "scanmill/base/random.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace {

using scanmill::Array;
using scanmill::PointCloud;
using scanmill::Random;
using scanmill::Vec3;
using PclCloud = pcl::PointCloud<pcl::PointXYZ>;

struct Contender {
    std::string name;
    /// Returns the number of kept points.
    std::function<std::size_t()> run;
    std::vector<double> seconds = {};
    std::size_t kept = 0;
};

void time_once(Contender& contender) {
    const auto begin = std::chrono::steady_clock::now();
    contender.kept = contender.run();
    contender.seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
}

double median(std::vector<double> values) {
    std::ranges::sort(values);
    return values[values.size() / 2];
}

PointCloud cube(std::size_t count) {
    Random random(1);
    Array<Vec3> positions(count);
    for (Vec3& p : positions)
        for (int axis = 0; axis < 3; ++axis) p[axis] = static_cast<float>(random.uniform());
    PointCloud cloud;
    cloud.positions = std::move(positions);
    return cloud;
}

PointCloud sphere(std::size_t count) {
    Random random(2);
    Array<Vec3> positions(count);
    for (Vec3& p : positions) {
        const double z = random.uniform(-1, 1), angle = random.uniform(0, 2 * std::numbers::pi);
        const double ring = std::sqrt(1 - z * z);
        p = Vec3(ring * std::cos(angle), ring * std::sin(angle), z).cast<float>().cast<double>();
    }
    PointCloud cloud;
    cloud.positions = std::move(positions);
    return cloud;
}

/// The voxel size that keeps about a tenth of the points: one voxel per ten points in a cube; on a surface, about 3/2
/// voxels per face area of a voxel.
double bin_size_for_tenth(bool surface, double count) {
    return surface ? std::sqrt(1.5 * 4 * std::numbers::pi / (count / 10)) : std::cbrt(1 / (count / 10));
}

void compare(const std::string& title, const PointCloud& cloud, double bin_size, int rounds) {
    const auto pcl_cloud = pcl::make_shared<PclCloud>();
    for (const Vec3& p : cloud.positions)
        pcl_cloud->push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())});

    const auto ours = [&](unsigned threads) {
        scanmill::VoxelThinParams params;
        params.bin_size = bin_size;
        scanmill::ContextOptions options;
        options.threads = threads;
        scanmill::Context context(options);
        return scanmill::voxel_thin(cloud, params, context).points.size();
    };
    std::vector<Contender> contenders;
    contenders.push_back({"voxel-thin, 1 thread", [&] { return ours(1); }});
    contenders.push_back({"voxel-thin, 2 threads", [&] { return ours(2); }});
    contenders.push_back({"pcl::UniformSampling", [&] {
                              pcl::UniformSampling<pcl::PointXYZ> filter;
                              filter.setInputCloud(pcl_cloud);
                              filter.setRadiusSearch(bin_size);
                              PclCloud left;
                              filter.filter(left);
                              return left.size();
                          }});
    contenders.push_back({"pcl::VoxelGrid", [&] {
                              pcl::VoxelGrid<pcl::PointXYZ> filter;
                              filter.setInputCloud(pcl_cloud);
                              const auto size = static_cast<float>(bin_size);
                              filter.setLeafSize(size, size, size);
                              PclCloud left;
                              filter.filter(left);
                              return left.size();
                          }});
    for (int round = 0; round < rounds; ++round)
        for (Contender& contender : contenders) time_once(contender);

    fmt::print("\n{}: {} points, voxel size {:.5g}\n", title, cloud.size(), bin_size);
    const double uniform = median(contenders[2].seconds), grid = median(contenders[3].seconds);
    for (const Contender& contender : contenders) {
        const auto [least, most] = std::ranges::minmax(contender.seconds);
        const double seconds = median(contender.seconds);
        fmt::print(
            "  {:<22} {:7.3f} s  ({:.3f} to {:.3f})  {:8} kept  {:5.3f} of UniformSampling  {:5.2f} of VoxelGrid\n",
            contender.name, seconds, least, most, contender.kept, seconds / uniform, seconds / grid);
    }
}

}  // namespace

int main(int argc, char** argv) {
    const int rounds = argc > 1 ? std::max(1, std::stoi(argv[1])) : 5;
    for (const std::size_t count : {std::size_t(3'500'000), std::size_t(10'000'000)}) {
        compare("random in a cube", cube(count), bin_size_for_tenth(false, static_cast<double>(count)), rounds);
        compare("random on a sphere", sphere(count), bin_size_for_tenth(true, static_cast<double>(count)), rounds);
    }
}
