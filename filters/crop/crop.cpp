// SPDX-License-Identifier: GPL-3.0-or-later
#include "crop/crop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/filter/inputs.hpp"
#include "scanmill/geometry/spatial/direction.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill {

namespace {

constexpr std::string_view need = "cropping needs at least 1";

std::string text_of(const Vec3& position) {
    return fmt::format("({:.9g}, {:.9g}, {:.9g})", position.x(), position.y(), position.z());
}

// Regions. contains() and squared_distance() take positions relative to the frame's origin. `hint` begins as
// NearestTriangle::none and is kept from call to call.

struct BoxRegion {
    BoundingBox box;
    Vec3 origin;
    std::string name;

    bool contains(const Vec3& position, u32&) const {
        const Vec3 world = origin + position;
        return (world.array() >= box.low.array()).all() && (world.array() <= box.high.array()).all();
    }
    double squared_distance(const Vec3& position, double, u32&) const {
        const Vec3 world = origin + position;
        return (world - world.cwiseMax(box.low).cwiseMin(box.high)).squaredNorm();
    }
};

struct BallRegion {
    Vec3 centre, origin;
    double radius;
    std::string name;

    bool contains(const Vec3& position, u32&) const {
        return (origin + position - centre).squaredNorm() <= radius * radius;
    }
    /// Squared distance from the centre.
    double squared_distance(const Vec3& position, double, u32&) const {
        return (origin + position - centre).squaredNorm();
    }
};

struct NearRegion {
    const TriangleTree& tree;
    double within;
    std::string name;

    bool contains(const Vec3& position, u32& hint) const { return tree.is_within(position, within * within, hint); }
    /// Squared distance from the nearest point; infinite if it is larger than `limit`.
    double squared_distance(const Vec3& position, double limit, u32& hint) const {
        if (!tree.is_within(position, limit, hint)) return std::numeric_limits<double>::infinity();
        return tree.nearest(position, hint).squared_distance;
    }
};

// Points in memory and points of a file, in chunks.

struct Chunks {
    /// First row of every chunk, and the number of points as last element.
    std::vector<std::size_t> begin;
    /// Returns the positions of a chunk; may store them in `buffer`. Is called from several threads.
    std::function<std::span<const Vec3>(std::size_t chunk, Array<Vec3>& buffer)> read;
    std::function<PointCloud(std::span<const u32> rows)> gather;
    Frame frame;

