// SPDX-License-Identifier: GPL-3.0-or-later
/// a-patch on scanned models, decimated.
#include <fstream>
#include <set>
#include <sstream>

#include "alpha_solid/alpha_solid.hpp"
#include "decimate/decimate.hpp"
#include "delaunay/delaunay.hpp"
#include "filters/a_patch/cases.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/geometry/distance/nearest_distances.hpp"
#include "scanmill/geometry/distance/self_intersections.hpp"
#include "sculpt/sculpt.hpp"
#include "support/real_data.hpp"
#include "tessellate/tessellate.hpp"

namespace scanmill::test {
namespace {

class APatchReal : public testing::TestWithParam<const char*> {};

TEST_P(APatchReal, DecimatedModel_HasOneClosedSmoothSheet) {
    SCANMILL_REAL_SCAN(path, fetched_data, GetParam());
    const auto mesh = read_mesh(path);
    DecimateParams reduction;
    reduction.max_error = 0.003 * surface_box(*mesh).diagonal();
    Context context;
    const TriangleMesh light = decimate(*mesh, nullptr, reduction, context).mesh;
    for (const Split split : {Split::always, Split::where_needed}) {
        APatchParams params;
        params.split = split;
        const PatchRun run = patched(light, params, nullptr, 2);
        EXPECT_EQ(run.result.inverted, 0u);
        EXPECT_EQ(run.result.sign_violations, 0u);
        EXPECT_LT(run.result.c1_jump, 1e-9);
        EXPECT_GT(for_each_ray(run.result.patches, 4, [](u32, const Vec3&) {}), 1000u);
        Execution execution;
        const TriangleMesh fine = tessellate(run.result.patches, {3, {}}, execution);
        const MeshTopology found = topology(fine);
        EXPECT_TRUE(found.closed);
        EXPECT_EQ(found.euler, topology(light).euler);
        const TriangleTree tree(fine.positions.span(), fine.triangles.span(), 2);
        EXPECT_EQ(self_intersections(fine.positions.span(), fine.triangles.span(), tree, execution).count, 0u);
    }
}
INSTANTIATE_TEST_SUITE_P(Models, APatchReal,
                         testing::Values("meshes/bunny00.off", "meshes/bear.off", "meshes/eight.off",
                                         "meshes/knot1.off"));

struct SolidCase {
    std::optional<std::filesystem::path> (*source)(std::string_view);
    const char* name;
    double error;  ///< of decimation, as a share of the diagonal
};

void PrintTo(const SolidCase& solid, std::ostream* stream) { *stream << solid.name << ", " << solid.error; }

class APatchSolid : public testing::TestWithParam<SolidCase> {};

/// Through all points of a scan, with folds where it has noise.
TriangleMesh solid_of(const PointCloud& points, double error) {
    Context context;
    const TriangleMesh mesh =
        sculpt(alpha_solid(delaunay(points, {}, context).tets, {}, context).tets, {}, context).mesh;
    DecimateParams reduction;
    reduction.max_error = error * surface_box(mesh).diagonal();
    return decimate(mesh, &points, reduction, context).mesh;
}

TEST_P(APatchSolid, OfAScan_HasOneClosedSheetWithoutIntersections) {
    const auto path = GetParam().source(GetParam().name);
    if (!path) GTEST_SKIP() << missing_data(GetParam().name);
    const auto points = read_points(*path);
    const TriangleMesh light = solid_of(*points, GetParam().error);
    for (const bool is_fitted : {false, true}) {
        APatchParams params;
        params.fit = is_fitted;
        const PatchRun run = patched(light, params, points.get(), 2);
        EXPECT_EQ(run.result.inverted, 0u);
        EXPECT_EQ(run.result.sign_violations, 0u);
        EXPECT_LT(run.result.c1_jump, 1e-10);
        const PatchComplex& patches = run.result.patches;
        const int per_tet = static_cast<int>(500'000 / patches.tets.size()) + 1;
        EXPECT_GT(for_each_ray(
                      patches, per_tet, [](u32, const Vec3&) {}, true),
                  100'000u);
        Execution execution;
        const TriangleMesh fine = tessellate(patches, {4, {}}, execution);
        const MeshTopology found = topology(fine);
        EXPECT_TRUE(found.closed);
        EXPECT_EQ(found.euler, topology(light).euler);
        const TriangleTree tree(fine.positions.span(), fine.triangles.span(), 2);
        EXPECT_EQ(self_intersections(fine.positions.span(), fine.triangles.span(), tree, execution).count, 0u);
    }
}
INSTANTIATE_TEST_SUITE_P(Scans, APatchSolid,
                         testing::Values(SolidCase{fetched_data, "points_3/kitten.xyz", 0.003},
                                         SolidCase{fetched_data, "points_3/kitten.xyz", 0.001},
                                         SolidCase{fetched_data, "meshes/hand.off", 0.003},
                                         SolidCase{shared_data, "1-bunny/bun_zipper.ply", 0.003},
                                         SolidCase{shared_data, "7-seed-like/femur_gfxmorph.stl", 0.003},
                                         SolidCase{shared_data, "7-seed-like/femur_gfxmorph.stl", 0.001}));

/// The model's mesh; that of a point file is reconstructed.
TriangleMesh model(const std::filesystem::path& path) {
    if (path.extension() != ".xyz") return *read_mesh(path);
    Context context;
    return sculpt(alpha_solid(delaunay(*read_points(path), {}, context).tets, {}, context).tets, {}, context).mesh;
}

class APatchRealFit : public testing::TestWithParam<const char*> {};

TEST_P(APatchRealFit, DecimatedModel_IsAtMostHalfAsFarFromThePointsAsItsMesh) {
    SCANMILL_REAL_SCAN(path, fetched_data, GetParam());
    const TriangleMesh mesh = model(path);
    PointCloud points;
    points.frame = mesh.frame;
    points.positions = mesh.positions;
    for (const double share : {0.003, 0.001}) {
        DecimateParams reduction;
        reduction.max_error = share * surface_box(mesh).diagonal();
        Context context;
        TriangleMesh light = decimate(mesh, nullptr, reduction, context).mesh;
        light.sharp_edges = {};  // smooth models
        const TriangleTree tree(light.positions.span(), light.triangles.span(), 2);
        double squares = 0;
        for (const double d : nearest_distances(points.positions.span(), tree, 0, context).distances) squares += d * d;
        const double to_mesh = std::sqrt(squares / static_cast<double>(points.size()));
        APatchParams params;
        params.fit = false;
        const double unfitted = patched(light, params, &points, 2).result.fit->rms;
        params.fit = true;
        params.interpolate = APatchParams::Interpolate::yes;
        const PatchRun through_vertices = patched(light, params, &points, 2), run = patched(light, {}, &points, 2);
        EXPECT_LT(through_vertices.result.fit->rms, unfitted);
        EXPECT_LT(through_vertices.result.fit->rms, 0.4 * to_mesh);
        EXPECT_LT(through_vertices.result.left_out, points.size() / 100);
        // Even triangles resolve less of the smallest details, such as the bunny's.
        EXPECT_LT(run.result.fit->rms, 0.55 * to_mesh);
        EXPECT_LT(run.result.left_out, points.size() / 50);
        EXPECT_LT(run.result.c1_jump, 1e-9);
        EXPECT_EQ(run.result.inverted, 0u);
        const auto [value, gradient] = errors_at_vertices(run.result);
        EXPECT_LT(value, 1e-13);
        EXPECT_LT(gradient, 1e-9);
    }
}
INSTANTIATE_TEST_SUITE_P(Models, APatchRealFit,
                         testing::Values("points_3/kitten.xyz", "meshes/bunny00.off", "meshes/bear.off"));

TEST(APatchRealFit, DecimatedZipperedMesh_IsAtMostHalfAsFarFromThePointsAsItsMesh) {
    // Open, with folds where its views were joined: sharp edges stay.
    SCANMILL_REAL_SCAN(path, shared_data, "1-bunny/bun_zipper.ply");
    const TriangleMesh mesh = *read_mesh(path);
    PointCloud points;
    points.frame = mesh.frame;
    points.positions = mesh.positions;
    DecimateParams reduction;
    reduction.max_error = 0.003 * surface_box(mesh).diagonal();
    Context context;
    const TriangleMesh light = decimate(mesh, nullptr, reduction, context).mesh;
    const TriangleTree tree(light.positions.span(), light.triangles.span(), 2);
    double squares = 0;
    for (const double d : nearest_distances(points.positions.span(), tree, 0, context).distances) squares += d * d;
    const PatchRun run = patched(light, {}, &points, 2);
    EXPECT_LT(run.result.fit->rms, 0.5 * std::sqrt(squares / static_cast<double>(points.size())));
    EXPECT_LT(run.result.left_out, points.size() / 50);
    EXPECT_EQ(run.result.inverted, 0u);
    EXPECT_EQ(run.result.sign_violations, 0u);
    EXPECT_LT(run.result.c1_jump, 1e-9);
}

// Creases.

double distance_to(const TriangleMesh& mesh, std::span<const Edge> edges, const Vec3& p) {
    double least = std::numeric_limits<double>::infinity();
    for (const Edge& edge : edges) {
        const Vec3 &a = mesh.positions[edge[0]], d = mesh.positions[edge[1]] - a;
        const double share = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
        least = std::min(least, (p - a - share * d).norm());
    }
    return least;
}

/// A face's unit normal.
Vec3 normal_of(const TriangleMesh& mesh, u32 triangle) {
    const Triangle& t = mesh.triangles[triangle];
    return (mesh.positions[t[1]] - mesh.positions[t[0]])
        .cross(mesh.positions[t[2]] - mesh.positions[t[0]])
        .normalized();
}

double degrees_between(const Vec3& one, const Vec3& other) {
    return std::acos(std::clamp(one.dot(other), -1.0, 1.0)) * 180 / std::numbers::pi;
}

/// Compares the creases of a tessellation, away from triangles with tips and facets, with the object's sharp edges.
struct CreaseFigures {
    std::vector<double> distances;  ///< distance from an edge's middle to the object's sharp edges, ascending
    std::vector<double>
        turned;  ///< degrees that the dihedral angle differs from that of the object's nearest edge, ascending
    /// Corners of creases of 20 degrees and more, and those whose normal is nearer to their own triangle's than to that
    /// beyond the edge.
    std::size_t corners = 0, one_sided = 0;
};

CreaseFigures figures_of(const TriangleMesh& object, std::span<const Edge> edges, const APatchResult& result,
                         const TriangleMesh& fine) {
    std::map<Edge, double> angle_of;
    const Array<u32> of_object = half_edges::opposites(object), opposites = half_edges::opposites(fine);
    for (u32 half = 0; half < of_object.size(); ++half)
        if (of_object[half] != half_edges::boundary)
            angle_of[make_edge(half_edges::start(object, half), half_edges::end(object, half))] =
                degrees_between(normal_of(object, half / 3), normal_of(object, of_object[half] / 3));
    const auto corner_normals = fine.face_columns.find("corner-normals")->values<double>();
    const Column* patch = fine.face_columns.find("patch");
    const auto is_flat = [&](std::size_t f) { return f < result.flat.size() && result.flat[f]; };
    std::set<Edge> creases;  // of the light mesh, with tetrahedra; the others have strips
    for (u32 row = 0; row < result.patches.tets.size(); ++row)
        if (result.patches.kinds[row] == PatchKind::sharp)
            creases.insert(make_edge(result.patches.tets[row][1], result.patches.tets[row][2]));
    const auto is_crease_between = [&](std::size_t one, std::size_t other) {
        std::vector<u32> common;
        for (const u32 v : result.mesh.triangles[one])
            if (std::ranges::find(result.mesh.triangles[other], v) != result.mesh.triangles[other].end())
                common.push_back(v);
        return common.size() == 2 && creases.contains(make_edge(common[0], common[1]));
    };
    CreaseFigures figures;
    for (u32 half = 0; half < opposites.size(); ++half) {
        const u32 other = opposites[half];
        const Edge edge = make_edge(half_edges::start(fine, half), half_edges::end(fine, half));
        if (other == half_edges::boundary || other < half || !std::ranges::binary_search(fine.sharp_edges, edge))
            continue;
        const auto of_one = static_cast<std::size_t>(patch->number(half / 3, 0)),
                   of_other = static_cast<std::size_t>(patch->number(other / 3, 0));
        if (is_flat(of_one) || is_flat(of_other)) continue;
        const Vec3 middle = (fine.positions[edge[0]] + fine.positions[edge[1]]) / 2;
        const auto nearest = std::ranges::min_element(
            edges, {}, [&](const Edge& each) { return distance_to(object, std::span(&each, 1), middle); });
        figures.distances.push_back(distance_to(object, std::span(&*nearest, 1), middle));
        const Vec3 one = normal_of(fine, half / 3), second = normal_of(fine, other / 3);
        figures.turned.push_back(std::abs(degrees_between(one, second) - angle_of.at(*nearest)));
        // A strip has the normals of the surfaces that it joins.
        if (degrees_between(one, second) < 20 || !is_crease_between(of_one, of_other)) continue;
        for (const auto& [corner, own, beyond] :
             {std::tuple(half, one, second), std::tuple(half_edges::after(half), one, second),
              std::tuple(other, second, one), std::tuple(half_edges::after(other), second, one)}) {
            const Vec3 n = Eigen::Map<const Vec3>(corner_normals.data() + 3 * corner);
            ++figures.corners;
            figures.one_sided += n.dot(own) > n.dot(beyond);
        }
    }
    std::ranges::sort(figures.distances);
    std::ranges::sort(figures.turned);
    return figures;
}

struct Reduced {
    PointCloud points;  ///< the vertices before
    TriangleMesh light;
    double max_error;
};

/// Decimated with a max-error of this share of the diagonal.
Reduced reduced(const TriangleMesh& mesh, double share = 0.003) {
    PointCloud points;
    points.frame = mesh.frame;
    points.positions = mesh.positions;
    DecimateParams reduction;
    const double max_error = share * surface_box(mesh).diagonal();
    reduction.max_error = max_error;
    Context context;
    TriangleMesh light = decimate(mesh, &points, reduction, context).mesh;
    return {std::move(points), std::move(light), max_error};
}

struct CreaseCase {
    const char* name;
    const char* tags;  ///< a file with the sharp edges; empty: those of 40 degrees
    // Least shares of the creases.
    double near;  ///< within max_error of the object's
    std::optional<double> as_sharp;  ///< within 5 degrees of their dihedral angle
    double one_sided;  ///< with normals of their own side
};

void PrintTo(const CreaseCase& object, std::ostream* stream) { *stream << object.name; }

class APatchRealObject : public testing::TestWithParam<CreaseCase> {};

TEST_P(APatchRealObject, Decimated_HasItsCreases) {
    const CreaseCase& object = GetParam();
    SCANMILL_REAL_SCAN(path, shared_data, object.name);
    TriangleMesh mesh = *read_mesh(path);
    std::vector<Edge> edges;
    if (*object.tags != '\0') {
        std::ifstream tags(*shared_data(object.tags));
        for (std::string line; std::getline(tags, line);) {
            std::istringstream row(line);
            u32 a = 0, b = 0;
            if (row >> a >> b) edges.push_back(make_edge(a, b));
        }
        ASSERT_EQ(edges.size(), 568u);
        std::ranges::sort(edges);
        mesh.sharp_edges = Array<Edge>(edges.begin(), edges.end());
    }
    const Array<u32> opposites = half_edges::opposites(mesh);
    for (u32 half = 0; half < opposites.size(); ++half)
        if (opposites[half] != half_edges::boundary && opposites[half] > half &&
            degrees_between(normal_of(mesh, half / 3), normal_of(mesh, opposites[half] / 3)) > 40)
            edges.push_back(make_edge(half_edges::start(mesh, half), half_edges::end(mesh, half)));
    const auto [points, light, max_error] = reduced(mesh);
    const PatchRun run = patched(light, {}, &points, 2);
    Context context;
    EXPECT_EQ(run.result.inverted, 0u);
    EXPECT_EQ(run.result.sign_violations, 0u);
    const TriangleMesh fine = tessellate(run.result.patches, {8, {}}, context);
    const MeshTopology found = topology(fine), wanted = topology(light);
    EXPECT_EQ(found.closed, wanted.closed);
    EXPECT_EQ(found.euler, wanted.euler);
    EXPECT_EQ(found.boundary_loops, wanted.boundary_loops);
    const CreaseFigures figures = figures_of(mesh, edges, run.result, fine);
    ASSERT_GT(figures.distances.size(), 200u);
    const auto share_up_to = [&](const std::vector<double>& values, double most) {
        return static_cast<double>(std::ranges::upper_bound(values, most) - values.begin()) /
               static_cast<double>(values.size());
    };
    const double near = share_up_to(figures.distances, max_error), as_sharp = share_up_to(figures.turned, 5);
    RecordProperty("near", std::to_string(near));
    RecordProperty("one-sided",
                   std::to_string(static_cast<double>(figures.one_sided) / static_cast<double>(figures.corners)));
    RecordProperty("as-sharp", std::to_string(as_sharp));
    EXPECT_GE(near, object.near);
    if (object.as_sharp) {
        EXPECT_GE(as_sharp, *object.as_sharp);
    }
    EXPECT_GE(static_cast<double>(figures.one_sided), object.one_sided * static_cast<double>(figures.corners));
}
INSTANTIATE_TEST_SUITE_P(
    Objects, APatchRealObject,
    testing::Values(
        // Its edges are rounded over several triangles, so a single edge has no angle to compare with.
        CreaseCase{"3-mechanical/fandisk_large.off", "", 0.98, std::nullopt, 0.97},
        CreaseCase{"8-derived/golf_club.ply", "8-derived/golf_club_sharp_edges.txt", 1, 0.43, 0.99},
        CreaseCase{"3-mechanical/anchor_dense.off", "", 1, 0.65, 1}));

TEST(APatchRealCreases, ThatLeaveTheirEdges_CostNoSmoothnessBesideThem) {
    // Coarse, so that some of its creases leave their edges.
    SCANMILL_REAL_SCAN(path, fetched_data, "meshes/fandisk.off");
    const auto [points, light, max_error] = reduced(*read_mesh(path), 0.01);
    APatchParams params;
    params.interpolate = APatchParams::Interpolate::yes;
    const PatchRun run = patched(light, params, &points, 2);
    EXPECT_GT(run.result.repairs.opened, 0u);
    EXPECT_LE(100 * run.result.loosened, run.result.mesh.positions.size());
    EXPECT_EQ(run.result.inverted, 0u);
    EXPECT_EQ(run.result.sign_violations, 0u);
    Context context;
    EXPECT_EQ(topology(tessellate(run.result.patches, {8, {}}, context)).euler, topology(light).euler);
}

TEST(APatchRealCreases, OfAnAnchor_AreNearTheOriginalEdges_AndAsSharp) {
    SCANMILL_REAL_SCAN(path, shared_data, "3-mechanical/anchor_dense.off");
    const TriangleMesh mesh = *read_mesh(path);
    const auto [points, light, max_error] = reduced(mesh);
    const PatchRun run = patched(light, {}, &points, 2);
    Context context;
    EXPECT_LT(run.result.loosened, 5u);
    const TriangleMesh fine = tessellate(run.result.patches, {8, {}}, context);
    const auto normal = [](const TriangleMesh& of, u32 f) -> Vec3 {
        const Triangle& t = of.triangles[f];
        return (of.positions[t[1]] - of.positions[t[0]]).cross(of.positions[t[2]] - of.positions[t[0]]).normalized();
    };
    // The object's edges are right angles.
    std::vector<Edge> edges;
    const Array<u32> of_mesh = half_edges::opposites(mesh), opposites = half_edges::opposites(fine);
    for (u32 half = 0; half < of_mesh.size(); ++half)
        if (of_mesh[half] > half && normal(mesh, half / 3).dot(normal(mesh, of_mesh[half] / 3)) < 0.766)  // 40 degrees
            edges.push_back(make_edge(half_edges::start(mesh, half), half_edges::end(mesh, half)));
    std::vector<double> off;
    double farthest = 0;
    for (u32 half = 0; half < opposites.size(); ++half) {
        const Edge edge = make_edge(half_edges::start(fine, half), half_edges::end(fine, half));
        if (opposites[half] < half || !std::ranges::binary_search(fine.sharp_edges, edge)) continue;
        farthest =
            std::max(farthest, distance_to(mesh, edges, (fine.positions[edge[0]] + fine.positions[edge[1]]) / 2));
        const double cosine = normal(fine, half / 3).dot(normal(fine, opposites[half] / 3));
        off.push_back(std::abs(std::asin(std::clamp(cosine, -1.0, 1.0))) * 180 / std::numbers::pi);
    }
    ASSERT_GT(off.size(), 1000u);
    EXPECT_LT(farthest, max_error);
    std::ranges::sort(off);
    EXPECT_LT(off[off.size() / 2], 2);
    EXPECT_LT(off[off.size() * 4 / 5], 5);
}

}  // namespace
}  // namespace scanmill::test
