// SPDX-License-Identifier: GPL-3.0-or-later
#include "measure/measure.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "measure/borders.hpp"
#include "measure/comparable.hpp"
#include "measure/compensated_sum.hpp"
#include "measure/measurable.hpp"
#include "measure/nearest_distances.hpp"
#include "measure/self_intersections.hpp"
#include "measure/surface_samples.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/mesh.hpp"

namespace scanmill {

namespace {

using namespace measuring;

/// Those in a triangle.
Array<Vec3> surface_vertices(const TriangleMesh& mesh) {
    Array<u8> is_used(mesh.positions.size(), u8(0));
    for (const Triangle& triangle : mesh.triangles)
        for (u32 vertex : triangle) is_used[vertex] = 1;
    Array<Vec3> vertices;
    for (std::size_t i = 0; i < is_used.size(); ++i)
        if (is_used[i]) vertices.push_back(mesh.positions[i]);
    return vertices;
}

double rounding_within(const BoundingBox& one, const BoundingBox& other) {
    double largest = 0;
    for (const BoundingBox& box : {one, other})
        largest = std::max({largest, box.low.cwiseAbs().maxCoeff(), box.high.cwiseAbs().maxCoeff()});
    return rounding_of(largest);
}

/// What one surface's samples and vertices found on the other side.
struct Side {
    SurfaceSamples samples;
    NearestDistances nearest;
    DistanceNumbers numbers;
};

Side measured_side(const TriangleMesh& mesh, const TriangleTree& other, const MeasureParams& params, u64 stream,
                   double rounding, Context& context) {
    Side side;
    side.samples = sample_surface(mesh, params.samples, context.random().stream(stream), context.threads());
    side.nearest = nearest_distances(side.samples.positions, other, rounding, context);
    const Array<Vec3> vertices = surface_vertices(mesh);
    side.numbers = numbers_of(side.nearest.distances, nearest_distances(vertices, other, rounding, context).distances);
    return side;
}

/// Cosines between normals at samples and at what is nearest to them.
struct Cosines {
    CompensatedSum with_sign, without_sign;
    std::size_t pairs = 0, without_normal = 0;

    void add(const TriangleMesh& mesh, const Side& side, const TriangleMesh& other) {
        for (std::size_t i = 0; i < side.samples.triangles.size(); ++i) {
            const Vec3 here = area_vector(mesh, side.samples.triangles[i]);
            const Vec3 there = area_vector(other, side.nearest.triangles[i]);
            const double lengths = here.norm() * there.norm();
            if (!(lengths > 0)) {
                ++without_normal;
                continue;
            }
            const double cosine = std::clamp(here.dot(there) / lengths, -1.0, 1.0);
            with_sign.add(cosine);
            without_sign.add(std::abs(cosine));
            ++pairs;
        }
    }

private:
    static Vec3 area_vector(const TriangleMesh& mesh, u32 row) {
        const auto& [a, b, c] = mesh.triangles[row];
        return (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]);
    }
};

void compare_normals(Measurement& result, const TriangleMesh& mesh, const Side& to, const TriangleMesh& truth,
                     const Side& from) {
    Cosines cosines;
    cosines.add(mesh, to, truth);
    cosines.add(truth, from, mesh);
    result.without_normal = cosines.without_normal;
    if (cosines.pairs == 0) return;
    result.normal_consistency = cosines.with_sign.value() / static_cast<double>(cosines.pairs);
    result.normal_consistency_unsigned = cosines.without_sign.value() / static_cast<double>(cosines.pairs);
}

NearShares shares_at(double threshold, const Side& to, const Side& from) {
    NearShares shares{threshold, share_within(to.nearest.distances, threshold),
                      share_within(from.nearest.distances, threshold), 0.0};
    const double sum = *shares.precision + shares.recall;
    if (sum > 0) shares.f_score = 2 * *shares.precision * shares.recall / sum;
    return shares;
}

void measure_mesh_alone(Measurement& result, const TriangleMesh& mesh, const TriangleTree& tree,
                        const MeasureParams& params, Context& context) {
    result.unit = mesh.frame.unit;
    result.diagonal = surface_box(mesh).diagonal();
    result.mesh = mesh_numbers(mesh, context.threads());
    context.progress(0.6);
    if (params.self_intersections) result.self_intersections = count_self_intersections(mesh, tree, context);
    context.progress(0.8);
}

/// Warns of, or refuses, what sizes and places say of the two frames.
void compare_extents(const TriangleMesh& mesh, const BoundingBox& truth, bool truth_may_be_part,
                     const MeasureParams& params, Context& context) {
    try {
        for (const std::string& warning :
             require_comparable(surface_box(mesh), truth, truth_may_be_part, mesh.frame.unit))
            context.warn(warning);
    } catch (const Error& error) {
        if (!params.same_frame) throw;
        context.warn(fmt::format("{}; measured all the same, as same-frame asks", error.sentence()));
    }
}

}  // namespace

