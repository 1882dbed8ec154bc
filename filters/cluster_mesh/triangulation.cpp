// SPDX-License-Identifier: GPL-3.0-or-later
#include "cluster_mesh/triangulation.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "scanmill/geometry/growing/overlaps.hpp"

namespace scanmill::clustering {

using growing::Fans;
using growing::PointState;

namespace {

/// An outside angle at a boundary vertex is closed if it is below 170 degrees.
constexpr double widest_corner_cosine = -0.984807753012208;

/// A point over a triangle counts as on an edge if its triangle with that edge has a smaller share of the area.
constexpr double least_share = 0.02;

/// Two meshes with more points than this first join only where the surface is flat, because elsewhere their
/// orientations are less certain. Of the values 0, 6, 20 and 60, this one leaves the fewest loops on ten thinned
/// models.
constexpr std::size_t few_points = 6;

/// If the normal of a near vertex is more than 30 degrees from a triangle's normal, the triangle is tested in space.
constexpr double flat_cosine = 0.8660254037844387;

}  // namespace

Triangulation::Triangulation(Surface& surface, double max_edge, const Vec3& up, const WinnerLimits& winner)
    : surface_(surface),
      squared_edge_(max_edge * max_edge),
      up_(up),
      winner_(winner),
      components_(surface.positions.size()),
      inserted_(surface.positions.size(), false) {}

Outcome Triangulation::insert(u32 point, std::span<const u32> near, bool may_start, const Limits& limits) {
    inserted_[point] = true;
    if (split_covering(point, near, limits)) return Outcome::split;
    collect(point, near);
    bool discontinuous = false;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
        const Candidate edge = candidates_[i];
        const Triangle triangle{edge.from, point, edge.to};
        const Verdict verdict = judge(point, edge);
        if (verdict != Verdict::create) {
            discontinuous = discontinuous || (i == 0 && verdict == Verdict::extra);
            continue;
        }
        if (!fits(triangle, near, limits, true)) continue;
        add(triangle);
        partner_ = edge.from;
        complete(point, near, limits);
        return Outcome::joined;
    }
    if (may_start && start(point, near, limits)) return Outcome::first;
    return discontinuous ? Outcome::extra : Outcome::loose;
}

bool Triangulation::complete(u32 point, std::span<const u32> near, const Limits& limits) {
    bool added = false;
    while (close_corners(point, near, limits) || (is_open(point) && join_others(point, near, limits))) added = true;
    return added;
}

void Triangulation::remove_small_meshes() {
    for (u32 point = 0; point < inserted_.size(); ++point) {
        if (!surface_.is_used(point) || components_.size(point) > few_points) continue;
        std::vector<u32> members;
        components_.for_each(point, [&](u32 member) { members.push_back(member); });
        for (u32 member : members)
            while (!surface_.fans.empty(member)) {
                Triangle triangle{};
                surface_.fans.any(member, [&](const Fans::LinkEdge& edge) {
                    triangle = {member, edge.first, edge.last};
                    return true;
                });
                remove(triangle);
            }
        components_.separate(point);
    }
}

void Triangulation::collect(u32 point, std::span<const u32> near) {
    const auto& p = surface_.positions;
    candidates_.clear();
    for (u32 from : near) {
        if (!is_open(from)) continue;
        surface_.fans.any(from, [&](const Fans::LinkEdge& edge) {
            const u32 to = edge.first;
            if (to == point || !is_short(point, to) || surface_.fans.right_of(from, to) != invalid_index) return false;
            const Vec3 along = p[to] - p[from], offset = p[point] - p[from];
            const double length = along.squaredNorm(), at = offset.dot(along);
            const Vec3 nearest = at <= 0 ? p[from] : at >= length ? p[to] : Vec3(p[from] + at / length * along);
            const double squared = at <= 0        ? offset.squaredNorm()
                                   : at >= length ? (p[point] - p[to]).squaredNorm()
                                                  : (p[point] - nearest).squaredNorm();
            const Vec3 outwards = along.cross(surface_.facet_normal(from, to, edge.last)).normalized();
            candidates_.push_back({squared, outwards.dot((p[point] - nearest).normalized()), from, to});
            return false;
        });
    }
    std::ranges::sort(candidates_, [](const Candidate& a, const Candidate& b) {
        return std::tuple(a.squared, -a.outward, a.from, a.to) < std::tuple(b.squared, -b.outward, b.from, b.to);
    });
}

