// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/growth.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "region_grow/sectors.hpp"

namespace scanmill::growing {

namespace {

/// Carries the surface's facing on to unused places.
class Facing {
public:
    Facing(Surface& surface, Array<u32>& groups) : surface_(surface), groups_(groups) {
        groups_.resize(surface.samples.size());
        std::ranges::fill(groups_, nobody);
    }

    /// From wherever the surface is near.
    void spread_to(std::span<const u32> unused) {
        std::vector<u32> turned;
        for (u32 place : unused)
            for (u32 other : surface_.neighbourhoods.of(place))
                if (surface_.is_used(other) && waits(place)) {
                    turn(other, place);
                    turned.push_back(place);
                }
        go_on(turned);
    }
    /// From the triangles from row `first` on.
    void spread_from(std::size_t first) {
        std::vector<u32> turned;
        for (std::size_t row = first; row < surface_.triangles.size(); ++row)
            for (u32 corner : surface_.triangles[row]) turned.push_back(corner);
        go_on(turned);
    }
    /// Gives the places that joined the surface since `first`, by triangle, the group of the piece's beginning.
    void name_group(std::size_t first, u32 seed) {
        const u32 group = groups_[seed] == nobody ? seed : groups_[seed];
        for (std::size_t row = first; row < surface_.triangles.size(); ++row)
            for (u32 corner : surface_.triangles[row])
                if (groups_[corner] == nobody) groups_[corner] = group;
    }

private:
    bool waits(u32 place) const { return surface_.states[place] == PlaceState::unused && groups_[place] == nobody; }

    void go_on(std::vector<u32>& turned) {
        for (std::size_t i = 0; i < turned.size(); ++i)  // grows on the way
            for (u32 other : surface_.neighbourhoods.of(turned[i]))
                if (waits(other)) {
                    turn(turned[i], other);
                    turned.push_back(other);
                }
    }

