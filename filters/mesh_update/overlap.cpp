// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_update/overlap.hpp"

#include <algorithm>
#include <cmath>
#include <queue>
#include <unordered_map>

#include "scanmill/geometry/spatial/triangle_distance.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::updating {

namespace {

/// An edge is halved this often at most. Facets that are then not adjacent meet in a vertex, or lie on two sheets of
/// the model; a walk joins them.
constexpr int most_halvings = 12;
/// Facets that a walk visits at most. Two facets under one boundary edge are near each other, or the model has two
/// sheets there.
constexpr std::size_t most_visited = 10'000;

void sort_unique(std::vector<u32>& facets) {
    std::ranges::sort(facets);
    facets.erase(std::unique(facets.begin(), facets.end()), facets.end());
}

struct Hit {
    u32 facet, slot;
    Vec3 foot;
    double distance;
};

class Tracer {
public:
    Tracer(const Model& model, double max_distance) : model_(model), max_distance_(max_distance) {}

    /// The facet nearest to the point, whatever its distance.
    Hit nearest(const Vec3& point) {
        const NearestTriangle found = model_.tree.nearest(point, hint_);
        hint_ = found.slot;
        return {found.triangle, found.slot, model_.tree.nearest_point(point, found.slot),
                std::sqrt(found.squared_distance)};
    }
    bool is_near(const Hit& hit) const { return hit.distance <= max_distance_; }

    /// Appends the facets between those under the ends of a segment.
    void trace(const Vec3& from, u32 first, const Vec3& to, u32 last, std::vector<u32>& facets, int halvings = 0) {
        if (first == last || are_adjacent(first, last)) return;
        const Vec3 middle = (from + to) / 2;
        if (halvings < most_halvings)
            if (const Hit hit = nearest(middle); is_near(hit)) {
                trace(from, first, middle, hit.facet, facets, halvings + 1);
                facets.push_back(hit.facet);
                trace(middle, hit.facet, to, last, facets, halvings + 1);
                return;
            }
        walk(from, first, to, last, facets);
    }

private:
    bool are_adjacent(u32 one, u32 other) const {
        for (u32 h = 3 * one; h < 3 * one + 3; ++h)
            if (model_.opposite[h] / 3 == other) return true;
        return false;
    }

    /// Appends the facets of the path between two facets along which their centroids stay nearest to the segment.
    void walk(const Vec3& from, u32 first, const Vec3& to, u32 last, std::vector<u32>& facets) const {
        struct Entry {
            double cost;
            u32 facet, before;
            bool operator>(const Entry& other) const {
                return cost != other.cost ? cost > other.cost : facet > other.facet;
            }
        };
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
        std::unordered_map<u32, u32> before;
        open.push({0, first, first});
        while (!open.empty() && before.size() < most_visited) {
            const Entry entry = open.top();
            open.pop();
            if (!before.emplace(entry.facet, entry.before).second) continue;
            if (entry.facet == last) {
                for (u32 f = entry.before; f != first; f = before.at(f)) facets.push_back(f);
                return;
            }
            for (u32 h = 3 * entry.facet; h < 3 * entry.facet + 3; ++h) {
                const u32 next = model_.opposite[h] / 3;
                if (before.contains(next)) continue;
                const auto [a, b, c] = model_.corners(next);
                const Vec3 centroid = (a + b + c) / 3;
                const double distance = (centroid - nearest_on_segment(centroid, from, to)).norm();
                open.push({entry.cost + distance, next, entry.facet});
            }
        }
    }

    const Model& model_;
    double max_distance_;
    u32 hint_ = NearestTriangle::none;
};

}  // namespace

Projection project(const Vec3& point, const std::array<Vec3, 3>& facet) {
    constexpr double tolerance = 1e-9;
    const auto& [a, b, c] = facet;
    const Vec3 area = area_vector(a, b, c);
    const Vec3 normal = area.normalized();
    const double distance = (point - b).dot(normal);
    const Vec3 foot = point - distance * normal;
    const double least = std::min(
        {area_vector(foot, b, c).dot(area), area_vector(a, foot, c).dot(area), area_vector(a, b, foot).dot(area)});
    return {distance, foot, least >= -tolerance * area.squaredNorm()};
}