Triangulation::Verdict Triangulation::judge(u32 point, const Candidate& edge) const {
    const Fans& fans = surface_.fans;
    const u32 third = fans.left_of(edge.from, edge.to);
    const Vec3 facet = surface_.facet_normal(edge.from, edge.to, third);
    const Vec3 normal = surface_.facet_normal(edge.from, point, edge.to);
    if (facet.dot(normal) >= winner_.normal_cosine) return Verdict::create;
    bool continues = false;
    for (const auto& [from, to] : {std::pair(edge.to, third), std::pair(third, edge.from)}) {
        const u32 beyond = fans.right_of(from, to);
        if (beyond == invalid_index) continue;
        const Vec3 check = surface_.facet_normal(from, to, point);
        if (!(surface_.facet_normal(to, from, beyond).dot(check) > winner_.neighbour_cosine)) continue;
        continues = true;
        if (facet.dot(check) >= winner_.overlap_cosine) return Verdict::split;
    }
    return continues ? Verdict::create : Verdict::extra;
}

bool Triangulation::fits(const Triangle& triangle, std::span<const u32> near, const Limits& limits, bool at_winner) {
    const auto& [from, apex, to] = triangle;
    const Fans& fans = surface_.fans;
    if (!is_short(from, apex, limits.edge_share) || !is_short(apex, to, limits.edge_share) ||
        !has_angles_of(surface_, triangle, limits.least_sine))
        return false;
    const Vec3 normal = surface_.facet_normal(from, apex, to);
    if (!agrees_with_points(surface_, triangle, normal, limits.point_cosine, limits.sharp_cosine)) return false;
    if (fans.left_of(from, apex) != invalid_index || fans.left_of(apex, to) != invalid_index) return false;
    const auto agrees = [&](u32 a, u32 b, double least) {
        const u32 third = fans.right_of(a, b);
        return third == invalid_index || surface_.facet_normal(b, a, third).dot(normal) >= least;
    };
    if (!agrees(to, from, at_winner ? growing::fold_cosine : limits.joint_cosine) ||
        !agrees(from, apex, limits.joint_cosine) || !agrees(apex, to, limits.joint_cosine))
        return false;
    return is_free(triangle, normal, near, limits);
}

bool Triangulation::is_flat(const Triangle& triangle) const {
    const Vec3 normal = surface_.facet_normal(triangle[0], triangle[1], triangle[2]);
    return std::ranges::all_of(triangle, [&](u32 corner) {
        return surface_.variation[corner] <= growing::sharp_variation &&
               std::abs(surface_.normals[corner].dot(normal)) > flat_cosine;
    });
}

bool Triangulation::is_reversed_at(const Triangle& triangle) const {
    const auto& [from, apex, to] = triangle;
    const auto& normals = surface_.normals;
    const Vec3 normal = surface_.facet_normal(from, apex, to);
    return !components_.are_joined(from, apex) && is_short(from, apex) && is_short(apex, to) &&
           normals[apex].dot(normal) < 0 && normals[from].dot(normal) > 0 && normals[to].dot(normal) > 0;
}

bool Triangulation::is_free(const Triangle& triangle, const Vec3& normal, std::span<const u32> near,
                            const Limits& limits) {
    if (!growing::sectors_are_free(surface_, triangle, normal, limits.in_space)) return false;
    const auto& p = surface_.positions;
    const double longest = std::sqrt(std::max(
        {squared(triangle[0], triangle[1]), squared(triangle[1], triangle[2]), squared(triangle[2], triangle[0])}));
    bool faces_apart = limits.in_space;
    const Vec3 u = p[triangle[1]] - p[triangle[0]], v = p[triangle[2]] - p[triangle[0]];
    const Vec3 cross = u.cross(v);
    const Vec3 centre = p[triangle[0]] + (u.squaredNorm() * v.cross(cross) + v.squaredNorm() * cross.cross(u)) /
                                             (2 * cross.squaredNorm());
    const double squared_radius = (p[triangle[0]] - centre).squaredNorm() * (1 - 1e-9);
    for (u32 x : near) {
        if (x == triangle[0] || x == triangle[1] || x == triangle[2]) continue;
        const bool used = surface_.is_used(x);
        if (!used && !limits.leaves_room) continue;
        const double cosine = surface_.normals[x].dot(normal);
        faces_apart = faces_apart || (used && cosine < flat_cosine);
        if (used && cosine <= 0) continue;
        if (surface_.states[x] == PointState::interior) continue;
        if (limits.empty_circle && (p[x] - centre).squaredNorm() < squared_radius) return false;
        const double height = std::abs(normal.dot(p[x] - p[triangle[0]]));
        if (height < longest / 2 && growing::contains(surface_, triangle, normal, x)) return false;
        if (used && growing::boundary_crosses(surface_, x, triangle[0], triangle[1], triangle[2], normal, longest / 2))
            return false;
    }
    return !faces_apart || !intersects(triangle, near);
}

