// SPDX-License-Identifier: GPL-3.0-or-later
/// PCL's registration of two views, as in its tutorial "Robust pose estimation of rigid objects": normals, fast point
/// feature histograms, prerejective sample consensus; then ICP point to plane. Runs in one thread.

#include <pcl/common/transforms.h>
#include <pcl/features/fpfh.h>
#include <pcl/features/normal_3d.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/pcl_config.h>
#include <pcl/point_types.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/sample_consensus_prerejective.h>
#include <pcl/search/kdtree.h>

#include <cstdlib>
#include <ctime>

#include "answer.hpp"

namespace {

using peers::Json;
using Point = pcl::PointNormal;
using Cloud = pcl::PointCloud<Point>;
using Features = pcl::PointCloud<pcl::FPFHSignature33>;

/// Processor seconds that `work` takes.
template <class Work>
double seconds_of(Work&& work) {
    const std::clock_t begin = std::clock();
    work();
    return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

/// Lengths are in voxels: the caller scales the coordinates.
struct View {
    Cloud::Ptr all = pcl::make_shared<Cloud>(), some = pcl::make_shared<Cloud>(), reduced = pcl::make_shared<Cloud>();
    Features::Ptr features = pcl::make_shared<Features>();
};

/// Normals on the side of `direction`, from the points within two voxels, or from 30 points of a cloud that is not
/// reduced; as they are if `direction` is empty.
void estimate_normals(const Cloud::Ptr& cloud, const std::vector<float>& direction, bool is_reduced) {
    if (direction.empty()) return;
    pcl::NormalEstimation<Point, Point> estimation;
    estimation.setInputCloud(cloud);
    if (is_reduced)
        estimation.setRadiusSearch(2);
    else
        estimation.setKSearch(30);
    constexpr float far = 1e4F;
    estimation.setViewPoint(far * direction[0], far * direction[1], far * direction[2]);
    estimation.compute(*cloud);
}

View prepared(const Json& request) {
    View view;
    const peers::RawInput raw = peers::read_raw(request.at("path"));
    for (std::size_t i = 0; i < raw.points.size(); ++i) {
        Point p;
        p.getVector3fMap() = Eigen::Map<const Eigen::Vector3d>(raw.points[i].data()).cast<float>();
        if (!raw.normals.empty())
            p.getNormalVector3fMap() = Eigen::Map<const Eigen::Vector3d>(raw.normals[i].data()).cast<float>();
        view.all->push_back(p);
    }
    return view;
}

Json load(std::vector<View>& views, const Json& request) {
    View view = prepared(request);
    const auto direction = request.at("direction").get<std::vector<float>>();
    const double seconds = seconds_of([&] {
        pcl::VoxelGrid<Point> grid;
        grid.setInputCloud(view.all);
        grid.setLeafSize(1, 1, 1);
        grid.filter(*view.reduced);
        estimate_normals(view.reduced, direction, true);
        estimate_normals(view.all, direction, false);
        for (Point& p : *view.reduced) p.getNormalVector3fMap().normalize();
        pcl::FPFHEstimation<Point, Point> estimation;
        estimation.setInputCloud(view.reduced);
        estimation.setInputNormals(view.reduced);
        estimation.setRadiusSearch(5);
        estimation.compute(*view.features);
    });
    const auto step = request.at("step").get<std::size_t>();
    for (std::size_t i = 0; i < view.all->size(); i += step) view.some->push_back((*view.all)[i]);
    views.push_back(std::move(view));
    return {{"seconds", seconds}, {"reduced", views.back().reduced->size()}};
}

Eigen::Matrix4f refined(const Cloud::Ptr& source, const Cloud::Ptr& target, const Eigen::Matrix4f& start,
                        double reach) {
    pcl::IterativeClosestPointWithNormals<Point, Point> icp;
    icp.setInputSource(source);
    icp.setInputTarget(target);
    icp.setMaxCorrespondenceDistance(reach);
    icp.setMaximumIterations(30);
    icp.setTransformationEpsilon(1e-10);
    Cloud moved;
    icp.align(moved, start);
    return icp.getFinalTransformation();
}

Json answer_of(const Eigen::Matrix4f& pose, double seconds) {
    std::vector<float> rows;
    for (int i = 0; i < 16; ++i) rows.push_back(pose(i / 4, i % 4));
    return {{"seconds", seconds}, {"pose", rows}};
}

Eigen::Matrix4f pose_of(const Json& request) {
    const auto rows = request.at("pose").get<std::vector<float>>();
    return Eigen::Map<const Eigen::Matrix<float, 4, 4, Eigen::RowMajor>>(rows.data());
}

/// The tutorial's parameters: its voxels are 5 mm, its reach 2.5 voxels. "found" is false if no sample had enough
/// inliers.
Json find_pose(const std::vector<View>& views, const Json& request) {
    const View &source = views.at(request.at("source")), &target = views.at(request.at("target"));
    std::srand(request.at("seed").get<unsigned>());
    Eigen::Matrix4f pose = Eigen::Matrix4f::Identity();
    bool found = false;
    const double seconds = seconds_of([&] {
        pcl::SampleConsensusPrerejective<Point, Point, pcl::FPFHSignature33> consensus;
        consensus.setInputSource(source.reduced);
        consensus.setSourceFeatures(source.features);
        consensus.setInputTarget(target.reduced);
        consensus.setTargetFeatures(target.features);
        consensus.setMaximumIterations(50000);
        consensus.setNumberOfSamples(3);
        consensus.setCorrespondenceRandomness(5);
        consensus.setSimilarityThreshold(0.95F);
        consensus.setMaxCorrespondenceDistance(2.5);
        consensus.setInlierFraction(0.25F);
        Cloud moved;
        consensus.align(moved);
        found = consensus.hasConverged();
        if (found) pose = refined(source.reduced, target.reduced, consensus.getFinalTransformation(), 1.5);
    });
    Json answer = answer_of(pose, seconds);
    answer["found"] = found;
    return answer;
}

/// Refines a pose: some points of the source, all of the target.
Json refine(const std::vector<View>& views, const Json& request) {
    const View &source = views.at(request.at("source")), &target = views.at(request.at("target"));
    Eigen::Matrix4f pose;
    const double seconds =
        seconds_of([&] { pose = refined(source.some, target.all, pose_of(request), request.at("reach")); });
    return answer_of(pose, seconds);
}

}  // namespace

int main() {
    std::vector<View> views;
    return peers::answer({{"forget",
                           [&](const Json&) {
                               views.clear();
                               return Json::object();
                           }},
                          {"load", [&](const Json& request) { return load(views, request); }},
                          {"pose", [&](const Json& request) { return find_pose(views, request); }},
                          {"refine", [&](const Json& request) { return refine(views, request); }}},
                         {{"PCL", PCL_VERSION_PRETTY}});
}