    std::size_t count() const { return begin.size() - 1; }
    std::size_t points() const { return begin.back(); }
};

/// Number of points in a chunk of a cloud in memory.
constexpr std::size_t chunk_size = std::size_t(1) << 14;

Chunks chunks_of(const PointCloud& cloud) {
    Chunks chunks;
    for (std::size_t row = 0; row < cloud.size(); row += chunk_size) chunks.begin.push_back(row);
    chunks.begin.push_back(cloud.size());
    chunks.read = [positions = cloud.positions.span()](std::size_t chunk, Array<Vec3>&) {
        return positions.subspan(chunk * chunk_size, std::min(chunk_size, positions.size() - chunk * chunk_size));
    };
    chunks.gather = [&cloud](std::span<const u32> rows) { return gather(cloud, rows); };
    chunks.frame = cloud.frame;
    return chunks;
}

Chunks chunks_of(const PointStream& scan, unsigned threads) {
    return {scan.pieces(),
            [&scan](std::size_t chunk, Array<Vec3>& buffer) -> std::span<const Vec3> {
                scan.read(chunk, buffer);
                return buffer;
            },
            [&scan, threads](std::span<const u32> rows) { return scan.gather(rows, threads); }, scan.frame()};
}

/// Throws Error for a region without points, with the box of the cloud and the distance of the nearest point.
template <class Region>
[[noreturn]] void throw_empty(const Chunks& chunks, const Region& region, Context& context) {
    BoundingBox box;
    Array<Vec3> buffer;
    double least = std::numeric_limits<double>::infinity();
    u32 hint = NearestTriangle::none;
    for (std::size_t chunk = 0; chunk < chunks.count(); ++chunk) {
        context.check_cancelled();
        for (const Vec3& position : chunks.read(chunk, buffer)) {
            box.add(chunks.frame.origin + position);
            least = std::min(least, region.squared_distance(position, least, hint));
        }
    }
    throw Error("none of {} lies {}; the nearest is at a distance of {:.4g} {}, and the box of all points is {} to {}",
                count_text(chunks.points(), "point", "points"), region.name, std::sqrt(least),
                symbol(chunks.frame.unit), text_of(box.low), text_of(box.high))
        .hint("choose a region that meets this box, in the coordinates of the file");
}

template <class Region>
CropResult crop_to(const Chunks& chunks, const Region& region, Context& context) {
    std::vector<Array<u32>> parts(chunks.count());
    std::atomic<std::size_t> done = 0;
    for_each_chunk(context.threads(), chunks.count(), 1, [&](std::size_t chunk, std::size_t) {
        context.check_cancelled();
        Array<Vec3> buffer;
        auto row = static_cast<u32>(chunks.begin[chunk]);
        u32 hint = NearestTriangle::none;
        for (const Vec3& position : chunks.read(chunk, buffer)) {
            if (region.contains(position, hint)) parts[chunk].push_back(row);
            ++row;
        }
        context.progress(0.9 * static_cast<double>(++done) / static_cast<double>(chunks.count()));
    });
    CropResult result;
    for (Array<u32>& part : parts) {
        result.kept.insert(result.kept.end(), part.begin(), part.end());
        part = {};
    }
    if (result.kept.empty()) throw_empty(chunks, region, context);
    result.points = chunks.gather(result.kept);
    result.removed = chunks.points() - result.kept.size();
    context.metric("kept", static_cast<double>(result.kept.size()));
    context.metric("removed", static_cast<double>(result.removed));
    context.progress(1);
    return result;
}

// Refusals.

void require_distance(const std::optional<Length>& length, std::string_view what) {
    if (length && !(length->value() >= 0 && std::isfinite(length->value())))
        throw Error("{} is {} u; it must be 0 or more", what, length->value()).hint("give a length of 0 or more");
}

BoundingBox box_of(std::span<const Length> lengths) {
    if (lengths.size() != 6)
        throw Error("`box` has {}; it needs 6", count_text(lengths.size(), "length", "lengths"))
            .hint("give x, y, z of the low corner, then of the high corner");
    const BoundingBox box{position_of(lengths.first(3), "`box`"), position_of(lengths.last(3), "`box`")};
    for (int axis = 0; axis < 3; ++axis)
        if (box.low[axis] > box.high[axis])
            throw Error("the box's low corner is above its high corner along {}: {:.9g} and {:.9g} u", "xyz"[axis],
                        box.low[axis], box.high[axis])
                .hint("give x, y, z of the low corner first, then those of the high corner");
    return box;
}

/// Throws Error unless exactly one region is given, complete and with valid numbers.
void require_one_region(const CropParams& params) {
    std::vector<std::string> given;
    if (params.box) given.push_back("`box`");
    if (params.centre || params.radius) given.push_back("`centre` with `radius`");
    if (params.within) given.push_back("`within`");
    if (given.empty())
        throw Error("no region is given; 1 of 3 is needed")
            .hint("give `box`, `centre` with `radius`, or `within` with a value at `near`");
    if (given.size() > 1)
        throw Error("{} regions are given, {}; only 1 is possible", given.size(), enumerated(given))
            .hint("for the points that lie in all of them, write one step per region");
    if (params.centre && !params.radius)
        throw Error("`centre` is given without `radius`; a ball needs both").hint("add `radius`, or give a `box`");
    if (params.radius && !params.centre)
        throw Error("`radius` is given without `centre`; a ball needs both")
            .hint("add `centre`, three lengths, or give `within` with a value at `near`");
    require_distance(params.radius, "`radius`");
    require_distance(params.within, "`within`");
}

CropResult crop_alone(const Chunks& chunks, const CropParams& params, Context& context) {
    const Vec3& origin = chunks.frame.origin;
    const std::string_view unit = symbol(chunks.frame.unit);
    if (params.box) {
        const BoundingBox box = box_of(*params.box);
        const BoxRegion region{box, origin,
                               fmt::format("in the box from {} to {} {}", text_of(box.low), text_of(box.high), unit)};
        return crop_to(chunks, region, context);
    }
    if (params.within)
        throw Error("`within` is {} u, but no points and no mesh are wired to `near`; it needs 1 of them",
                    params.within->value())
            .hint("write `in: {points: …, near: …}`, or give a `box` or a `centre` with `radius`");
    const Vec3 centre = position_of(*params.centre, "`centre`");
    const double radius = params.radius->value();
    const BallRegion region{centre, origin, radius,
                            fmt::format("within {:.9g} {} of {}", radius, unit, text_of(centre))};
    return crop_to(chunks, region, context);
}

/// The positions of `near` in the frame of the cloud.
Buffer<Vec3> positions_beside(const PointCloud& cloud, const Frame& near, const Buffer<Vec3>& positions) {
    if (near.unit != cloud.frame.unit)
        throw Error("the {} points are in {}, and the {} points or vertices at `near` in {}; both need one unit",
                    cloud.size(), symbol(cloud.frame.unit), positions.size(), symbol(near.unit))
            .hint("convert one of them (the unit u means that no unit is declared)");
    return translated(positions, near.origin - cloud.frame.origin);
}

/// Throws Error for everything that is refused before a tree is built.
void require_near(const PointCloud& cloud, std::span<const Vec3> near, std::string_view what,
                  const CropParams& params) {
    require_one_region(params);
    require_points(cloud.size(), need);
    if (!params.within)
        throw Error("{} {} are wired to `near`, but `within` is not given", near.size(), what)
            .hint("give `within`, or remove `near` from `in`");
    require_finite(cloud.positions.span());
    require_finite(near, what);
}

CropResult crop_near(const PointCloud& cloud, const TriangleTree& tree, const CropParams& params, std::string_view what,
                     Context& context) {
    const double within = params.within->value();
    const NearRegion region{
        tree, within,
        fmt::format("within {:.9g} {} of the {} {} at `near`", within, symbol(cloud.frame.unit), tree.size(), what)};
    return crop_to(chunks_of(cloud), region, context);
}

}  // namespace

