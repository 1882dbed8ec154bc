// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_update/groups.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/geometry/mesh/boundary_loops.hpp"
#include "scanmill/geometry/spatial/angle.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::updating {

namespace {

/// Whether a triangle is lower over its edge than this share of it. Its direction is then that of noise.
bool is_thin(const Vec3& start, const Vec3& end, const Vec3& apex) {
    constexpr double least_height = 0.1;
    return area_vector(start, end, apex).norm() < least_height * (end - start).squaredNorm();
}

double degrees(double radians) { return radians * 180 / std::numbers::pi; }

/// Sets the components of the model in which the groups lie. Groups of one component are connected by overlap facets.
void find_components(const Model& model, Groups& groups) {
    std::map<u32, u32> number;  // of overlap facets, after the groups
    for (u32 facet = 0; facet < groups.of_facet.size(); ++facet)
        if (groups.of_facet[facet] == Groups::overlap)
            number.emplace(facet, static_cast<u32>(groups.count + number.size()));
    const auto number_of = [&](u32 facet) {
        const std::int32_t group = groups.of_facet[facet];
        return group == Groups::overlap ? number.at(facet) : static_cast<u32>(group);
    };
    DisjointSets sets(groups.count + number.size());
    for (const auto& [facet, own] : number)
        for (u32 h = 3 * facet; h < 3 * facet + 3; ++h) sets.unite(own, number_of(model.opposite[h] / 3));
    groups.component.resize(groups.count);
    for (u32 g = 0; g < groups.count; ++g) groups.component[g] = sets.find(g);
}

}  // namespace

Groups segmentation(const Model& model, std::span<const u8> is_overlap, Context& context) {
    Groups groups;
    const std::size_t facets = is_overlap.size();
    groups.of_facet.assign(facets, Groups::overlap);
    std::vector<u32> lowest, queue;  // by group, its lowest vertex
    std::size_t visited = 0;
    for (u32 seed = 0; seed < facets; ++seed) {
        if (is_overlap[seed] == 1 || groups.of_facet[seed] != Groups::overlap) continue;
        const std::int32_t group = static_cast<std::int32_t>(lowest.size());
        lowest.push_back(~u32(0));
        groups.of_facet[seed] = group;
        queue.assign(1, seed);
        while (!queue.empty()) {
            const u32 facet = queue.back();
            queue.pop_back();
            if ((++visited & 0xffff) == 0) context.check_cancelled();
            for (u32 h = 3 * facet; h < 3 * facet + 3; ++h) {
                lowest.back() = std::min(lowest.back(), model.start(h));
                const u32 next = model.opposite[h] / 3;
                if (is_overlap[next] == 1 || groups.of_facet[next] != Groups::overlap) continue;
                groups.of_facet[next] = group;
                queue.push_back(next);
            }
        }
    }
    groups.count = lowest.size();
    std::vector<std::int32_t> order(groups.count), number(groups.count);
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, {}, [&](std::int32_t group) { return lowest[static_cast<std::size_t>(group)]; });
    for (std::size_t i = 0; i < order.size(); ++i)
        number[static_cast<std::size_t>(order[i])] = static_cast<std::int32_t>(i);
    for (std::int32_t& group : groups.of_facet)
        if (group != Groups::overlap) group = number[static_cast<std::size_t>(group)];
    find_components(model, groups);
    return groups;
}

double dihedral_angle(const Vec3& start, const Vec3& end, const Vec3& apex, const Vec3& on_model, const Vec3& vertex) {
    const Vec3 along = (end - start).normalized();
    const auto across = [&](const Vec3& way) { return Vec3(way - way.dot(along) * along); };
    return angle_between(across(apex - start), across(vertex - on_model));
}

CloudAngles mean_angles(const Model& model, const Groups& groups, const CloudSurface& cloud,
                        std::span<const LoopOverlap> loops, Context& context) {
    struct Sum {
        double angles = 0;
        std::size_t edges = 0;
        double share = 0;  ///< largest share of a loop's edges
    };
    struct Nearest {
        double squared;
        u32 vertex;
        auto operator<=>(const Nearest&) const = default;
    };
    CloudAngles result;
    std::map<u32, Sum> sums;
    const auto position = [&](u32 h) { return cloud.mesh.positions[half_edges::start(cloud.mesh, h)]; };
    for (std::size_t i = 0; i < loops.size(); ++i) {
        std::map<u32, Sum> at_loop;
        std::size_t edges = 0, divided = 0;  // with an angle, with two or more
        Vec3 undivided_at = Vec3::Zero();
        for (const EdgeOverlap& edge : loops[i].edges) {
            context.check_cancelled();
            if (!edge.foot) continue;
            const Vec3 start = position(edge.half_edge), end = position(half_edges::after(edge.half_edge)),
                       apex = position(half_edges::before(edge.half_edge)), middle = (start + end) / 2;
            if (is_thin(start, end, apex)) continue;
            std::map<u32, Nearest> nearest;
            for (const u32 facet : edge.facets)
                for (u32 h = 3 * facet; h < 3 * facet + 3; ++h) {
                    const u32 vertex = model.start(h);
                    const Nearest own{(model.mesh.positions[vertex] - middle).squaredNorm(), vertex};
                    model.for_each_around(h, [&](u32 around) {
                        const std::int32_t group = groups.of_facet[around / 3];
                        if (group == Groups::overlap) return;
                        const auto [found, is_new] = nearest.emplace(static_cast<u32>(group), own);
                        if (!is_new) found->second = std::min(found->second, own);
                    });
                }
            edges += !nearest.empty();
            divided += nearest.size() > 1;
            if (nearest.size() == 1 && edges == divided + 1) undivided_at = middle;
            for (const auto& [group, best] : nearest) {
                Sum& sum = at_loop[group];
                sum.angles += dihedral_angle(start, end, apex, *edge.foot, model.mesh.positions[best.vertex]);
                ++sum.edges;
            }
        }
        if (2 * divided < edges && !result.undivided_loop) {
            result.undivided_loop = i;
            result.undivided_at = undivided_at;
        }
        for (const auto& [group, sum] : at_loop) {
            Sum& all = sums[group];
            all.angles += sum.angles;
            all.edges += sum.edges;
            all.share = std::max(all.share, static_cast<double>(sum.edges) / static_cast<double>(edges));
        }
    }
    for (const auto& [group, sum] : sums)
        result.groups.push_back({group, sum.angles / static_cast<double>(sum.edges), sum.share});
    return result;
}

