// SPDX-License-Identifier: GPL-3.0-or-later
/// sculpt, features, measure, a-patch, poisson and the filters of probing give the same bytes on every processor: on
/// one without fused multiply-add the C library takes other variants of atan2, sin and the like, whose last bits
/// differ.

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "a_patch/a_patch.hpp"
#include "align/align.hpp"
#include "apply_transform/apply_transform.hpp"
#include "features/features.hpp"
#include "filters/sculpt/cases.hpp"
#include "measure/measure.hpp"
#include "normals/normals.hpp"
#include "plate_corners/plate_corners.hpp"
#include "poisson/poisson.hpp"
#include "probe_planner/probe_planner.hpp"
#include "scanmill/geometry/spatial/angle.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"
#include "support/temporary_folder.hpp"
#include "tessellate/tessellate.hpp"
#include "virtual_probe/virtual_probe.hpp"

namespace scanmill::test {
namespace {

/// Where the second process writes its results.
constexpr const char* output_variable = "SCANMILL_TEST_PROCESSOR_OUTPUT";
constexpr const char* without_fma = "glibc.cpu.hwcaps=-FMA,-AVX2_Usable,-FMA_Usable,-AVX2,-FMA4";

/// Hash of the bits of numbers (FNV-1a).
class Digest {
public:
    void add(double number) {
        for (std::uint64_t bits = std::bit_cast<std::uint64_t>(number), byte = 0; byte < 8; ++byte, bits >>= 8)
            hash_ = (hash_ ^ (bits & 255)) * 0x100000001b3;
    }
    void add(const Vec3& vector) {
        for (const double number : vector) add(number);
    }
    std::uint64_t value() const { return hash_; }

private:
    std::uint64_t hash_ = 0xcbf29ce484222325;
};

std::uint64_t of_angles() {
    Digest digest;
    for (int i = -300; i <= 300; ++i)
        for (int j = 0; j <= 300; ++j) digest.add(angle_of(i, j));
    return digest.value();
}

std::uint64_t of_sculpted(const SculptResult& result) {
    Digest digest;
    for (const SculptRemoval& removal : result.removals) {
        digest.add(removal.cell);
        digest.add(removal.gain);
    }
    digest.add(result.bending_before);
    digest.add(result.bending_after);
    return digest.value();
}

std::uint64_t of_features(const TriangleMesh& mesh) {
    Context context;
    const FeatureGraph graph = features(mesh, {}, context).graph;
    Digest digest;
    for (const u32 corner : graph.corners) digest.add(corner);
    for (const u32 vertex : graph.vertices) digest.add(vertex);
    for (const Vec3& normal : graph.left_normals) digest.add(normal);
    return digest.value();
}

std::uint64_t of_measured(const TriangleMesh& mesh, const TriangleMesh& truth) {
    Context context;
    MeasureParams few;
    few.samples = 1000;
    Digest digest;
    for (const Metric& metric : metrics_of(measure(mesh, truth, few, context)).values) digest.add(metric.value);
    return digest.value();
}

/// Of a bumpy surface with normals of the mesh, where heights and weights are adjusted, alone and fitted to noisy
/// points, and of its tessellation.
std::uint64_t of_patches(TriangleMesh mesh) {
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] *= 1 + static_cast<double>(i % 5) / 64;
    mesh.positions = std::move(positions);
    Context context;
    const PatchComplex patches = a_patch(mesh, nullptr, {}, context).patches;
    Digest digest;
    for (const PatchWeights& weights : patches.weights)
        for (const double weight : weights) digest.add(weight);
    for (const Vec3& p : tessellate(patches, {}, context).positions) digest.add(p);
    Random random(3);
    Array<Vec3> noisy;
    for (int i = 0; i < 5000; ++i) {
        const Triangle& t = mesh.triangles[static_cast<std::size_t>(i) % mesh.triangles.size()];
        Vec3 share(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1));
        share /= share.sum();
        Vec3 p = Vec3::Zero();
        for (std::size_t k = 0; k < 3; ++k) p += share[static_cast<Eigen::Index>(k)] * mesh.positions[t[k]];
        noisy.push_back(p * random.uniform(1, 1.02));
    }
    PointCloud points;
    points.positions = std::move(noisy);
    APatchParams params;
    params.normals = APatchParams::Normals::mesh;
    for (const bool are_normals_fitted : {false, true}) {
        if (are_normals_fitted) params.normals = APatchParams::Normals::automatic;
        const APatchResult fitted = a_patch(mesh, &points, params, context);
        for (const PatchWeights& weights : fitted.patches.weights)
            for (const double weight : weights) digest.add(weight);
        digest.add(fitted.fit->rms);
    }
    return digest.value();
}

/// With a given and with a sought approach.
std::uint64_t of_probes(const TriangleMesh& mesh) {
    Digest digest;
    ProbePlannerParams params;
    params.radius = 0.04;
    params.scanner_error = 0.01;
    params.spacing = 0.1;
    for (int round = 0; round < 3; ++round) {
        Context context;
        params.directions = round == 1 ? 2 : 1;
        if (round == 2) params.approach = Angle::degrees(33);
        const ProbePlannerResult result = probe_planner(features(mesh, {}, context).graph, mesh, params, context);
        for (const ProbeTouch& touch : result.plan.touches) {
            digest.add(touch.position);
            digest.add(touch.approach);
            digest.add(touch.start);
            digest.add(touch.false_share);
            for (const double number : {touch.interior_angle, touch.range.max, touch.phi, touch.contact_distance})
                if (!std::isnan(number)) digest.add(number);
        }
        digest.add(result.travel);
        VirtualProbeParams errors;
        errors.reference_error = 0.01;
        errors.noise = 0.001;
        const VirtualProbeResult touched = virtual_probe(result.plan, mesh, errors, context);
        for (const Vec3& p : touched.points.positions) digest.add(p);
    }
    return digest.value();
}

