// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_update/groups.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/geometry/spatial/angle.hpp"

namespace scanmill::updating {

namespace {

double degrees(double radians) { return radians * 180 / std::numbers::pi; }

/// Sets the components of the model in which the groups lie.
void find_components(const Model& model, Groups& groups) {
    DisjointSets sets(groups.of_facet.size());
    for (u32 h = 0; h < model.opposite.size(); ++h)
        if (model.opposite[h] > h) sets.unite(h / 3, model.opposite[h] / 3);
    std::map<u32, u32> lowest;
    groups.component.assign(groups.count, 0);
    std::vector<u32> facet_of(groups.count, 0);
    for (u32 f = static_cast<u32>(groups.of_facet.size()); f-- > 0;)
        if (groups.of_facet[f] != Groups::overlap) facet_of[static_cast<std::size_t>(groups.of_facet[f])] = f;
    for (u32 g = 0; g < groups.count; ++g) groups.component[g] = lowest.emplace(sets.find(facet_of[g]), g).first->second;
}

}  // namespace

Groups segmentation(const Model& model, std::span<const u8> is_overlap, Context& context) {
    Groups groups;
    const std::size_t facets = is_overlap.size();
    groups.of_facet.assign(facets, Groups::overlap);
    std::vector<u32> lowest, queue;  // by group, its lowest vertex
    for (u32 seed = 0; seed < facets; ++seed) {
        if (is_overlap[seed] == 1 || groups.of_facet[seed] != Groups::overlap) continue;
        context.check_cancelled();
        const std::int32_t group = static_cast<std::int32_t>(lowest.size());
        lowest.push_back(~u32(0));
        groups.of_facet[seed] = group;
        queue.assign(1, seed);
        while (!queue.empty()) {
            const u32 facet = queue.back();
            queue.pop_back();
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
    for (std::size_t i = 0; i < order.size(); ++i) number[static_cast<std::size_t>(order[i])] = static_cast<std::int32_t>(i);
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
        context.check_cancelled();
        std::map<u32, Sum> at_loop;
        for (const EdgeOverlap& edge : loops[i].edges) {
            if (!edge.foot) continue;
            const Vec3 start = position(edge.half_edge), end = position(half_edges::after(edge.half_edge)),
                       apex = position(half_edges::before(edge.half_edge)), middle = (start + end) / 2;
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
            for (const auto& [group, best] : nearest) {
                Sum& sum = at_loop[group];
                sum.angles +=
                    dihedral_angle(start, end, apex, *edge.foot, model.mesh.positions[best.vertex]);
                ++sum.edges;
            }
        }
        if (at_loop.size() < 2 && !result.undivided_loop) result.undivided_loop = i;
        for (const auto& [group, sum] : at_loop) {
            sums[group].angles += sum.angles;
            sums[group].edges += sum.edges;
        }
    }
    for (const auto& [group, sum] : sums)
        result.groups.push_back({group, sum.angles / static_cast<double>(sum.edges), sum.edges});
    return result;
}

Choice chosen_groups(const CloudAngles& angles, double gap) {
    constexpr double right_angle = std::numbers::pi / 2;
    Choice choice;
    const std::vector<GroupAngle>& all = angles.groups;
    if (all.size() == 2) {
        const double difference = std::abs(all[0].mean - all[1].mean);
        if (difference > gap)
            choice.replaced = {all[0].mean < all[1].mean ? all[0].group : all[1].group};
        else
            choice.ambiguity = fmt::format("the mean angles {:.1f}° and {:.1f}° of groups {} and {} differ by {:.1f}°",
                                           degrees(all[0].mean), degrees(all[1].mean), all[0].group + 1,
                                           all[1].group + 1, degrees(difference));
        return choice;
    }
    for (const GroupAngle& angle : all) {
        if (std::abs(angle.mean - right_angle) <= gap / 2 && choice.ambiguity.empty())
            choice.ambiguity = fmt::format("the mean angle {:.1f}° of group {} is within {:.1f}° of 90°",
                                           degrees(angle.mean), angle.group + 1, degrees(gap / 2));
        if (angle.mean < right_angle) choice.replaced.push_back(angle.group);
    }
    return choice;
}

}  // namespace scanmill::updating