Choice chosen_groups(const CloudAngles& angles, double gap) {
    constexpr double right_angle = std::numbers::pi / 2;
    Choice choice;
    std::vector<GroupAngle> groups;
    for (const GroupAngle& angle : angles.groups)
        if (angle.share >= least_group_share)
            groups.push_back(angle);
        else if (angle.mean < right_angle)
            choice.replaced.push_back(angle.group);
    if (groups.size() == 2) {
        const auto& [low, high] =
            std::minmax(groups[0], groups[1], [](const GroupAngle& a, const GroupAngle& b) { return a.mean < b.mean; });
        if (high.mean - low.mean > gap)
            choice.replaced.push_back(low.group);
        else
            choice.ambiguity = fmt::format("the mean angles {:.1f}° and {:.1f}° of groups {} and {} differ by {:.1f}°",
                                           degrees(low.mean), degrees(high.mean), low.group + 1, high.group + 1,
                                           degrees(high.mean - low.mean));
    } else {
        for (const GroupAngle& angle : groups) {
            if (std::abs(angle.mean - right_angle) <= gap / 2 && choice.ambiguity.empty())
                choice.ambiguity = fmt::format("the mean angle {:.1f}° of group {} is within {:.1f}° of 90°",
                                               degrees(angle.mean), angle.group + 1, degrees(gap / 2));
            if (angle.mean < right_angle) choice.replaced.push_back(angle.group);
        }
    }
    std::ranges::sort(choice.replaced);
    return choice;
}

namespace {

/// V - E + F of the facets for which is_in(facet) holds; a vertex counts once per fan.
template <class IsIn>
long euler(std::span<const u32> opposite, const IsIn& is_in) {
    const auto next = [&](u32 h) { return opposite[half_edges::before(h)]; };  // around the start, counter-clockwise
    const auto leads_on = [&](u32 h) { return h < half_edges::no_half_edge && is_in(h / 3); };
    long facets = 0, border = 0, closed_fans = 0;
    std::vector<bool> is_seen(opposite.size());
    for (u32 h = 0; h < opposite.size(); ++h) {
        if (!is_in(h / 3)) continue;
        facets += h % 3 == 0;
        border += !leads_on(opposite[h]);
        u32 around = h;
        while (!is_seen[around]) {
            is_seen[around] = true;
            if (!leads_on(next(around))) break;
            around = next(around);
            closed_fans += around == h;
        }
    }
    // Every open fan has one border half-edge that leaves its vertex.
    return closed_fans + border - (3 * facets + border) / 2 + facets;
}

}  // namespace

long euler_of_rest(const Model& model, const Groups& groups, const std::vector<bool>& replaced, std::size_t vertices) {
    const auto goes = [&](u32 facet) {
        const std::int32_t group = groups.of_facet[facet];
        return group != Groups::overlap && replaced[static_cast<std::size_t>(group)];
    };
    std::vector<u32> border;  // vertices, once for each border half-edge
    for (u32 h = 0; h < model.opposite.size(); ++h)
        if (goes(h / 3) && !goes(model.opposite[h] / 3)) border.push_back(model.start(h));
    const long half_edges = static_cast<long>(border.size());
    std::ranges::sort(border);
    const auto repeats = std::ranges::unique(border);
    border.erase(repeats.begin(), repeats.end());
    const long whole = static_cast<long>(vertices) - static_cast<long>(model.mesh.triangles.size()) / 2;
    // A border vertex is in fans of both parts, as many of each.
    return whole - euler(model.opposite, goes) + half_edges - static_cast<long>(border.size());
}

CloudEuler euler_of(const CloudSurface& cloud) {
    const Array<u32> opposite = half_edges::opposites(cloud.mesh);
    const Array<u32> component = components_of(opposite);
    std::vector<bool> is_used(component.size());
    long components = 0, loops = 0;
    for (const CloudLoop& loop : cloud.loops) {
        const u32 own = component[loop.half_edges[0] / 3];
        components += !is_used[own];
        is_used[own] = true;
    }
    for (const Array<u32>& loop : boundary_loops(cloud.mesh, opposite)) loops += is_used[component[loop[0] / 3]];
    const long used = static_cast<long>(cloud.loops.size());
    return {euler(opposite, [&](u32 facet) { return is_used[component[facet]]; }) + loops - used,
            2 * components - used};
}

}  // namespace scanmill::updating