Measurement measure(const TriangleMesh& mesh, const TriangleMesh& given_truth, const MeasureParams& params,
                    Context& context) {
    require_sound(params);
    require_surface(mesh, "mesh");
    require_surface(given_truth, "truth");
    if (params.borders == MeasureParams::Borders::exclude)
        throw Error("borders are excluded for points as truth, and the truth is a mesh of {}",
                    counted(given_truth.triangles.size(), "triangle", "triangles"))
            .hint("say borders: include, or give the scan as truth");
    const std::vector<double> thresholds = thresholds_for(mesh, params);
    TriangleMesh truth = given_truth;
    truth.positions = in_frame_of(mesh.frame, given_truth.frame, given_truth.positions);
    truth.frame = mesh.frame;
    require_squares(surface_box(truth), "truth");
    compare_extents(mesh, surface_box(truth), false, params, context);

    const double rounding = rounding_within(surface_box(mesh), surface_box(truth));
    const TriangleTree mesh_tree(mesh.positions.span(), mesh.triangles.span(), context.threads());
    const TriangleTree truth_tree(truth.positions.span(), truth.triangles.span(), context.threads());
    context.progress(0.1);
    const Side to = measured_side(mesh, truth_tree, params, 0, rounding, context);
    context.progress(0.3);
    const Side from = measured_side(truth, mesh_tree, params, 1, rounding, context);
    context.progress(0.5);

    Measurement result;
    result.to_truth = to.numbers;
    result.from_truth = from.numbers;
    result.both = numbers_of_both(to.numbers, to.nearest.distances, from.numbers, from.nearest.distances);
    result.hausdorff = result.both.max;
    result.chamfer = (to.numbers.mean + from.numbers.mean) / 2;
    for (const double threshold : thresholds) result.near.push_back(shares_at(threshold, to, from));
    compare_normals(result, mesh, to, truth, from);
    result.truth = mesh_numbers(truth, context.threads());
    measure_mesh_alone(result, mesh, mesh_tree, params, context);
    if (params.certify)
        result.certified = certified_hausdorff({mesh.positions.span(), mesh.triangles.span(), mesh_tree},
                                               {truth.positions.span(), truth.triangles.span(), truth_tree},
                                               {params.gap.value(), params.most_cuts}, context);
    context.progress(1);
    return result;
}

Measurement measure(const TriangleMesh& mesh, const PointCloud& truth, const MeasureParams& params, Context& context) {
    require_sound(params);
    require_surface(mesh, "mesh");
    const std::vector<double> thresholds = thresholds_for(mesh, params);
    if (truth.size() == 0)
        throw Error("the truth has no points; there is nothing to measure the mesh against")
            .hint("`scanmill info` tells what a file holds");
    require_finite(truth.positions.span(), "points of the truth");
    if (params.certify)
        throw Error("the Hausdorff distance of surfaces is certified, and the truth is {}",
                    counted(truth.size(), "point", "points"))
            .hint("leave certify out, or give a mesh as truth");
    const Buffer<Vec3> points = in_frame_of(mesh.frame, truth.frame, truth.positions);
    const BoundingBox box = bounding_box(points.span());
    compare_extents(mesh, box, true, params, context);

    const double rounding = rounding_within(surface_box(mesh), box);
    const TriangleTree mesh_tree(mesh.positions.span(), mesh.triangles.span(), context.threads());
    context.progress(0.1);
    NearestDistances from = nearest_distances(points.span(), mesh_tree, rounding, context);
    Measurement result;
    if (params.borders == MeasureParams::Borders::exclude)
        result.beyond_borders = leave_out_borders(from, points.span(), mesh, rounding);
    context.progress(0.3);
    const Side to = measured_side(mesh, tree_of_points(points.span(), context.threads()), params, 0, rounding, context);
    context.progress(0.5);

    result.to_points = to.numbers;
    result.from_truth = numbers_of(from.distances, {});
    result.from_truth.mean_spread.reset();
    result.both = result.from_truth;
    for (const double threshold : thresholds)
        result.near.push_back({threshold, {}, share_within(from.distances, threshold), {}});
    measure_mesh_alone(result, mesh, mesh_tree, params, context);
    context.progress(1);
    return result;
}

}  // namespace scanmill