CropResult crop(const PointCloud& cloud, const CropParams& params, Context& context) {
    require_one_region(params);
    require_points(cloud, need);
    return crop_alone(chunks_of(cloud), params, context);
}

CropResult crop(const PointStream& scan, const CropParams& params, Context& context) {
    require_one_region(params);
    require_points(scan.size(), need);
    return crop_alone(chunks_of(scan, context.threads()), params, context);
}

CropResult crop(const PointCloud& cloud, const PointCloud& near, const CropParams& params, Context& context) {
    require_near(cloud, near.positions.span(), "points", params);
    if (near.size() == 0)
        throw Error("the cloud at `near` has 0 points; a distance needs at least 1")
            .hint("wire another value to `near`");
    const Buffer<Vec3> positions = positions_beside(cloud, near.frame, near.positions);
    return crop_near(cloud, tree_of_points(positions.span(), context.threads()), params, "points", context);
}

CropResult crop(const PointCloud& cloud, const TriangleMesh& near, const CropParams& params, Context& context) {
    require_near(cloud, near.positions.span(), "vertices", params);
    if (near.triangles.size() == 0)
        throw Error("the mesh at `near` has {} and 0 triangles; a distance needs at least 1",
                    count_text(near.positions.size(), "vertex", "vertices"))
            .hint("wire its vertices to `near` as points");
    const Buffer<Vec3> positions = positions_beside(cloud, near.frame, near.positions);
    const TriangleTree tree(positions.span(), near.triangles.span(), context.threads());
    return crop_near(cloud, tree, params, "triangles", context);
}

}  // namespace scanmill