bool Triangulation::intersects(const Triangle& triangle, std::span<const u32> near) {
    near_triangles_.gather_near(surface_, triangle, near);
    return near_triangles_.intersect(surface_, triangle);
}

bool Triangulation::split_covering(u32 point, std::span<const u32> near, const Limits& limits) {
    const auto& p = surface_.positions;
    // The nearest point of the surface is almost always a corner of the triangle that covers the point.
    constexpr std::size_t most_corners = 4;
    Triangle covering{};
    std::array<double, 3> shares{};
    double least = std::numeric_limits<double>::infinity();
    std::size_t corners = 0;
    for (u32 corner : near) {
        if (!surface_.is_used(corner)) continue;
        if (corners++ == most_corners) break;
        surface_.fans.any(corner, [&](const Fans::LinkEdge& edge) {
            const Triangle triangle{corner, edge.first, edge.last};
            const Vec3 u = p[edge.first] - p[corner], v = p[edge.last] - p[corner], offset = p[point] - p[corner];
            const Vec3 doubled = u.cross(v);
            const double area = doubled.squaredNorm();
            const double second = offset.cross(v).dot(doubled) / area, third = u.cross(offset).dot(doubled) / area;
            if (!(second >= 0 && third >= 0 && second + third <= 1)) return false;
            const double height = std::abs(offset.dot(doubled)) / std::sqrt(area);
            if (height >= least) return false;
            const double longest = std::sqrt(std::max({u.squaredNorm(), v.squaredNorm(), (u - v).squaredNorm()}));
            if (height > winner_.overlap_tangent * longest) return false;
            least = height;
            covering = triangle;
            shares = {1 - second - third, second, third};
            return false;
        });
    }
    if (least == std::numeric_limits<double>::infinity()) return false;
    for (u32 corner : covering)
        if (!is_short(point, corner)) return false;

    const auto& [a, b, c] = covering;
    std::vector<Triangle> removed{covering}, added;
    const auto thin = std::ranges::min_element(shares) - shares.begin();
    if (shares[static_cast<std::size_t>(thin)] < least_share) {
        const u32 from = covering[(static_cast<std::size_t>(thin) + 1) % 3],
                  to = covering[(static_cast<std::size_t>(thin) + 2) % 3],
                  opposite = covering[static_cast<std::size_t>(thin)];
        added = {{opposite, from, point}, {opposite, point, to}};
        if (const u32 beyond = surface_.fans.right_of(from, to); beyond != invalid_index) {
            removed.push_back({to, from, beyond});
            added.push_back({beyond, to, point});
            added.push_back({beyond, point, from});
            if (!is_short(beyond, point)) return false;
        }
    } else
        added = {{a, b, point}, {b, c, point}, {c, a, point}};
    const Vec3 before = surface_.facet_normal(a, b, c);
    for (const Triangle& triangle : added)
        if (!has_angles_of(surface_, triangle, 1e-3) ||
            !(surface_.facet_normal(triangle[0], triangle[1], triangle[2]).dot(before) > 0.5))
            return false;
    const double cosine = std::abs(surface_.normals[point].dot(before));
    if (surface_.variation[point] <= growing::sharp_variation && cosine < limits.point_cosine) return false;
    for (const Triangle& triangle : removed) remove(triangle);
    for (const Triangle& triangle : added) add(triangle);
    partner_ = a;
    return true;
}

bool Triangulation::start(u32 point, std::span<const u32> near, const Limits& limits) {
    const auto& p = surface_.positions;
    Triangle best{};
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < near.size(); ++i) {
        if (!is_loose(near[i]) || !is_short(point, near[i], limits.edge_share)) continue;
        for (std::size_t j = 0; j < i; ++j) {
            const Triangle triangle{point, near[j], near[i]};
            if (!is_loose(near[j]) || !is_short(near[i], near[j], limits.edge_share) ||
                !has_angles_of(surface_, triangle, limits.least_sine))
                continue;
            const Vec3 normal = surface_.facet_normal(point, near[j], near[i]);
            const double a = squared(point, near[i]), b = squared(point, near[j]), c = squared(near[i], near[j]);
            const Vec3 doubled = (p[near[j]] - p[point]).cross(p[near[i]] - p[point]);
            const double circumradius = a * b * c / doubled.squaredNorm();
            if (circumradius >= least ||
                !agrees_with_points(surface_, triangle, normal, limits.point_cosine, limits.sharp_cosine))
                continue;
            least = circumradius;
            best = triangle;
        }
    }
    if (least == std::numeric_limits<double>::infinity()) return false;
    if (surface_.facet_normal(best[0], best[1], best[2]).dot(up_) < 0) std::swap(best[1], best[2]);
    Limits in_space = limits;
    in_space.in_space = true;
    if (!is_free(best, surface_.facet_normal(best[0], best[1], best[2]), near, in_space)) return false;
    add(best);
    partner_ = best[1];
    return true;
}