    void turn(u32 from, u32 to) {
        const Vec3 way = (surface_.positions[to] - surface_.positions[from]).normalized();
        const Vec3& facing = surface_.normals[from];
        const Vec3 mirrored = facing - 2 * facing.dot(way) * way;
        if (!surface_.oriented && mirrored.dot(surface_.normals[to]) < 0) surface_.normals[to] = -surface_.normals[to];
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

void Growth::add(const Triangle& triangle, Pass pass) {
    surface_.add(triangle, pass);
    for (std::size_t i = 0; i < 3; ++i) {
        const u32 from = triangle[i], to = triangle[(i + 1) % 3];
        if (surface_.fans.right_of(from, to) == nobody) waiting_[0].push_back({from, to});
    }
    if (surface_.triangles.size() < next_report_) return;
    next_report_ = surface_.triangles.size() + (1 << 14);
    context_.progress(0.4 + 0.5 * std::min(1.0, static_cast<double>(surface_.triangles.size()) /
                                                    (2.0 * static_cast<double>(surface_.samples.size()))));
}

SuitablePoint Growth::look(DirectedEdge edge, const Limits& limits, bool far, bool in_space) {
    // Also where edges find nothing and no triangle comes of it. With a generous search radius a look takes long.
    if (looks_++ % 64 == 0) context_.check_cancelled();
    return chooser_.choose(edge.from, edge.to, limits, far, in_space);
}

void Growth::continue_at(DirectedEdge edge, std::size_t line, const Limits& limits) {
    if (surface_.fans.right_of(edge.from, edge.to) != nobody) return;  // continued from the other side
    // In the first line only plain ones are added, for which the plane tells enough.
    const SuitablePoint found = look(edge, limits, line == 2, line > 0);
    if (line < 2 && found.uncovered)
        waiting_[2].push_back(edge);
    else if (found.point == nobody)
        parked_.push_back({edge, line == 2 ? std::size_t(1) : std::size_t(0)});
    else if (line == 0 && !found.plain)
        waiting_[1].push_back(edge);
    else
        add({edge.from, found.point, edge.to}, limits.pass);
}

void Growth::grow(const Limits& limits) {
    for (;;) {
        const auto line = std::ranges::find_if(waiting_, [](const auto& edges) { return !edges.empty(); });
        if (line == waiting_.end()) return;
        const DirectedEdge edge = line->front();
        line->pop_front();
        continue_at(edge, static_cast<std::size_t>(line - waiting_.begin()), limits);
    }
}

void Growth::retry(std::size_t round) {
    std::vector<ParkedEdge> left;
    for (std::size_t i = 0; i < parked_.size(); ++i) {  // grows on the way
        auto [edge, tried] = parked_[i];
        for (; tried <= round; ++tried) {
            if (surface_.fans.right_of(edge.from, edge.to) != nobody) break;
            const SuitablePoint found = look(edge, limits_[tried], true, true);
            if (found.point == nobody) continue;
            add({edge.from, found.point, edge.to}, limits_[tried].pass);
            grow(limits_.front());
            break;
        }
        if (tried > round) left.push_back({edge, tried});
    }
    parked_ = std::move(left);
}

bool Growth::start(u32 place) {
    if (!form_seed(place)) return false;
    parked_.clear();
    grow(limits_.front());
    for (std::size_t round = 1; round < limits_.size(); ++round) retry(round);
    return true;
}

bool Growth::is_covered(u32 place, const Vec3& normal) const {
    const auto& p = surface_.positions;
    for (u32 other : surface_.neighbourhoods.of(place)) {
        if (!surface_.is_used(other)) continue;
        const bool covered = surface_.fans.any(other, [&](const Fans::Pair& pair) {
            const Triangle triangle{other, pair.first, pair.last};
            const Vec3 facet = surface_.facet_normal(other, pair.first, pair.last);
            const double height = std::abs(facet.dot(p[place] - p[other]));
            const double cosine = facet.dot(normal);
            return (surface_.oriented ? cosine : std::abs(cosine)) > 0.5 &&
                   height < (p[pair.first] - p[pair.last]).norm() && lies_over(surface_, triangle, facet, place);
        });
        if (covered) return true;
    }
    return false;
}

bool Growth::form_seed(u32 place) {
    if (surface_.states[place] != PlaceState::unused || is_covered(place, surface_.normals[place])) return false;
    const Vec3& normal = surface_.normals[place];
    u32 second = nobody;
    for (u32 other : surface_.neighbourhoods.of(place))
        if (surface_.states[other] == PlaceState::unused && !surface_.face_apart(place, other)) {
            second = other;
            break;
        }
    if (second == nobody || is_covered(second, normal)) return false;
    const u32 third = chooser_.choose_third(place, second, limits_.front());
    if (third == nobody || is_covered(third, normal) || chooser_.passes_through_others({place, second, third}))
        return false;
    const Vec3 up = surface_.facet_normal(place, second, third);
    add(up.dot(normal) > 0 ? Triangle{place, second, third} : Triangle{place, third, second}, 0);
    return true;
}

bool grow_all_pieces(Surface& surface, Growth& growth, std::optional<u32> start, Array<u32>& groups) {
    Facing facing(surface, groups);
    const auto begin = [&](u32 place) {
        const std::size_t before = surface.triangles.size();
        if (!growth.start(place)) return false;
        facing.name_group(before, place);
        return true;
    };
    const auto flatter = [&](u32 a, u32 b) {
        return surface.roughness[a] != surface.roughness[b] ? surface.roughness[a] < surface.roughness[b] : a < b;
    };
    Array<u32> places(surface.samples.size());
    std::iota(places.begin(), places.end(), 0);
    if (!begin(start ? *start : *std::ranges::min_element(places, flatter)) && start) return false;

    // The first piece usually is all there is; what it left is sorted, not everything.
    const auto used = [&](u32 place) { return surface.states[place] != PlaceState::unused; };
    places.erase(std::ranges::remove_if(places, used).begin(), places.end());
    std::ranges::sort(places, flatter);
    facing.spread_to(places);
    for (u32 place : places) {
        const std::size_t before = surface.triangles.size();
        if (begin(place)) facing.spread_from(before);
    }
    return true;
}

}  // namespace scanmill::growing
