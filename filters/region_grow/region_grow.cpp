// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/region_grow.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "region_grow/far_sides.hpp"
#include "region_grow/finished_mesh.hpp"
#include "region_grow/given_normals.hpp"
#include "region_grow/narrow_holes.hpp"
#include "region_grow/normal_signs.hpp"
#include "region_grow/pieces.hpp"
#include "region_grow/pinches.hpp"
#include "region_grow/refusals.hpp"
#include "region_grow/report.hpp"
#include "region_grow/search_radii.hpp"
#include "region_grow/seeds.hpp"
#include "region_grow/small_holes.hpp"
#include "region_grow/thin_parts.hpp"
#include "region_grow/thinned_bins.hpp"
#include "scanmill/data/frame.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/geometry/mesh/feature_lines.hpp"

namespace scanmill {

namespace {

using namespace growing;

/// The given limits and those that parked edges are retried under.
std::vector<Limits> limits_of(const RegionGrowParams& params) {
    struct Round {
        double angle, bend, point, rough, reach;
    };
    // Angles shrink and bends grow by these factors. The limits to the points' own normals keep sheets apart and
    // ends open.
    constexpr std::array<Round, 4> rounds{{{1, 1, 60, 85, 1},
                                           {2.0 / 3, 7.0 / 6, 75, 110, 1.1},
                                           {1.0 / 3, 4.0 / 3, 80, 180, 1.15},
                                           {1.0 / 30, 4.0 / 3, 80, 180, 1.15}}};
    constexpr double degree = 3.14159265358979323846 / 180;
    std::vector<Limits> limits;
    const auto bend_cosine = [&](const Round& round) {
        return std::cos(std::min(180 * degree, params.max_normal_angle.in_radians() * round.bend)) - 1e-9;
    };
    for (const Round& round : rounds) {
        limits.push_back({std::sin(params.min_angle.in_radians() * round.angle) * (1 - 1e-12), bend_cosine(round),
                          bend_cosine(rounds.back()), std::cos(round.point * degree), std::cos(round.rough * degree),
                          round.reach, static_cast<Pass>(limits.size())});
    }
    return limits;
}

/// Of what closes narrow holes, in radians. From 90 degrees on no patch is meant to end at a sharp edge, and a tip is
/// closed whatever its angle; below, surfaces end at what growth would not bend over in its last round.
double largest_bend(const RegionGrowParams& params) {
    const double angle = params.max_normal_angle.in_radians();
    constexpr double right_angle = std::numbers::pi / 2;
    return angle >= right_angle * (1 - 1e-12) ? 2 * right_angle : angle * 4 / 3;
}

SearchRadii search_radii(const PointCloud& cloud, const Samples& samples, const Neighbourhoods& neighbourhoods,
                         const PointNormals& normals, const RegionGrowParams& params, Context& context) {
    const Array<double> thinned = params.search_radius ? Array<double>() : thinned_bins(cloud, samples, context);
    SearchRadii found =
        automatic_radii(samples, neighbourhoods, normals.directions, normals.roughness, thinned, context.threads());
    if (params.search_radius) {
        std::ranges::fill(found.radii, params.search_radius->value());
        return found;
    }
    tell_contradiction(thinned, found, cloud.frame.unit, context);
    context.metric("known-bins", static_cast<double>(found.known));
    return found;
}

std::optional<u32> place_of(const Samples& samples, const PointCloud& cloud, std::optional<u32> row) {
    if (!row) return std::nullopt;
    return static_cast<u32>(std::ranges::find(samples.positions, cloud.positions[*row]) - samples.positions.begin());
}

}  // namespace

RegionGrowResult region_grow(const PointCloud& cloud, const RegionGrowParams& params, Context& context) {
    require_finite(cloud.positions.span());
    require_in_range(params, cloud.size());
    const Samples samples = distinct_samples(cloud.positions.span());
    require_area(samples, cloud.size());
    context.progress(0.05);
    context.check_cancelled();
    const Neighbourhoods neighbourhoods(samples, context.threads());
    context.check_cancelled();
    context.progress(0.3);
    PointNormals normals = principal_normals(samples, neighbourhoods, context.threads());
    const GivenNormals given = take_given_normals(cloud, samples, neighbourhoods, normals, context);
    const bool oriented = given.signs_count;
    SearchRadii radii = search_radii(cloud, samples, neighbourhoods, normals, params, context);
    Surface surface(samples, neighbourhoods, std::move(normals), std::move(radii.radii), std::move(radii.by_density),
                    oriented);
    context.progress(0.4);

    const std::vector<Limits> limits = limits_of(params);
    const Score score = params.score == RegionGrowParams::Score::midpoint ? Score::midpoint : Score::circumradius;
    Growth growth(surface, score, limits, context);
    Array<u32> groups;
    if (!grow_all_pieces(surface, growth, place_of(samples, cloud, params.start), groups)) refuse_start(*params.start);
    if (surface.triangles.empty()) refuse_all(surface, params, cloud.frame.unit, context.threads());
    context.progress(0.9);

    RegionGrowResult result;
    if (params.close_holes >= 3) {
        result.closed_holes = close_small_holes(surface, params.close_holes, context);
        result.removed_triangles = remove_pinches(surface);
        // What was removed may have left a small hole; at single fans closing makes no new pinch.
        const NarrowHoles narrow = close_narrow_holes(
            surface, {largest_circle * limits.back().reach, params.close_holes, largest_bend(params)}, context);
        result.closed_holes += narrow.closed;
        result.removed_triangles += narrow.replaced;
    } else
        result.removed_triangles = remove_pinches(surface);
    PointChooser chooser(surface, score);
    const std::vector<PatchEdge> patch_edges = find_patch_edges(surface, chooser, limits.front(), context);
    context.check_cancelled();
    const Pieces pieces = find_pieces(surface);
    if (!oriented) face_outwards(surface, pieces, groups);
    if (!given.doubtful.empty()) face_as_given(surface, pieces, given.doubtful);

    FinishedMesh finished = finish_mesh(cloud, surface, patch_edges, params.sharp_angle);
    FeatureParams feature_params;
    feature_params.sharp_angle = params.sharp_angle;
    FeatureLines lines = find_features(finished.mesh, feature_params, context.threads());
    tell_far_sides(lines.graph, finished, samples, patch_edges);
    result.mesh = std::move(finished.mesh);
    result.rows = std::move(finished.rows);
    result.passes = std::move(surface.passes);
    result.features = std::move(lines.graph);
    result.loops = lines.counts.holes + lines.counts.boundaries;
    result.holes = lines.counts.holes;
    const ThinParts thin = params.search_radius ? ThinParts() : find_thin_parts(surface, pieces, context);
    result.thin_loops = thin.loops;
    result.creases = lines.counts.creases;
    result.corners = lines.counts.corners;
    result.ambiguous_loops = lines.counts.ambiguous;
    result.triangles_without_area = lines.counts.without_area;
    result.patch_edges = patch_edges.size();
    result.components = pieces.count;
    result.duplicates = samples.repeats.size();
    result.unused_points = samples.size() - result.rows.size();
    report(result, lines.counts, surface, thin, context);
    context.progress(1);
    return result;
}

}  // namespace scanmill
