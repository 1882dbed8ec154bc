// SPDX-License-Identifier: GPL-3.0-or-later
/// PCL's grids, outlier removal, normals, greedy triangulation and Poisson reconstruction, as in its tutorials: points
/// of 16 bytes in single precision. All but the normals run in one thread.

#include <pcl/features/normal_3d.h>
#include <pcl/features/normal_3d_omp.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/filters/uniform_sampling.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/pcl_config.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/gp3.h>
#include <pcl/surface/poisson.h>

#include <algorithm>

#include "answer.hpp"

namespace {

using peers::Json;
using Cloud = pcl::PointCloud<pcl::PointXYZ>;

using Normals = pcl::PointCloud<pcl::Normal>;

/// `normals` stays empty if the input has none.
Json load(Cloud& cloud, Normals& normals, const Json& request) {
    const peers::RawInput raw = peers::read_raw(request.at("path"));
    cloud.clear(), normals.clear();
    for (const auto& [x, y, z] : raw.normals)
        normals.push_back(pcl::Normal(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)));
    for (const auto& [x, y, z] : raw.points)
        cloud.emplace_back(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
    return raw.counts();
}

/// Keeps the point nearest the centre of each voxel.
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

/// Computes the centroid of each voxel.
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

/// Removes the points whose mean distance to their nearest points is above the mean plus some standard deviations.
Json remove_outliers(const Cloud::Ptr& cloud, const Json& request) {
    Cloud left;
    const double seconds = peers::seconds_of([&] {
        pcl::StatisticalOutlierRemoval<pcl::PointXYZ> filter;
        filter.setInputCloud(cloud);
        filter.setMeanK(request.at("neighbours").get<int>());
        filter.setStddevMulThresh(request.at("factor").get<double>());
        filter.filter(left);
    });
    return {{"seconds", seconds}, {"kept", left.size()}};
}

/// Estimates the normal of every point from its nearest points, itself included. Programs are compared by the
/// share of normals with x as their largest component.
Json estimate_normals(const Cloud::Ptr& cloud, const Json& request) {
    Normals normals;
    const double seconds = peers::seconds_of([&] {
        pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimation(peers::threads_of(request));
        estimation.setInputCloud(cloud);
        estimation.setKSearch(request.at("neighbours").get<int>() + 1);
        estimation.compute(normals);
    });
    peers::Vectors vectors;
    for (const pcl::Normal& n : normals) vectors.push_back({n.normal_x, n.normal_y, n.normal_z});
    Json answer = peers::directions(request, {}, vectors);  // PCL does not orient
    answer["seconds"] = seconds;
    return answer;
}

Json poisson(const Cloud& cloud, const Normals& normals, const Json& request) {
    const auto both = pcl::make_shared<pcl::PointCloud<pcl::PointNormal>>();
    pcl::concatenateFields(cloud, normals, *both);
    pcl::PointCloud<pcl::PointNormal> vertices;
    std::vector<pcl::Vertices> polygons;
    const double seconds = peers::seconds_of([&] {
        pcl::Poisson<pcl::PointNormal> reconstruction;
        reconstruction.setDepth(request.at("depth").get<int>());
        reconstruction.setScale(request.at("scale").get<float>());
        reconstruction.setThreads(1);
        reconstruction.setInputCloud(both);
        reconstruction.reconstruct(vertices, polygons);
    });
    peers::RawInput mesh;
    for (const pcl::PointNormal& p : vertices) mesh.points.push_back({p.x, p.y, p.z});
    for (const pcl::Vertices& polygon : polygons)
        mesh.triangles.push_back({static_cast<std::uint32_t>(polygon.vertices[0]),
                                  static_cast<std::uint32_t>(polygon.vertices[1]),
                                  static_cast<std::uint32_t>(polygon.vertices[2])});
    return {{"seconds", seconds},
            {"triangles", mesh.triangles.size()},
            {"volume", peers::enclosed_volume(mesh.points, mesh.triangles)}};
}

/// Estimates normals from 20 neighbours, then triangulates with the angles of the tutorial. The radius is a parameter,
/// because that of the tutorial fits only its own scan.
Json project_greedily(const Cloud::Ptr& cloud, const Json& request) {
    pcl::PolygonMesh mesh;
    const double seconds = peers::seconds_of([&] {
        pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
        const auto tree = pcl::make_shared<pcl::search::KdTree<pcl::PointXYZ>>();
        estimation.setInputCloud(cloud);
        estimation.setSearchMethod(tree);
        estimation.setKSearch(20);
        Normals normals;
        estimation.compute(normals);
        const auto both = pcl::make_shared<pcl::PointCloud<pcl::PointNormal>>();
        pcl::concatenateFields(*cloud, normals, *both);
        pcl::GreedyProjectionTriangulation<pcl::PointNormal> triangulation;
        triangulation.setSearchRadius(request.at("radius").get<double>());
        triangulation.setMu(2.5);
        triangulation.setMaximumNearestNeighbors(100);
        triangulation.setMaximumSurfaceAngle(M_PI / 4);
        triangulation.setMinimumAngle(M_PI / 18);
        triangulation.setMaximumAngle(2 * M_PI / 3);
        triangulation.setNormalConsistency(false);
        triangulation.setInputCloud(both);
        triangulation.setSearchMethod(pcl::make_shared<pcl::search::KdTree<pcl::PointNormal>>());
        triangulation.reconstruct(mesh);
    });
    std::vector<bool> used(cloud->size(), false);
    for (const pcl::Vertices& polygon : mesh.polygons)
        for (const auto corner : polygon.vertices) used[static_cast<std::size_t>(corner)] = true;
    return {{"seconds", seconds},
            {"triangles", mesh.polygons.size()},
            {"unused", std::count(used.begin(), used.end(), false)}};
}

}  // namespace

int main() {
    const auto cloud = pcl::make_shared<Cloud>();
    Normals normals;
    return peers::answer({{"load", [&](const Json& request) { return load(*cloud, normals, request); }},
                          {"poisson", [&](const Json& request) { return poisson(*cloud, normals, request); }},
                          {"uniform-sampling", [&](const Json& request) { return sample_uniformly(cloud, request); }},
                          {"voxel-grid", [&](const Json& request) { return average(cloud, request); }},
                          {"remove-outliers", [&](const Json& request) { return remove_outliers(cloud, request); }},
                          {"normals", [&](const Json& request) { return estimate_normals(cloud, request); }},
                          {"greedy-projection", [&](const Json& request) { return project_greedily(cloud, request); }}},
                         {{"PCL", PCL_VERSION_PRETTY}});
}
