// SPDX-License-Identifier: GPL-3.0-or-later
/// The ten raw views of the Stanford bunny: with their poses read correctly, they lie on the model that Stanford made
/// of them.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>
#include <gmock/gmock.h>

#include "filters/merge/cases.hpp"
#include "merge/scan_poses.hpp"
#include "scanmill/formats/files.hpp"
#include "support/real_data.hpp"

namespace scanmill::test {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;

class Surface {
public:
    explicit Surface(const TriangleMesh& mesh) {
        const auto point = [&](u32 vertex) {
            const Vec3 p = mesh.frame.origin + mesh.positions[vertex];
            return Kernel::Point_3(p.x(), p.y(), p.z());
        };
        for (const Triangle& t : mesh.triangles) triangles_.emplace_back(point(t[0]), point(t[1]), point(t[2]));
        tree_.insert(triangles_.begin(), triangles_.end());
        tree_.accelerate_distance_queries();
    }
    double distance(const Vec3& p) const { return std::sqrt(tree_.squared_distance({p.x(), p.y(), p.z()})); }

private:
    Triangles triangles_;
    CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> tree_;
};

double quantile(std::vector<double> values, double share) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

class MergeBunny : public testing::Test {
protected:
    void SetUp() override {
        SCANMILL_REAL_SCAN(model, shared_data, "1-bunny/bun_zipper.ply");
        SCANMILL_REAL_SCAN(conf, shared_data, "1-bunny/raw/bun.conf");
        Context context;
        const std::vector<ScanPose> poses = read_poses(conf, [&](std::string text) { context.warn(std::move(text)); });
        std::vector<Frame> frames;
        for (const ScanPose& pose : poses) {
            clouds_.push_back(*read_points(conf.parent_path() / pose.scan));
            clouds_.back().frame.name = std::filesystem::path(pose.scan).stem();
            frames.push_back(clouds_.back().frame);
        }
        for (const auto& pose : merging::poses_of(frames, poses, context)) poses_.push_back(pose.value());
        EXPECT_THAT(context.warnings(), testing::IsEmpty());
        surface_ = std::make_unique<Surface>(*read_mesh(model));
    }
    /// For each view, the quantile of the distances of every hundredth point to the model.
    std::vector<double> distances(const PointCloud& cloud, double share) const {
        std::vector<std::vector<double>> by_source(clouds_.size());
        const std::span<const u32> source = cloud.columns.find("source")->values<u32>();
        for (std::size_t row = 0; row < cloud.size(); row += 100)
            by_source[source[row]].push_back(surface_->distance(cloud.frame.origin + cloud.positions[row]));
        std::vector<double> result;
        for (const std::vector<double>& view : by_source) result.push_back(quantile(view, share));
        return result;
    }

    Clouds clouds_;
    std::vector<RigidTransform> poses_;
    std::unique_ptr<Surface> surface_;
};

TEST_F(MergeBunny, TenViewsWithTheirPoses_LieOnTheModel) {
    const Merged all = merged(clouds_, posed(poses_));
    EXPECT_EQ(all.points.size(), 362'272u);
    EXPECT_THAT(all.doubts, testing::IsEmpty());
    // In metres; the model is 0.25 m long and its triangles' edges are a millimetre.
    EXPECT_THAT(distances(all.points, 0.5), testing::Each(testing::Lt(0.1e-3)));
    EXPECT_THAT(distances(all.points, 0.95), testing::Each(testing::Lt(0.5e-3)));
}

TEST_F(MergeBunny, QuaternionsReadTheUsualWay_PutMostViewsOffTheModel) {
    for (RigidTransform& pose : poses_) pose.rotation.transposeInPlace();
    const std::vector<double> medians = distances(merged(clouds_, posed(poses_)).points, 0.5);
    EXPECT_GE(std::ranges::count_if(medians, [](double median) { return median > 3e-3; }), 8);
}

TEST_F(MergeBunny, WithoutTheirPoses_TheViewsAreDoubtful) {
    const Merged all = merged(clouds_);
    ASSERT_EQ(all.doubts.size(), 1u);
    EXPECT_THAT(all.doubts[0].text, testing::HasSubstr("do not lie in one frame"));
}

TEST_F(MergeBunny, WithinASpacing_LessThanHalfIsKeptAndTheFirstViewWhole) {
    MergeParams params = posed(poses_);
    params.within = 0.5e-3;
    const Merged all = merged(clouds_, posed(poses_)), thinned = merged(clouds_, params);
    EXPECT_LT(thinned.points.size(), all.points.size() / 2);
    EXPECT_GT(thinned.points.size(), clouds_[0].size());
    EXPECT_EQ(thinned.points.size() + thinned.dropped, all.points.size());
    EXPECT_EQ(thinned.kept[clouds_[0].size() - 1], clouds_[0].size() - 1) << "the first view is kept whole";
}

}  // namespace
}  // namespace scanmill::test
