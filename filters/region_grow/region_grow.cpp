// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/region_grow.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "region_grow/far_sides.hpp"
#include "region_grow/finished_mesh.hpp"
#include "region_grow/given_normals.hpp"
#include "region_grow/pieces.hpp"
#include "region_grow/pinches.hpp"
#include "region_grow/search_radii.hpp"
#include "region_grow/seeds.hpp"
#include "region_grow/small_holes.hpp"
#include "region_grow/thinned_bins.hpp"
#include "scanmill/data/frame.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/filter/error.hpp"
#include "scanmill/geometry/feature_lines.hpp"

namespace scanmill {

namespace {

using namespace growing;

constexpr const char* few_points_hint =
    "look at the file with `scanmill info`; thin less coarsely if the scan was thinned";

void require_in_range(const RegionGrowParams& params, std::size_t points) {
    const double least = params.min_angle.in_degrees(), bend = params.max_normal_angle.in_degrees();
    if (!(least >= 0 && least < 60))
        throw Error("min-angle is {} degrees; it must be at least 0 and below 60, what no triangle exceeds", least);
    if (!(bend > 0 && bend <= 180))
        throw Error("max-normal-angle is {} degrees; it must be above 0 and at most 180", bend);
    if (params.search_radius) {
        const double radius = params.search_radius->value();
        if (!(radius > 0 && std::isfinite(radius))) throw Error("search-radius is {}; it must be above 0", radius);
    }
    if (params.close_holes > 100) throw Error("close-holes is {}; at most 100 edges are closed", params.close_holes);
    if (params.start && *params.start >= points)
        throw Error("start is row {}; the cloud has {} points, counted from 0", *params.start, points);
}

void require_size(const PointCloud& cloud) {
    const double size = bounding_box(cloud.positions.span()).diagonal();
    if (size == 0 || (size > 1e-100 && size < 1e100)) return;
    const std::string actual =
        std::isfinite(size) ? fmt::format("{:.3g} {}", size, symbol(cloud.frame.unit)) : std::string("beyond 1.7e308");
    throw Error("needs a scan between 1e-100 and 1e100 in size, so that squares of lengths are numbers; it is {}",
                actual)
        .hint("remove stray points, or check that the columns x, y and z are read as such; scale the scan if they are");
}

/// Three places off one line, by the two farthest from the first and from the line.
void require_area(const Samples& samples, std::size_t points) {
    if (samples.size() < 3)
        throw Error("needs at least 3 distinct points; the cloud has {} in {} rows", samples.size(), points)
            .hint(few_points_hint);
    const auto& p = samples.positions;
    const auto farthest = [&](const auto& distance) { return *std::ranges::max_element(p, {}, distance); };
    const Vec3 end = farthest([&](const Vec3& x) { return (x - p[0]).squaredNorm(); });
    const Vec3 along = (end - p[0]).normalized();
    const auto off_line = [&](const Vec3& x) { return (x - p[0]).cross(along).norm(); };
    const double off = off_line(farthest(off_line));
    if (off <= 1e-9 * (end - p[0]).norm())
        throw Error("all {} distinct points lie on one line, to within {:.2g} u; a surface needs some off it",
                    samples.size(), off / samples.scale)
            .hint("scan more than a single profile, or check that the columns x, y and z are read as such");
}

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

Array<double> search_radii(const PointCloud& cloud, const Samples& samples, const Neighbourhoods& neighbourhoods,
                           const Array<Vec3>& normals, const RegionGrowParams& params, Context& context) {
    if (params.search_radius) {
        Array<double> radii(samples.size());
        std::ranges::fill(radii, params.search_radius->value() * samples.scale);
        return radii;
    }
    const Array<double> thinned = thinned_bins(cloud, samples, context);
    SearchRadii found = automatic_radii(samples, neighbourhoods, normals, thinned, context.threads());
    tell_contradiction(samples, thinned, found, context);
    context.metric("known-bins", static_cast<double>(found.known));
    return std::move(found.radii);
}

std::optional<u32> place_of(const Samples& samples, const PointCloud& cloud, std::optional<u32> row) {
    if (!row) return std::nullopt;
    const Vec3 wanted = cloud.positions[*row] * samples.scale;
    return static_cast<u32>(std::ranges::find(samples.positions, wanted) - samples.positions.begin());
}

[[noreturn]] void refuse_start(u32 row) {
    throw Error("no triangle can start at row {}: no two other points near it make one within the limits", row)
        .hint("start at another point, on a flat and evenly sampled part, or leave start to `auto`");
}

[[noreturn]] void refuse_all(const Samples& samples, const RegionGrowParams& params) {
    const std::string radius = params.search_radius ? fmt::format("search-radius {} u", params.search_radius->value())
                                                    : std::string("the automatic search-radius");
    throw Error("no three of the {} distinct points make a triangle with angles of at least {} and {}", samples.size(),
                params.min_angle.text(), radius)
        .hint("enlarge search-radius, or lessen min-angle");
}

void report(const RegionGrowResult& result, std::size_t places, Context& context) {
    const auto count = [&](std::string_view name, std::size_t value) {
        context.metric(name, static_cast<double>(value));
    };
    count("triangles", result.mesh.triangles.size());
    count("components", result.components);
    count("loops", result.loops);
    count("holes", result.holes);
    count("unused-points", result.unused_points);
    count("duplicates", result.duplicates);
    count("patch-edges", result.patch_edges);
    count("creases", result.creases);
    count("corners", result.corners);
    count("closed-holes", result.closed_holes);
    count("removed-triangles", result.removed_triangles);
    count("ambiguous", result.ambiguous_loops);
    count("without-area", result.triangles_without_area);
    count("relaxed-triangles", static_cast<std::size_t>(std::ranges::count_if(
                                   result.passes, [](u8 pass) { return pass > 0 && pass < closing_pass; })));
    if (200 * result.unused_points > places)
        context.warn(
            fmt::format("{} of {} distinct points are in no triangle; thin the scan, or remove its noise first",
                        result.unused_points, places));
    if (result.ambiguous_loops > 0)
        context.warn(
            fmt::format("{} of {} boundary loops have no area that tells outer boundaries from holes: the longest of a "
                        "piece was taken for its outer boundary",
                        result.ambiguous_loops, result.loops));
    if (result.triangles_without_area > 0)
        context.warn(fmt::format("{} of {} triangles are without area: counted to a neighbour's plane",
                                 result.triangles_without_area, result.mesh.triangles.size()));
}

}  // namespace

RegionGrowResult region_grow(const PointCloud& cloud, const RegionGrowParams& params, Context& context) {
    require_finite(cloud.positions.span());
    require_in_range(params, cloud.size());
    if (cloud.size() == 0) throw Error("needs at least 3 distinct points; the cloud has none").hint(few_points_hint);
    require_size(cloud);
    const Samples samples = distinct_samples(cloud.positions.span());
    require_area(samples, cloud.size());
    context.progress(0.05);
    const Neighbourhoods neighbourhoods(samples, context.threads());
    context.check_cancelled();
    context.progress(0.3);
    PointNormals normals = principal_normals(samples, neighbourhoods, context.threads());
    const bool oriented = take_given_normals(cloud, samples, neighbourhoods, normals, context);
    Array<double> radii = search_radii(cloud, samples, neighbourhoods, normals.directions, params, context);
    Surface surface(samples, neighbourhoods, std::move(normals), std::move(radii), oriented);
    context.progress(0.4);

    const std::vector<Limits> limits = limits_of(params);
    const Score score = params.score == RegionGrowParams::Score::midpoint ? Score::midpoint : Score::circumradius;
    Growth growth(surface, score, limits, context);
    Array<u32> groups;
    if (!grow_all_pieces(surface, growth, place_of(samples, cloud, params.start), groups)) refuse_start(*params.start);
    if (surface.triangles.empty()) refuse_all(samples, params);
    context.progress(0.9);

    RegionGrowResult result;
    result.closed_holes = close_small_holes(surface, params.close_holes);
    result.removed_triangles = remove_pinches(surface);
    // What was removed may have left a small hole; at single fans closing makes no new pinch.
    result.closed_holes += close_small_holes(surface, params.close_holes);
    PointChooser chooser(surface, score);
    const std::vector<PatchEdge> patch_edges = find_patch_edges(surface, chooser, limits.front());
    const Pieces pieces = find_pieces(surface);
    if (!oriented) face_outwards(surface, pieces, groups);

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
    result.creases = lines.counts.creases;
    result.corners = lines.counts.corners;
    result.ambiguous_loops = lines.counts.ambiguous;
    result.triangles_without_area = lines.counts.without_area;
    result.patch_edges = patch_edges.size();
    result.components = pieces.count;
    result.duplicates = samples.duplicates;
    result.unused_points = samples.size() - result.rows.size();
    report(result, samples.size(), context);
    context.progress(1);
    return result;
}

}  // namespace scanmill
