// SPDX-License-Identifier: GPL-3.0-or-later
/// Fusing the ten raw views of the Stanford bunny, whose poses are disturbed by half a spacing.
#include <gmock/gmock.h>

#include "filters/merge/cases.hpp"
#include "merge/scan_poses.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/data/point_tree.hpp"
#include "scanmill/data/spacing.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/geometry/fit/covariance.hpp"
#include "support/real_data.hpp"

namespace scanmill::test {
namespace {

/// The centroid and the normal of the 12 points of a tree that are nearest to p.
Scatter plane_at(const Vec3& p, const PointTree& tree, NeighbourBuffer& buffer) {
    Array<Vec3> offsets;
    for (const Neighbour& n : tree.nearest_to(p, 12, buffer)) offsets.push_back(tree.positions()[n.index] - p);
    return scatter_of(offsets);
}

struct Thickness {
    double points;  ///< median distance of a point from the planes of other views
    double layers;  ///< median distance between the planes of its own and of other views
};

/// For every 50th point, where another view has points on all sides within 2 spacings.
Thickness thickness(const PointCloud& cloud, double spacing) {
    const std::span<const u32> source = cloud.columns.find("source")->values<u32>();
    std::vector<PointTree> trees;
    for (std::size_t begin = 0, end; begin < cloud.size(); begin = end) {
        end = static_cast<std::size_t>(std::ranges::upper_bound(source, source[begin]) - source.begin());
        trees.emplace_back(cloud.positions.span().subspan(begin, end - begin));
    }
    std::vector<double> points, layers;
    NeighbourBuffer buffer;
    for (std::size_t row = 0; row < cloud.size(); row += 50) {
        const Vec3& p = cloud.positions[row];
        const Scatter own = plane_at(p, trees[source[row]], buffer);
        for (u32 view = 0; view < trees.size(); ++view) {
            if (view == source[row]) continue;
            const Scatter other = plane_at(p, trees[view], buffer);
            const double height = other.normal.dot(other.centroid);
            if ((other.centroid - height * other.normal).norm() > spacing) continue;
            if (std::abs(height) > 3 * spacing || std::abs(own.normal.dot(other.normal)) < 0.9) continue;
            points.push_back(std::abs(height));
            const double sign = own.normal.dot(other.normal) < 0 ? -1 : 1;
            layers.push_back(std::abs(height - sign * own.normal.dot(own.centroid)));
        }
    }
    return {median(points), median(layers)};
}

TEST(FuseBunny, ViewsDisturbedByHalfASpacing_BecomeOneLayer) {
    SCANMILL_REAL_SCAN(conf, shared_data, "1-bunny/raw/bun.conf");
    Context context;
    const std::vector<ScanPose> poses = read_poses(conf, [&](std::string text) { context.warn(std::move(text)); });
    Clouds clouds;
    std::vector<Frame> frames;
    for (const ScanPose& pose : poses) {
        clouds.push_back(*read_points(conf.parent_path() / pose.scan));
        clouds.back().frame.name = std::filesystem::path(pose.scan).stem();
        frames.push_back(clouds.back().frame);
    }
    const double spacing = point_spacing(clouds[0].positions.span());
    MergeParams given, disturbed;
    Random random(7);
    for (const auto& pose : merging::poses_of(frames, poses, context)) {
        given.poses.push_back(pose.value());
        disturbed.poses.push_back(pose.value());
        const Vec3 direction(random.normal(), random.normal(), random.normal());
        disturbed.poses.back().translation += 0.5 * spacing * direction.normalized();
    }
    const auto measured = [&](const std::string& name, const PointCloud& cloud) {
        const Thickness found = thickness(cloud, spacing);
        RecordProperty(name + "-points", std::to_string(found.points / spacing));
        RecordProperty(name + "-layers", std::to_string(found.layers / spacing));
        return found;
    };
    measured("given", merged(clouds, given).points);
    const Thickness before = measured("disturbed", merged(clouds, disturbed).points);
    disturbed.fuse = given.fuse = Length::spacings(2);
    const Merged fused = merged(clouds, disturbed);
    const Thickness after = measured("disturbed-fused", fused.points);
    measured("given-fused", merged(clouds, given).points);
    EXPECT_LT(after.layers, before.layers / 8);
    EXPECT_LT(after.points, before.points / 3);
    EXPECT_GT(fused.fused, fused.points.size() / 2);
}

}  // namespace
}  // namespace scanmill::test
