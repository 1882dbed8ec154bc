// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/growth.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "scanmill/geometry/growing/overlaps.hpp"

namespace scanmill::growing {

namespace {

/// Propagates the orientation of the surface to unused points.
class Orientation {
public:
    Orientation(Surface& surface, Array<u32>& groups) : surface_(surface), groups_(groups) {
        groups_.resize(surface.points.size());
        std::ranges::fill(groups_, invalid_index);
    }

    /// Propagates from the whole surface to the unused points.
    void propagate_to(std::span<const u32> unused) {
        std::vector<u32> oriented;
        for (u32 point : unused)
            for (u32 other : surface_.neighbourhoods.of(point))
                if (surface_.is_used(other) && is_open(point)) {
                    orient(other, point);
                    oriented.push_back(point);
                }
        propagate(oriented);
    }
    /// Propagates from the triangles from row `first` on.
    void propagate_from(std::size_t first) {
        std::vector<u32> oriented;
        for (std::size_t row = first; row < surface_.triangles.size(); ++row)
            for (u32 corner : surface_.triangles[row]) oriented.push_back(corner);
        propagate(oriented);
    }
    /// Gives the points of the triangles from row `first` on the group of their seed.
    void assign_group(std::size_t first, u32 seed) {
        const u32 group = groups_[seed] == invalid_index ? seed : groups_[seed];
        for (std::size_t row = first; row < surface_.triangles.size(); ++row)
            for (u32 corner : surface_.triangles[row])
                if (groups_[corner] == invalid_index) groups_[corner] = group;
    }

private:
    bool is_open(u32 point) const {
        return surface_.states[point] == PointState::unused && groups_[point] == invalid_index;
    }

    void propagate(std::vector<u32>& oriented) {
        for (std::size_t i = 0; i < oriented.size(); ++i)  // `oriented` grows in the loop
            for (u32 other : surface_.neighbourhoods.of(oriented[i]))
                if (is_open(other)) {
                    orient(oriented[i], other);
                    oriented.push_back(other);
                }
    }

    void orient(u32 from, u32 to) {
        const Vec3 along = (surface_.positions[to] - surface_.positions[from]).normalized();
        const Vec3& normal = surface_.normals[from];
        const Vec3 reflected = normal - 2 * normal.dot(along) * along;
        if (!surface_.oriented && reflected.dot(surface_.normals[to]) < 0) surface_.normals[to] = -surface_.normals[to];
        groups_[to] = groups_[from];
    }