bool Triangulation::close_corners(u32 point, std::span<const u32> near, const Limits& limits) {
    struct Corner {
        double cosine;
        Triangle triangle;
    };
    const auto& p = surface_.positions;
    std::vector<Corner> corners;
    const auto consider = [&](u32 from, u32 at, u32 to, const Triangle& triangle) {
        // The boundary goes from → at → to.
        const double cosine = (p[from] - p[at]).normalized().dot((p[to] - p[at]).normalized());
        if (from != to && cosine > widest_corner_cosine && is_short(from, to)) corners.push_back({cosine, triangle});
    };
    std::vector<u32> into, out_of;
    surface_.fans.any(point, [&](const Fans::LinkEdge& edge) {
        if (surface_.fans.right_of(point, edge.first) == invalid_index) out_of.push_back(edge.first);
        if (surface_.fans.left_of(point, edge.last) == invalid_index) into.push_back(edge.last);
        return false;
    });
    for (u32 end : out_of)
        surface_.fans.any(end, [&](const Fans::LinkEdge& edge) {
            if (surface_.fans.right_of(end, edge.first) == invalid_index)
                consider(point, end, edge.first, {point, edge.first, end});
            return false;
        });
    for (u32 begin : into)
        surface_.fans.any(begin, [&](const Fans::LinkEdge& edge) {
            if (surface_.fans.left_of(begin, edge.last) == invalid_index)
                consider(edge.last, begin, point, {begin, edge.last, point});
            return false;
        });
    for (u32 begin : into)
        for (u32 end : out_of) consider(begin, point, end, {begin, end, point});
    std::ranges::sort(corners, [](const Corner& a, const Corner& b) {
        return std::tuple(-a.cosine, a.triangle) < std::tuple(-b.cosine, b.triangle);
    });
    for (const Corner& corner : corners)
        if (fits(corner.triangle, near, limits, false)) {
            add(corner.triangle);
            return true;
        }
    return false;
}

bool Triangulation::join_others(u32 point, std::span<const u32> near, const Limits& limits) {
    collect(point, near);
    for (const Candidate& edge : candidates_) {
        if (edge.from == point || edge.to == point) continue;
        const Triangle triangle{edge.from, point, edge.to};
        if (limits.empty_circle && !components_.are_joined(edge.from, point) && !is_flat(triangle) &&
            std::min(components_.size(edge.from), components_.size(point)) > few_points)
            continue;
        if (is_reversed_at(triangle)) {
            if (join_reversed(triangle, near, limits)) return true;
            continue;
        }
        if (judge(point, edge) != Verdict::create || !fits(triangle, near, limits, true)) continue;
        add(triangle);
        return true;
    }
    return false;
}

bool Triangulation::join_reversed(const Triangle& triangle, std::span<const u32> near, const Limits& limits) {
    const auto& [from, point, to] = triangle;
    const auto reverse_near = [&] {
        reverse_at(point);
        for (u32 other : near)
            if (components_.are_joined(other, point)) reverse_at(other);
    };
    reverse_near();
    const bool fits_then = fits(triangle, near, limits, true);
    reverse_near();
    if (!fits_then) return false;
    const bool other_is_smaller = components_.size(from) < components_.size(point);
    components_.for_each(other_is_smaller ? from : point, [&](u32 member) { reverse_at(member); });
    add(other_is_smaller ? Triangle{to, point, from} : triangle);
    return true;
}

void Triangulation::add(const Triangle& triangle) {
    const Vec3 normal = surface_.facet_normal(triangle[0], triangle[1], triangle[2]);
    surface_.fans.add(triangle);
    for (u32 corner : triangle) {
        if (!surface_.is_used(corner) && surface_.normals[corner].dot(normal) < 0)
            surface_.normals[corner] = -surface_.normals[corner];
        update(corner);
    }
    components_.join(triangle[0], triangle[1]);
    components_.join(triangle[1], triangle[2]);
}

void Triangulation::remove(const Triangle& triangle) {
    surface_.fans.remove(triangle);
    for (u32 corner : triangle) update(corner);
}

void Triangulation::update(u32 point) {
    surface_.states[point] = surface_.fans.empty(point)    ? PointState::unused
                             : surface_.fans.closed(point) ? PointState::interior
                                                           : PointState::front;
}

void Triangulation::reverse_at(u32 point) {
    surface_.fans.reverse(point);
    surface_.normals[point] = -surface_.normals[point];
}

}  // namespace scanmill::clustering
