// SPDX-License-Identifier: GPL-3.0-or-later
#include "decimate/feature_network.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>
#include <utility>

#include "scanmill/base/statistics.hpp"
#include "scanmill/geometry/mesh/facet_normals.hpp"
#include "scanmill/geometry/spatial/angle.hpp"

namespace scanmill::decimating {

namespace {

constexpr u32 none = ~u32(0);

}  // namespace

FeatureNetwork::FeatureNetwork(const TriangleMesh& mesh, std::span<const u32> opposite, std::vector<bool> sharp,
                               const FeatureScale& scale)
    : mesh_(mesh),
      opposite_(opposite),
      first_(mesh.positions.size(), half_edges::boundary),
      features_(std::move(sharp)),
      classes_(mesh.positions.size(), VertexClass::smooth) {
    for (u32 half_edge = 0; half_edge < opposite.size(); ++half_edge) {
        u32& first = first_[half_edges::start(mesh, half_edge)];
        if (first == half_edges::boundary || opposite[half_edge] == half_edges::boundary) first = half_edge;
        if (opposite[half_edge] == half_edges::boundary) features_[half_edge] = true;
    }
    count_features();
    classify(scale);
    find_singular();
    if (mesh.sharp_edges.empty()) return;
    std::size_t kept = 0;
    for (u32 half_edge = 0; half_edge < opposite.size(); ++half_edge) {
        if (!features_[half_edge] || opposite[half_edge] < half_edge) continue;
        const Edge edge = make_edge(half_edges::start(mesh, half_edge), half_edges::end(mesh, half_edge));
        kept += std::ranges::binary_search(mesh.sharp_edges, edge);
    }
    ignored_declared_ = mesh.sharp_edges.size() - kept;
}

std::array<u32, 2> FeatureNetwork::line_neighbours(u32 vertex) const {
    std::array<u32, 2> found{};
    std::size_t count = 0;
    for_each_line(vertex, [&](u32, u32 other) {
        if (count < 2) found[count++] = other;
    });
    return found;
}

void FeatureNetwork::count_features() {
    counts_.assign(first_.size(), 0);
    for (u32 half_edge = 0; half_edge < opposite_.size(); ++half_edge) {
        if (!features_[half_edge]) continue;
        ++counts_[half_edges::start(mesh_, half_edge)];
        if (opposite_[half_edge] == half_edges::boundary) ++counts_[half_edges::end(mesh_, half_edge)];
    }
}

Vec3 FeatureNetwork::point_on_line(u32 vertex, u32 next, double distance, bool& is_closed) const {
    for (const u32 begin = vertex;;) {
        const Vec3 step = position(next) - position(vertex);
        const double length = step.norm();
        if (length >= distance) return position(vertex) + distance / length * step;
        is_closed = is_closed || next == begin;
        if (next == begin || counts_[next] != 2) return position(next);
        distance -= length;
        const auto [one, other] = line_neighbours(next);
        vertex = std::exchange(next, one == vertex ? other : one);
    }
}

bool FeatureNetwork::turns(u32 vertex, const FeatureScale& scale) const {
    const double limit = scale.corner_angle + angle_tie;
    const Vec3& here = position(vertex);
    const auto [last, next] = line_neighbours(vertex);
    if (!(angle_between(here - position(last), position(next) - here) > limit)) return false;
    // A reach up to the length of the shorter edge gives the directions of the two edges. It must be above 0.
    const double shorter = std::min((here - position(last)).norm(), (position(next) - here).norm());
    const double reach = std::max(scale.reach, shorter);
    bool is_closed = false;
    const Vec3 arriving = here - point_on_line(vertex, last, reach, is_closed);
    const Vec3 leaving = point_on_line(vertex, next, reach, is_closed) - here;
    return !is_closed && angle_between(arriving, leaving) > limit;
}

void FeatureNetwork::classify(const FeatureScale& scale) {
    for (u32 vertex = 0; vertex < first_.size(); ++vertex) {
        if (counts_[vertex] == 0) continue;
        if (counts_[vertex] != 2 || turns(vertex, scale))
            classes_[vertex] = VertexClass::corner;
        else
            classes_[vertex] =
                opposite_[first_[vertex]] == half_edges::boundary ? VertexClass::boundary : VertexClass::crease;
    }
}

void FeatureNetwork::find_singular() {
    // Around an apex, the total curvature of a disc does not grow with its radius. Around a smooth tip it grows.
    constexpr double least_curvature = 0.5, largest_growth = 0.2, near = 3, far = 6;
    Array<double> defects(first_.size(), 0);
    Array<double> lengths;
    for (u32 t = 0; t < mesh_.triangles.size(); ++t)
        for (u32 i = 0; i < 3; ++i) {
            const Triangle& corners = mesh_.triangles[t];
            const u32 a = corners[i], b = corners[(i + 1) % 3], c = corners[(i + 2) % 3];
            defects[a] += angle_between(position(b) - position(a), position(c) - position(a));
            lengths.push_back((position(b) - position(a)).norm());
        }
    if (lengths.empty()) return;
    const double edge = median(lengths);
    for (double& defect : defects) defect = 2 * std::numbers::pi - defect;

    const auto for_each_neighbour = [&](u32 vertex, auto&& action) {
        u32 half_edge = first_[vertex];
        do {
            action(half_edges::end(mesh_, half_edge));
            const u32 last = half_edges::before(half_edge);
            if (opposite_[last] == half_edges::boundary) action(half_edges::start(mesh_, last));
            half_edge = opposite_[last];
        } while (half_edge != half_edges::boundary && half_edge != first_[vertex]);
    };
    struct Disc {
        double curvature = 0;
        bool is_largest = true, has_features = false;
    };
    std::vector<u32> disc;
    std::vector<u32> visited(first_.size(), none);
    u32 visit = 0;
    // Stops as soon as the disc is rejected. Where triangles are far smaller than the median edge, a disc has thousands
    // of vertices, and nearly every peak of noise has a higher peak beside it.
    const auto disc_around = [&](u32 centre, double radius, bool must_be_largest) {
        Disc found;
        disc.assign(1, centre);
        visited[centre] = visit;
        for (std::size_t i = 0; i < disc.size() && !found.has_features; ++i) {
            const u32 vertex = disc[i];
            found.curvature += defects[vertex];
            found.has_features = found.has_features || counts_[vertex] > 0;
            found.is_largest = found.is_largest && (defects[vertex] < defects[centre] || vertex == centre);
            if (must_be_largest && !found.is_largest) break;
            for_each_neighbour(vertex, [&](u32 other) {
                if (visited[other] == visit || (position(other) - position(centre)).norm() > radius) return;
                visited[other] = visit;
                disc.push_back(other);
            });
        }
        ++visit;
        return found;
    };
    for (u32 vertex = 0; vertex < first_.size(); ++vertex) {
        if (first_[vertex] == half_edges::boundary || counts_[vertex] > 0 || !(defects[vertex] > 0)) continue;
        bool is_peak = true;
        for_each_neighbour(vertex, [&](u32 other) { is_peak = is_peak && defects[other] < defects[vertex]; });
        if (!is_peak) continue;
        const Disc small = disc_around(vertex, near * edge, true);
        if (!small.is_largest || small.has_features || !(small.curvature > least_curvature)) continue;
        const Disc large = disc_around(vertex, far * edge, false);
        if (large.has_features || !(std::abs(large.curvature - small.curvature) < largest_growth * small.curvature))
            continue;
        classes_[vertex] = VertexClass::corner;
    }
}

}  // namespace scanmill::decimating