    Surface& surface_;
    Array<u32>& groups_;
};

}  // namespace

Growth::Growth(Surface& surface, Score score, std::vector<Limits> limits, Context& context)
    : surface_(surface),
      chooser_(surface, score),
      limits_(std::move(limits)),
      context_(context) {}

bool Growth::start(u32 point) {
    if (!form_seed(point)) return false;
    parked_.clear();
    grow(limits_.front());
    for (std::size_t round = 1; round < limits_.size(); ++round) retry(round);
    return true;
}

bool Growth::form_seed(u32 point) {
    if (surface_.states[point] != PointState::unused || is_covered(point, surface_.normals[point])) return false;
    const Vec3& normal = surface_.normals[point];
    u32 second = invalid_index;
    for (u32 other : surface_.neighbourhoods.of(point))
        if (surface_.states[other] == PointState::unused && !surface_.face_apart(point, other)) {
            second = other;
            break;
        }
    if (second == invalid_index || is_covered(second, normal)) return false;
    const u32 third = chooser_.choose_third(point, second, limits_.front());
    if (third == invalid_index || is_covered(third, normal) || chooser_.intersects_surface({point, second, third}))
        return false;
    const Vec3 up = surface_.facet_normal(point, second, third);
    add(up.dot(normal) > 0 ? Triangle{point, second, third} : Triangle{point, third, second}, 0);
    return true;
}

bool Growth::is_covered(u32 point, const Vec3& normal) const {
    const auto& p = surface_.positions;
    for (u32 other : surface_.neighbourhoods.of(point)) {
        if (!surface_.is_used(other)) continue;
        const bool covered = surface_.fans.any(other, [&](const Fans::LinkEdge& edge) {
            const Triangle triangle{other, edge.first, edge.last};
            const Vec3 facet = surface_.facet_normal(other, edge.first, edge.last);
            const double height = std::abs(facet.dot(p[point] - p[other]));
            const double cosine = facet.dot(normal);
            return (surface_.oriented ? cosine : std::abs(cosine)) > 0.5 &&
                   height < (p[edge.first] - p[edge.last]).norm() && contains(surface_, triangle, facet, point);
        });
        if (covered) return true;
    }
    return false;
}

void Growth::add(const Triangle& triangle, Pass pass) {
    surface_.add(triangle, pass);
    for (std::size_t i = 0; i < 3; ++i) {
        const u32 from = triangle[i], to = triangle[(i + 1) % 3];
        if (surface_.fans.right_of(from, to) == invalid_index) queues_[0].push_back({from, to});
    }
    if (surface_.triangles.size() < next_report_) return;
    next_report_ = surface_.triangles.size() + (1 << 14);
    context_.progress(0.4 + 0.5 * std::min(1.0, static_cast<double>(surface_.triangles.size()) /
                                                    (2.0 * static_cast<double>(surface_.points.size()))));
}

void Growth::grow(const Limits& limits) {
    for (;;) {
        const auto queue = std::ranges::find_if(queues_, [](const auto& edges) { return !edges.empty(); });
        if (queue == queues_.end()) return;
        const HalfEdge edge = queue->front();
        queue->pop_front();
        extend(edge, static_cast<std::size_t>(queue - queues_.begin()), limits);
    }
}

SuitablePoint Growth::choose(HalfEdge edge, const Limits& limits, bool wide, bool in_space) {
    // Checked per choice, not per triangle: most choices may fail, and with a large search radius each takes long.
    if (choices_++ % 64 == 0) context_.check_cancelled();
    return chooser_.choose(edge.from, edge.to, limits, wide, in_space);
}

void Growth::extend(HalfEdge edge, std::size_t queue, const Limits& limits) {
    if (surface_.fans.right_of(edge.from, edge.to) != invalid_index) return;  // no longer on the boundary
    // The first queue adds certain triangles only, which need no test in space.
    const SuitablePoint found = choose(edge, limits, queue == 2, queue > 0);
    if (queue < 2 && found.uncovered)
        queues_[2].push_back(edge);
    else if (found.point == invalid_index)
        parked_.push_back({edge, queue == 2 ? std::size_t(1) : std::size_t(0)});
    else if (queue == 0 && !found.certain)
        queues_[1].push_back(edge);
    else
        add({edge.from, found.point, edge.to}, limits.pass);
}

void Growth::retry(std::size_t round) {
    std::vector<ParkedEdge> left;
    for (std::size_t i = 0; i < parked_.size(); ++i) {  // `parked_` grows in the loop
        auto [edge, tried] = parked_[i];
        for (; tried <= round; ++tried) {
            if (surface_.fans.right_of(edge.from, edge.to) != invalid_index) break;
            const SuitablePoint found = choose(edge, limits_[tried], true, true);
            if (found.point == invalid_index) continue;
            add({edge.from, found.point, edge.to}, limits_[tried].pass);
            grow(limits_.front());
            break;
        }
        if (tried > round) left.push_back({edge, tried});
    }
    parked_ = std::move(left);
}

bool grow_all_components(Surface& surface, Growth& growth, std::optional<u32> start, Array<u32>& groups) {
    Orientation orientation(surface, groups);
    const auto begin = [&](u32 seed) {
        const std::size_t before = surface.triangles.size();
        if (!growth.start(seed)) return false;
        orientation.assign_group(before, seed);
        return true;
    };
    const auto flatter = [&](u32 a, u32 b) {
        return surface.variation[a] != surface.variation[b] ? surface.variation[a] < surface.variation[b] : a < b;
    };
    Array<u32> seeds(surface.points.size());
    std::iota(seeds.begin(), seeds.end(), 0);
    if (!begin(start ? *start : *std::ranges::min_element(seeds, flatter)) && start) return false;

    // The first component usually uses most points; only the others are sorted.
    const auto used = [&](u32 point) { return surface.states[point] != PointState::unused; };
    seeds.erase(std::ranges::remove_if(seeds, used).begin(), seeds.end());
    std::ranges::sort(seeds, flatter);
    orientation.propagate_to(seeds);
    for (u32 seed : seeds) {
        const std::size_t before = surface.triangles.size();
        if (begin(seed)) orientation.propagate_from(before);
    }
    return true;
}

}  // namespace scanmill::growing
