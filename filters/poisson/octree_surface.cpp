// SPDX-License-Identifier: GPL-3.0-or-later
#include "poisson/octree_surface.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <mutex>
#include <vector>

#include "scanmill/base/elementary.hpp"

// PCL's templates call these functions without a namespace, so these come before those of the C library: nothing is
// printed, and logarithms and powers have the same bits on every processor.
namespace pcl::poisson {

inline int printf(const char*, ...) { return 0; }
constexpr struct Nowhere {
} stderr;
inline int fprintf(Nowhere, const char*, ...) { return 0; }

using scanmill::elementary::log;
using scanmill::elementary::log2;
using scanmill::elementary::pow;

}  // namespace pcl::poisson

#include <pcl/pcl_macros.h>
#include <pcl/point_cloud.h>
// After these two.
#include <pcl/surface/3rdparty/poisson4/octree_poisson.h>
#include <pcl/surface/3rdparty/poisson4/sparse_matrix.h>
// After these two.
#include <pcl/surface/3rdparty/poisson4/function_data.h>
#include <pcl/surface/3rdparty/poisson4/geometry.h>
#include <pcl/surface/3rdparty/poisson4/multi_grid_octree_data.h>
#include <pcl/surface/3rdparty/poisson4/ppolynomial.h>

namespace scanmill {

namespace {

constexpr int degree = 2, full_depth = 5, least_iterations = 8;
constexpr float samples_per_node = 1, point_weight = 4, accuracy = 1e-3f;

/// The memory of the octree's cells, freed at the end.
struct Memory {
    Memory() { pcl::poisson::TreeOctNode::SetAllocator(1 << 12); }
    ~Memory() { pcl::poisson::TreeOctNode::SetAllocator(1); }
    Memory(const Memory&) = delete;
    Memory& operator=(const Memory&) = delete;
};

struct Solver : pcl::poisson::Octree<degree> {
    Solver() { normals = nullptr; }
    ~Solver() { delete normals; }  // null after SetLaplacianConstraints()
};

/// Collects the polygons, all triangles, that the octree's surface consists of. Vertices on the faces of cells are
/// `inCorePoints`; the others have numbers of their own.
class Collected : public pcl::poisson::CoredMeshData {
public:
    int addOutOfCorePoint(const pcl::poisson::Point3D<float>& point) override {
        inner_.push_back(point);
        return static_cast<int>(inner_.size() - 1);
    }
    int addPolygon(const std::vector<pcl::poisson::CoredVertexIndex>& polygon) override {
        triangles_.push_back({polygon[0], polygon[1], polygon[2]});
        return static_cast<int>(triangles_.size() - 1);
    }
    int outOfCorePointCount() override { return static_cast<int>(inner_.size()); }
    int polygonCount() override { return static_cast<int>(triangles_.size()); }
    // The octree does not read what it wrote.
    void resetIterator() override {}
    int nextOutOfCorePoint(pcl::poisson::Point3D<float>&) override { return 0; }
    int nextPolygon(std::vector<pcl::poisson::CoredVertexIndex>&) override { return 0; }

    OctreeSurface surface(const pcl::poisson::Point3D<float>& corner, float scale) const {
        OctreeSurface result;
        result.positions.reserve(inCorePoints.size() + inner_.size());
        for (const auto* points : {&inCorePoints, &inner_})
            for (const pcl::poisson::Point3D<float>& point : *points)
                result.positions.emplace_back(double(point[0]) * scale + corner[0],
                                              double(point[1]) * scale + corner[1],
                                              double(point[2]) * scale + corner[2]);
        result.triangles.reserve(triangles_.size());
        for (const auto& triangle : triangles_) {
            Triangle& added = result.triangles.emplace_back();
            for (std::size_t i = 0; i < 3; ++i)
                added[i] = static_cast<u32>(triangle[i].idx) +
                           (triangle[i].inCore ? 0 : static_cast<u32>(inCorePoints.size()));
        }
        return result;
    }

private:
    std::vector<pcl::poisson::Point3D<float>> inner_;
    std::vector<std::array<pcl::poisson::CoredVertexIndex, 3>> triangles_;
};

}  // namespace

OctreeSurface octree_surface(std::span<const OrientedPoint> points, int depth, double scale,
                             const std::function<void(double share)>& progress) {
    using namespace pcl::poisson;
    static std::mutex one_at_a_time;  // the octree's memory is a static member
    const std::scoped_lock lock(one_at_a_time);

    const auto cloud = std::make_shared<pcl::PointCloud<OrientedPoint>>();
    cloud->points.assign(points.begin(), points.end());
    const Memory memory;
    Solver octree;
    octree.threads = 1;
    octree.setBSplineData(depth, Real(1.0 / (1 << depth)), true);
    Point3D<float> corner;
    float size = 1;
    octree.setTree<OrientedPoint>(cloud, depth, full_depth, depth - 2, samples_per_node, static_cast<float>(scale),
                                  corner, size, 0, point_weight, true);
    progress(0.1);
    octree.ClipTree();
    octree.finalize();
    progress(0.13);
    octree.RefineBoundary(depth);
    progress(0.15);
    octree.SetLaplacianConstraints();
    delete[] octree.fData.dvDotTable;  // PCL makes another one, and would lose this
    octree.fData.dvDotTable = nullptr;
    progress(0.25);
    octree.LaplacianMatrixIteration(depth, false, least_iterations, accuracy);
    progress(0.6);
    const float level = octree.GetIsoValue();
    progress(0.65);
    Collected collected;
    if (std::isfinite(level)) octree.GetMCIsoTriangles(level, depth, &collected, 0, 1, true, false);
    progress(1);
    OctreeSurface surface = collected.surface(corner, size);
    surface.cell = size / (1 << depth);
    return surface;
}

}  // namespace scanmill
