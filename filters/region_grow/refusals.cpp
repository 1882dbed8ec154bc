// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/refusals.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "region_grow/search_radii.hpp"
#include "scanmill/base/error.hpp"

namespace scanmill::growing {

namespace {

constexpr const char* few_points_hint =
    "look at the file with `scanmill info`; thin less coarsely if the scan was thinned";

}  // namespace

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

void require_area(const Samples& samples, std::size_t points) {
    if (points == 0) throw Error("needs at least 3 distinct points; the cloud has none").hint(few_points_hint);
    if (samples.size() < 3)
        throw Error("needs at least 3 distinct points; the cloud has {} in {} rows", samples.size(), points)
            .hint(few_points_hint);
    // The place farthest from the first, and the one farthest from the line through both.
    const auto& p = samples.positions;
    const auto farthest = [&](const auto& distance) { return *std::ranges::max_element(p, {}, distance); };
    const Vec3 end = farthest([&](const Vec3& x) { return (x - p[0]).squaredNorm(); });
    const Vec3 along = (end - p[0]).normalized();
    const auto off_line = [&](const Vec3& x) { return (x - p[0]).cross(along).norm(); };
    const double off = off_line(farthest(off_line));
    if (off <= 1e-9 * (end - p[0]).norm())
        throw Error("all {} distinct points lie on one line, to within {:.2g} u; a surface needs some off it",
                    samples.size(), off)
            .hint("scan more than a single profile, or check that the columns x, y and z are read as such");
}

void refuse_start(u32 row) {
    throw Error("no triangle can start at row {}: no two other points near it make one within the limits", row)
        .hint("start at another point, on a flat and evenly sampled part, or leave start to `auto`");
}

void refuse_all(const Surface& surface, const RegionGrowParams& params, LengthUnit unit, unsigned threads) {
    const Samples& samples = surface.samples;
    const std::string radius = params.search_radius ? fmt::format("search-radius {} u", params.search_radius->value())
                                                    : std::string("the automatic search-radius");
    throw Error("no three of the {} distinct points make a triangle with angles of at least {} and {}", samples.size(),
                params.min_angle.text(), radius)
        .hint(fmt::format("enlarge search-radius, or lessen min-angle; points in layers, thin with bins of {:.3g} {}",
                          2 * bins_as_dense(surface, threads), symbol(unit)));
}

}  // namespace scanmill::growing