LoopOverlap overlap_of(const Model& model, const CloudSurface& cloud, const CloudLoop& loop, double max_distance,
                       Context& context) {
    LoopOverlap result;
    Tracer tracer(model, max_distance);
    const auto start = [&](u32 h) { return cloud.mesh.positions[half_edges::start(cloud.mesh, h)]; };
    std::vector<Hit> hits;
    for (const u32 h : loop.half_edges) {
        context.check_cancelled();
        const Vec3 point = start(h);
        hits.push_back(tracer.nearest(point));
        const Hit& hit = hits.back();
        add_distance(result, point, hit.distance, max_distance);
        if (!tracer.is_near(hit)) continue;
        const Projection projection = project(point, model.corners(hit.facet));
        // Beside an edge or a vertex, the nearest point is not the foot on the plane.
        result.offsets.push_back(projection.is_inside ? std::abs(projection.distance) : hit.distance);
    }
    // The facet before each boundary point that has one, so that the barrier is closed where points hang.
    std::optional<std::size_t> first;
    for (std::size_t i = 0; i < hits.size() && !first; ++i)
        if (tracer.is_near(hits[i])) first = i;
    for (std::size_t i = 0; i < hits.size(); ++i) {
        EdgeOverlap edge{loop.half_edges[i], {}, {}};
        const Vec3 from = start(loop.half_edges[i]), to = start(loop.half_edges[(i + 1) % hits.size()]);
        if (const Hit middle = tracer.nearest((from + to) / 2); tracer.is_near(middle)) edge.foot = middle.foot;
        result.edges.push_back(std::move(edge));
    }
    if (!first) return result;
    for (std::size_t k = 0; k < hits.size();) {
        const std::size_t i = (*first + k) % hits.size();
        std::size_t length = 1;
        while (!tracer.is_near(hits[(i + length) % hits.size()])) ++length;
        const std::size_t j = (i + length) % hits.size();
        std::vector<u32>& facets = result.edges[i].facets;
        facets.push_back(hits[i].facet);
        tracer.trace(start(loop.half_edges[i]), hits[i].facet, start(loop.half_edges[j]), hits[j].facet, facets);
        facets.push_back(hits[j].facet);
        sort_unique(facets);
        k += length;
    }
    for (const EdgeOverlap& edge : result.edges)
        result.facets.insert(result.facets.end(), edge.facets.begin(), edge.facets.end());
    sort_unique(result.facets);
    return result;
}

namespace {

/// One half-edge at each vertex that is in a triangle, by vertex.
Array<u32> half_edges_by_vertex(const Model& model) {
    Array<u32> at(model.mesh.positions.size(), half_edges::boundary);
    for (u32 h = 0; h < model.opposite.size(); ++h) at[model.start(h)] = h;
    std::erase(at, half_edges::boundary);
    return at;
}

Array<Vec3> starts_of(const Model& model, std::span<const u32> half_edges) {
    Array<Vec3> positions;
    for (const u32 h : half_edges) positions.push_back(model.mesh.positions[model.start(h)]);
    return positions;
}

}  // namespace

CandidateFacets::CandidateFacets(const Model& model, unsigned threads)
    : model_(model),
      corners_(half_edges_by_vertex(model)),
      vertices_(tree_of_points(starts_of(model, corners_), threads)) {}

void CandidateFacets::add(const CloudSurface& cloud, const CloudLoop& loop, double max_distance,
                          LoopOverlap& overlap) const {
    std::vector<u32> before;  // facets at the edge's start, while its end is searched
    const std::size_t count = loop.half_edges.size();
    for (std::size_t k = 0; k <= count; ++k) {
        const u32 h = loop.half_edges[k % count];
        std::vector<u32> around;
        const NearestTriangle nearest = vertices_.nearest(cloud.mesh.positions[half_edges::start(cloud.mesh, h)]);
        if (nearest.squared_distance <= max_distance * max_distance)
            model_.for_each_around(corners_[nearest.triangle], [&](u32 corner) { around.push_back(corner / 3); });
        if (k > 0) {
            std::vector<u32>& facets = overlap.edges[k - 1].facets;
            facets.insert(facets.end(), before.begin(), before.end());
            facets.insert(facets.end(), around.begin(), around.end());
            sort_unique(facets);
            overlap.facets.insert(overlap.facets.end(), facets.begin(), facets.end());
        }
        before = std::move(around);
    }
    sort_unique(overlap.facets);
}

}  // namespace scanmill::updating