/// Of a jittered lattice on a block, with normals by neighbours.
std::uint64_t of_poisson() {
    Digest digest;
#ifdef SCANMILL_PCL
    Context context;
    PoissonParams params;
    params.depth = 6;
    const PointCloud cloud = normals(l_block_surface(8, 2, 8, 0.01), {}, context).points;
    for (const Vec3& p : poisson(cloud, params, context).mesh.positions) digest.add(p);
#endif
    return digest.value();
}

/// A plate with points at random, its corners, and the motion that they give.
std::uint64_t of_registration() {
    Random random(5);
    Array<Vec3> positions;
    for (int i = 0; i < 5000; ++i)
        positions.emplace_back(random.uniform(0, 20), random.uniform(0, 12), 0.01 * random.normal());
    PointCloud plate;
    plate.frame.name = "scanner";
    plate.positions = std::move(positions);
    Context context;
    PlateCornersParams params;
    params.tolerance = 0.1;
    const PlateCornersResult found = plate_corners(plate, params, context);
    PointCloud target = found.corners;
    target.frame.name = "machine";
    Array<Vec3> measured;
    for (const Vec3& p : found.corners.positions)
        measured.emplace_back(3 - p.y() + 0.01 * random.normal(), p.x() + 0.01 * random.normal(), p.z() + 5);
    target.positions = std::move(measured);
    target.columns = {};
    AlignPart part;
    part.box.add(Vec3(0, 0, 0));
    part.box.add(Vec3(5, 5, 5));
    part.frame = "scanner";
    const AlignResult aligned = align(found.corners, target, part, {}, context);
    Digest digest;
    for (const Vec3& p : found.corners.positions) digest.add(p);
    digest.add(found.residual);
    for (const Vec3& axis : aligned.transform.rotation.colwise()) digest.add(axis);
    digest.add(aligned.transform.translation);
    digest.add(aligned.rms);
    digest.add(*aligned.error_at_part);
    const Value moved =
        apply_transform(Value(std::make_shared<const PointCloud>(found.corners)), aligned.transform, context);
    for (const Vec3& p : moved.get<PointCloud>()->positions) digest.add(p);
    return digest.value();
}

/// Two planes at a right angle, whose vertices are off them by up to a fifth of the edges' length.
TriangleMesh noisy_roof() {
    constexpr u32 size = 40;
    Random random(3);
    TriangleMesh mesh;
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (u32 y = 0; y <= size; ++y)
        for (u32 x = 0; x <= size; ++x) positions.emplace_back(x, y, std::min(x, size - x) + random.uniform(-0.2, 0.2));
    for (u32 y = 0; y < size; ++y)
        for (u32 x = 0; x < size; ++x) {
            const u32 a = y * (size + 1) + x, b = a + 1, c = a + size + 1, d = c + 1;
            triangles.push_back({a, b, d});
            triangles.push_back({a, d, c});
        }
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    return mesh;
}

/// The points have exact coordinates, which do not depend on the processor.
std::string results() {
    std::string text =
        fmt::format("angles {:x}\npatches {:x}\nprobes {:x}\npoisson {:x}\nregistration {:x}\nnoisy features {:x}\n",
                    of_angles(), of_patches(geodesic_sphere(1, 3)), of_probes(l_block(1)), of_poisson(),
                    of_registration(), of_features(noisy_roof()));
    for (const TetMesh& tets : {hull_of(random_cube(2000, 1)), hull_of(lattice_cube(4)),
                                solid_of(tets_of(l_block_surface(3, 2, 6, 2e-3))).tets})
        for (const SculptWeight weight : {SculptWeight::none, SculptWeight::length}) {
            SculptParams params;
            params.weight = weight;
            const SculptResult carved = sculpted(tets, params);
            text += fmt::format("sculpt {:x}, features {:x}, measure {:x}\n", of_sculpted(carved),
                                of_features(carved.mesh), of_measured(carved.mesh, mesh_of(tets, tets.inside.span())));
        }
    return text;
}

/// Runs this test alone in a process of its own; returns what that process wrote.
std::string results_of_second_process() {
    const TemporaryFolder folder;
    const std::string output = (folder / "results").string();
    const pid_t child = ::fork();
    if (child == 0) {
        ::setenv(output_variable, output.c_str(), 1);
        ::setenv("GLIBC_TUNABLES", without_fma, 1);
        ::execl("/proc/self/exe", "filters-tests", "--gtest_filter=Processors.*", "--gtest_brief=1", nullptr);
        ::_exit(127);
    }
    int status = -1;
    ::waitpid(child, &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
    return content_of(output);
}

TEST(Processors, WithAndWithoutFusedMultiplyAdd_GiveTheSameBytes) {
    if (const char* output = std::getenv(output_variable)) {
        std::ofstream(output) << results();
        return;
    }
    EXPECT_EQ(results(), results_of_second_process());
}

}  // namespace
}  // namespace scanmill::test
