// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "merge/merge_steps.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/bounds.hpp"
#include "scanmill/data/point_tree.hpp"
#include "scanmill/data/spacing.hpp"
#include "scanmill/geometry/fit/covariance.hpp"

namespace scanmill::merging {

namespace {

/// Limits of the cost: views, points of each, and searches in all pairs.
constexpr std::size_t most_views = 64, most_points = 10'000, most_searches = 200'000;
constexpr std::size_t least_samples = 100, most_samples = 4'000;
constexpr std::size_t patch_size = 25;
/// A patch is flat and round, and surrounds its centre: see Scatter. The centroid of a half disc is 0.42 radii from the
/// middle of its straight border.
constexpr double most_variation = 0.03, least_flatness = 0.1, most_off_centre = 0.25;
constexpr double most_distance = 2;  // between surfaces that meet, in spacings
constexpr double cosine_20_degrees = 0.93969262078590838;
constexpr std::size_t least_crossings = 30;  // of a view: fewer prove nothing
constexpr std::size_t most_named_pairs = 3;

/// Sampled points of one view where another view is near. Both have a flat patch around the point there; the patches
/// are parallel to 20 degrees, or they cross.
struct Meetings {
    std::size_t parallel = 0, crossing = 0;

    void add(const Meetings& other) {
        parallel += other.parallel;
        crossing += other.crossing;
    }
};

/// A sample of a cloud: a tree over it, and the normals of some of its points; none where the patch around the point
/// is not flat or does not surround it.
struct View {
    u32 number;
    PointTree tree;
    double spacing;
    BoundingBox box;
    std::vector<std::pair<Vec3, Vec3>> patches;  // centre and normal
};

std::optional<Vec3> normal_about(const Vec3& centre, std::span<const Neighbour> neighbours, const PointTree& tree) {
    if (neighbours.size() < patch_size) return std::nullopt;
    std::array<Vec3, patch_size> points;
    for (std::size_t i = 0; i < patch_size; ++i) points[i] = tree.positions()[neighbours[i].index] - centre;
    const Scatter scatter = scatter_of(points);
    const Vec3 off_centre = scatter.centroid - scatter.normal.dot(scatter.centroid) * scatter.normal;
    const bool is_usable =
        scatter.surface_variation <= most_variation && scatter.flatness >= least_flatness &&
        off_centre.squaredNorm() <= most_off_centre * most_off_centre * neighbours[patch_size - 1].squared;
    return is_usable ? std::optional(scatter.normal) : std::nullopt;
}

View view_of(u32 number, std::span<const Vec3> positions, std::size_t samples) {
    Random random(number);
    std::vector<Vec3> some;
    if (positions.size() > most_points) {
        for (std::size_t i = 0; i < most_points; ++i) some.push_back(positions[random.index(positions.size())]);
        positions = some;
    }
    const PointTree tree(positions);
    const std::span<const Vec3> distinct = tree.positions();
    View view{number, tree, point_spacing(distinct), bounding_box(distinct), {}};
    NeighbourBuffer buffer;
    for (std::size_t i = 0; i < std::min(samples, distinct.size()); ++i) {
        const auto index = static_cast<u32>(samples < distinct.size() ? random.index(distinct.size()) : i);
        const Vec3 centre = distinct[index];
        if (const auto normal = normal_about(centre, view.tree.nearest(index, patch_size, buffer), view.tree))
            view.patches.emplace_back(centre, *normal);
    }
    return view;
}

Meetings meetings(const View& view, const View& other) {
    Meetings result;
    const double reach = most_distance * std::max(view.spacing, other.spacing);
    NeighbourBuffer buffer;
    for (const auto& [centre, normal] : view.patches) {
        if (((centre - other.box.low).array() < -reach).any() || ((centre - other.box.high).array() > reach).any())
            continue;
        if (other.tree.nearest_to(centre, 1, buffer)[0].squared > reach * reach) continue;
        const auto there = normal_about(centre, other.tree.nearest_to(centre, patch_size, buffer), other.tree);
        if (!there) continue;
        ++(std::abs(normal.dot(*there)) >= cosine_20_degrees ? result.parallel : result.crossing);
    }
    return result;
}

}  // namespace

std::string frames_doubt(std::span<const Vec3> positions, std::span<const u32> source, Context& context) {
    std::vector<std::span<const Vec3>> clouds;
    std::vector<u32> numbers;  // of the inputs
    for (std::size_t begin = 0, end; begin < positions.size(); begin = end) {
        end = static_cast<std::size_t>(std::ranges::upper_bound(source, source[begin]) - source.begin());
        clouds.push_back(positions.subspan(begin, end - begin));
        numbers.push_back(source[begin]);
    }
    const std::size_t count = std::min(clouds.size(), most_views);
    if (count < 2) return {};
    const std::size_t samples = std::clamp(most_searches / (count * (count - 1)), least_samples, most_samples);
    std::vector<View> views;
    for (std::size_t i = 0; i < count; ++i) {
        context.check_cancelled();
        const std::size_t cloud = i * clouds.size() / count;
        views.push_back(view_of(numbers[cloud], clouds[cloud], samples));
    }

    struct Pair {
        std::size_t first, second;
        Meetings meetings;
    };
    std::vector<Pair> pairs;
    std::vector<Meetings> of_view(count);
    for (std::size_t i = 0; i < count; ++i) {
        context.check_cancelled();
        for (std::size_t j = i + 1; j < count; ++j) {
            Meetings both = meetings(views[i], views[j]);
            both.add(meetings(views[j], views[i]));
            of_view[i].add(both);
            of_view[j].add(both);
            pairs.push_back({i, j, both});
        }
    }

    const auto is_off = [&](std::size_t view) {
        return of_view[view].crossing >= least_crossings && of_view[view].crossing > of_view[view].parallel;
    };
    std::erase_if(pairs, [&](const Pair& pair) {
        return pair.meetings.crossing == 0 || (!is_off(pair.first) && !is_off(pair.second));
    });
    if (pairs.empty()) return {};
    std::size_t off = 0;
    for (std::size_t view = 0; view < count; ++view) off += is_off(view);
    Meetings all;
    for (const Pair& pair : pairs) all.add(pair.meetings);
    std::ranges::stable_sort(pairs, std::ranges::greater(), [](const Pair& pair) { return pair.meetings.crossing; });
    std::vector<std::string> named;
    for (std::size_t i = 0; i < std::min(pairs.size(), most_named_pairs); ++i) {
        const auto& [first, second, met] = pairs[i];
        named.push_back(fmt::format("{} with {} ({} of {})", views[first].number, views[second].number, met.crossing,
                                    met.crossing + met.parallel));
    }
    return fmt::format(
        "{} of {} do not lie in one frame with the others: where views meet, their surfaces cross at {} of {} sampled "
        "points; most of all inputs {}",
        off, count_text(count, "view", "views"), all.crossing, all.crossing + all.parallel, enumerated(named));
}

}  // namespace scanmill::merging
