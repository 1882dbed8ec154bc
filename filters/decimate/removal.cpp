// SPDX-License-Identifier: GPL-3.0-or-later
#include "decimate/removal.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "region_grow/intersections.hpp"
#include "scanmill/geometry/spatial/triangle_distance.hpp"

#include <atomic>
std::atomic<int> g_why[16];
namespace scanmill::decimating {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
/// Neighbouring triangles may not be folded onto each other: cosine of the largest angle between their normals.
constexpr double fold_cosine = -0.9848;  // 170 degrees

}  // namespace

bool Planner::add_line_errors(u32 vertex, u32 a, u32 b, const Vec3& up, SignedErrors& errors) const {
    const Vec3 &from = surface_.original.position(a), &to = surface_.original.position(b);
    const auto add = [&](u32 passed) {
        const Vec3& position = surface_.original.position(passed);
        const Vec3 off = position - nearest_on_segment(position, from, to);
        const double distance = off.norm();
        const bool is_outside = off.dot(up) >= 0;
        errors.add(distance, is_outside);
        return distance <= (is_outside ? limits_.error.outside : limits_.error.inside);
    };
    if (!add(vertex)) return false;
    for (u32 next : surface_.original.line_neighbours(vertex)) {
        u32 last = vertex;
        while (!surface_.mesh.is_used(next)) {
            if (!add(next)) return false;
            const auto [one, other] = surface_.original.line_neighbours(next);
            const u32 further = one == last ? other : one;
            last = next;
            next = further;
        }
    }
    return true;
}

bool Planner::find_holes(u32 vertex) {
    const EditableMesh& mesh = surface_.mesh;
    const OriginalSurface& original = surface_.original;
    mesh.ring(vertex, ring_);
    const u32 size = static_cast<u32>(ring_.size());
    if (size > limits_.max_valence || size < 3) return false;
    star_.clear();
    mesh.for_each_around(vertex, [&](u32 half_edge) { star_.push_back(half_edge); });

    const VertexClass kind = original.vertex_class(vertex);
    u32 begin[2] = {0, 0}, corners[2] = {size, 0};
    hole_count_ = 1;
    if (kind == VertexClass::crease) {
        // The line's neighbours in the mesh are the first vertices left on the line in both directions.
        u32 ends[2];
        std::size_t found = 0;
        for (u32 next : original.line_neighbours(vertex)) {
            u32 last = vertex;
            while (!mesh.is_used(next)) {
                const auto [one, other] = original.line_neighbours(next);
                const u32 further = one == last ? other : one;
                last = next;
                next = further;
            }
            ends[found++] = next;
        }
        if (ends[0] == ends[1] || mesh.has_edge(ends[0], ends[1])) return false;
        u32 positions[2] = {size, size};
        for (u32 i = 0; i < size; ++i)
            for (int e = 0; e < 2; ++e)
                if (ring_[i] == ends[e]) positions[e] = i;
        if (positions[0] == size || positions[1] == size) return false;
        const u32 low = std::min(positions[0], positions[1]), high = std::max(positions[0], positions[1]);
        begin[0] = low, corners[0] = high - low + 1;
        begin[1] = high, corners[1] = size - (high - low) + 1;
        if (corners[0] < 3 || corners[1] < 3) return false;
        hole_count_ = 2;
        line_ends_[0] = ring_[low];
        line_ends_[1] = ring_[high];
    } else if (kind == VertexClass::boundary) {
        if (mesh.has_edge(ring_.front(), ring_.back())) return false;
        line_ends_[0] = ring_.front();
        line_ends_[1] = ring_.back();
    }
    for (std::size_t h = 0; h < hole_count_; ++h) {
        Hole& hole = holes_[h];
        hole.corners.clear();
        hole.points.clear();
        hole.up = Vec3::Zero();
        hole.is_closed_by_new_edge = kind != VertexClass::smooth;
        for (u32 i = 0; i < corners[h]; ++i) {
            const u32 at = (begin[h] + i) % size;
            hole.corners.push_back({at, ring_[at], original.position(ring_[at])});
        }
        const u32 triangles = kind == VertexClass::smooth ? size : corners[h] - 1;
        const Vec3& centre = original.position(vertex);
        double least_sine = limits_.angle_sine;
        for (u32 i = 0; i < triangles; ++i) {
            const Vec3 &a = hole.corners[i].position, &b = hole.corners[(i + 1) % corners[h]].position;
            const Vec3 normal = (a - centre).cross(b - centre);
            hole.up += normal;
            const double squares[3] = {(a - centre).squaredNorm(), (b - centre).squaredNorm(), (b - a).squaredNorm()};
            const double shortest = std::min({squares[0], squares[1], squares[2]});
            const double product = squares[0] * squares[1] * squares[2] / shortest;
            least_sine = std::min(least_sine, product > 0 ? normal.norm() / std::sqrt(product) : 0.0);
            surface_.for_each_point(star_[(begin[h] + i) % size] / 3, [&](u32 point) { hole.points.push_back(point); });
        }
        hole.angle_sine = least_sine * (1 - 1e-9);
        const double length = hole.up.norm();
        if (!(length > 0)) return false;
        hole.up /= length;
        if (kind == VertexClass::smooth) hole.points.push_back(vertex);
    }
    return true;
}

void Planner::plan(u32 vertex, Removal& removal) {
    removal.vertex = vertex;
    removal.is_possible = false;
    removal.triangles.clear();
    removal.errors.clear();
    removal.points.clear();
    removal.owners.clear();
    if (!find_holes(vertex)) { ++g_why[0]; return; }
    SignedErrors line;
    if (surface_.original.vertex_class(vertex) != VertexClass::smooth) {
        const Vec3 up = hole_count_ == 2 ? Vec3(holes_[0].up + holes_[1].up) : holes_[0].up;
        if (!add_line_errors(vertex, line_ends_[0], line_ends_[1], up, line)) { ++g_why[1]; return; }
    }
    for (std::size_t h = 0; h < hole_count_; ++h) {
        Hole& hole = holes_[h];
        if (!hole.triangulate(surface_, limits_)) { ++g_why[hole.triangles.empty() ? 2 : 3]; return; }
        const u32 first = static_cast<u32>(removal.triangles.size());
        for (std::size_t t = 0; t < hole.triangles.size(); ++t) {
            const auto& [i, k, j] = hole.triangles[t];
            removal.triangles.push_back(
                {hole.corners[i].ring_position, hole.corners[k].ring_position, hole.corners[j].ring_position});
            SignedErrors errors = hole.errors[t];
            errors.add(line);
            removal.errors.push_back(errors);
        }
        removal.points.insert(removal.points.end(), hole.points.begin(), hole.points.end());
        for (const u32 owner : hole.owners) removal.owners.push_back(first + owner);
    }
    if (folds(vertex, removal)) { ++g_why[4]; return; }
    if (intersects(removal, 0)) { ++g_why[5]; return; }
    removal.is_possible = true;
}

bool Planner::folds(u32, const Removal& removal) const {
    const EditableMesh& mesh = surface_.mesh;
    const u32 size = static_cast<u32>(ring_.size());
    const auto normal_of = [&](u32 a, u32 b, u32 c) {
        const Vec3& origin = surface_.original.position(a);
        return Vec3((surface_.original.position(b) - origin).cross(surface_.original.position(c) - origin));
    };
    const auto is_fold = [&](const Vec3& one, const Vec3& other) {
        return one.dot(other) < fold_cosine * std::sqrt(one.squaredNorm() * other.squaredNorm());
    };
    std::vector<u32> valence_change(size, 0);
    for (std::size_t t = 0; t < removal.triangles.size(); ++t) {
        const auto& triangle = removal.triangles[t];
        const Vec3 normal = normal_of(ring_[triangle[0]], ring_[triangle[1]], ring_[triangle[2]]);
        for (u32 i = 0; i < 3; ++i) {
            const u32 a = triangle[i], b = triangle[(i + 1) % 3];
            ++valence_change[a];
            if (b == (a + 1) % size && a < star_.size()) {
                const u32 outside = mesh.opposite(mesh.after(star_[a]));
                if (outside != half_edges::boundary &&
                    is_fold(normal, normal_of(mesh.start(outside), mesh.end(outside), mesh.apex(outside))))
                    return true;
                continue;
            }
            for (std::size_t other = t + 1; other < removal.triangles.size(); ++other)
                for (u32 k = 0; k < 3; ++k) {
                    const auto& o = removal.triangles[other];
                    if (o[k] == b && o[(k + 1) % 3] == a &&
                        is_fold(normal, normal_of(ring_[o[0]], ring_[o[1]], ring_[o[2]])))
                        return true;
                }
        }
    }
    // Each vertex of the ring loses two triangles of the star (one at an end of an open ring).
    for (u32 i = 0; i < size; ++i)
        if (valence_change[i] > 2 && mesh.valence(ring_[i]) + valence_change[i] - 2 > limits_.max_valence) return true;
    return false;
}

bool Planner::intersects(const Removal& removal, u32 stamp) {
    const auto& positions = surface_.all_positions();
    const EditableMesh& mesh = surface_.mesh;
    mesh.ring(removal.vertex, ring_);
    BoundingBox all;
    std::vector<BoundingBox> boxes;
    std::vector<Triangle> triangles;
    for (const auto& t : removal.triangles) {
        triangles.push_back({ring_[t[0]], ring_[t[1]], ring_[t[2]]});
        BoundingBox box;
        for (const u32 vertex : triangles.back()) box.add(positions[vertex]);
        all.add(box.low);
        all.add(box.high);
        boxes.push_back(box);
    }
    bool found = false;
    surface_.boxes().for_each_meeting(
        all,
        [&](u32 row) {
            if (found) return;
            const Triangle other = mesh.triangle(row);
            if (other[0] == removal.vertex || other[1] == removal.vertex || other[2] == removal.vertex) return;
            const BoundingBox box = surface_.box_of(row);
            int count = 0;
            for (std::size_t i = 0; i < triangles.size(); ++i) {
                const bool meet = (box.low.array() <= boxes[i].high.array()).all() &&
                                  (boxes[i].low.array() <= box.high.array()).all();
                count += meet && growing::intersect(positions, triangles[i], other);
            }
            if (count == 0) return;
            mesh.for_each_around(removal.vertex, [&](u32 half_edge) {
                count -= growing::intersect(positions, mesh.triangle(half_edge / 3), other);
            });
            found = count > 0;
        },
        stamp);
    return found;
}

void Planner::plan_flip(u32 half_edge, Removal& flip) {
    const EditableMesh& mesh = surface_.mesh;
    const OriginalSurface& original = surface_.original;
    flip.vertex = EditableMesh::none;
    flip.is_possible = false;
    flip.triangles.clear();
    flip.errors.clear();
    flip.points.clear();
    flip.owners.clear();
    const u32 other = mesh.opposite(half_edge);
    const u32 a = mesh.start(half_edge), b = mesh.end(half_edge), c = mesh.apex(half_edge), d = mesh.apex(other);
    const auto sine = [&](u32 u, u32 v, u32 w) {
        const Vec3 uv = original.position(v) - original.position(u), uw = original.position(w) - original.position(u),
                   vw = original.position(w) - original.position(v);
        const double squares[3] = {uv.squaredNorm(), uw.squaredNorm(), vw.squaredNorm()};
        const double product = squares[0] * squares[1] * squares[2] / std::min({squares[0], squares[1], squares[2]});
        return product > 0 ? uv.cross(uw).norm() / std::sqrt(product) : 0.0;
    };
    const double before = std::min(sine(a, b, c), sine(b, a, d)), after = std::min(sine(c, a, d), sine(d, b, c));
    if (!(after > before * (1 + 1e-9) + 1e-12) || !mesh.can_flip(half_edge)) return;
    if (mesh.valence(c) + 1 > limits_.max_valence || mesh.valence(d) + 1 > limits_.max_valence) return;
    ring_ = {a, d, b, c};
    Hole& hole = holes_[0];
    hole_count_ = 1;
    hole.corners.clear();
    hole.points.clear();
    for (u32 i = 0; i < 4; ++i) hole.corners.push_back({i, ring_[i], original.position(ring_[i])});
    const auto normal_of = [&](u32 u, u32 v, u32 w) {
        return Vec3((original.position(v) - original.position(u)).cross(original.position(w) - original.position(u)));
    };
    hole.up = normal_of(a, b, c) + normal_of(b, a, d);
    const double length = hole.up.norm();
    if (!(length > 0)) return;
    hole.up /= length;
    hole.angle_sine = 0;
    hole.is_closed_by_new_edge = false;
    for (const u32 row : {half_edge / 3, other / 3})
        surface_.for_each_point(row, [&](u32 point) { hole.points.push_back(point); });
    // The edge a b exists, so the only triangulation is the other one.
    if (!hole.triangulate(surface_, limits_)) return;
    // Rows: the one of half_edge becomes (d, c, a), the other (c, d, b): the first of the hole's triangles has corner 0.
    const bool first_has_a = hole.triangles[0][0] == 0 && hole.triangles[0][1] == 1;
    flip.points = hole.points;
    flip.owners = hole.owners;
    flip.errors = hole.errors;
    if (!first_has_a) {
        for (u32& owner : flip.owners) owner = 1 - owner;
        std::swap(flip.errors[0], flip.errors[1]);
    }
    const Triangle planned[2] = {{d, c, a}, {c, d, b}};
    const Vec3 normals[2] = {normal_of(d, c, a), normal_of(c, d, b)};
    const auto is_fold = [&](const Vec3& one, const Vec3& two) {
        return one.dot(two) < fold_cosine * std::sqrt(one.squaredNorm() * two.squaredNorm());
    };
    if (is_fold(normals[0], normals[1])) return;
    const std::pair<u32, int> outer[4] = {{mesh.before(half_edge), 0}, {mesh.after(other), 0}, {mesh.after(half_edge), 1}, {mesh.before(other), 1}};
    for (const auto& [h, i] : outer) {
        const u32 o = mesh.opposite(h);
        if (o != half_edges::boundary && is_fold(normals[i], normal_of(mesh.start(o), mesh.end(o), mesh.apex(o)))) return;
    }
    if (flip_intersects(half_edge, planned, 0)) return;
    flip.is_possible = true;
}

bool Planner::flip_intersects(u32 half_edge, const Triangle (&planned)[2], u32 stamp) const {
    const EditableMesh& mesh = surface_.mesh;
    const u32 rows[2] = {half_edge / 3, mesh.opposite(half_edge) / 3};
    BoundingBox all, boxes[2];
    for (int i = 0; i < 2; ++i)
        for (const u32 vertex : planned[i]) {
            boxes[i].add(surface_.original.position(vertex));
            all.add(surface_.original.position(vertex));
        }
    bool found = false;
    surface_.boxes().for_each_meeting(
        all,
        [&](u32 row) {
            if (found || row == rows[0] || row == rows[1]) return;
            const Triangle other = mesh.triangle(row);
            const BoundingBox box = surface_.box_of(row);
            int count = 0;
            for (int i = 0; i < 2; ++i) {
                const bool meet = (box.low.array() <= boxes[i].high.array()).all() &&
                                  (boxes[i].low.array() <= box.high.array()).all();
                count += meet && growing::intersect(surface_.all_positions(), planned[i], other);
            }
            if (count == 0) return;
            for (const u32 mine : rows) count -= growing::intersect(surface_.all_positions(), mesh.triangle(mine), other);
            found = count > 0;
        },
        stamp);
    return found;
}

double Planner::estimate(u32 vertex) {
    const VertexClass kind = surface_.original.vertex_class(vertex);
    if (kind == VertexClass::corner || !surface_.mesh.is_used(vertex)) return infinite;
    const EditableMesh& mesh = surface_.mesh;
    const Vec3& centre = surface_.original.position(vertex);
    Eigen::Matrix3d planes = Eigen::Matrix3d::Zero();
    double area = 0;
    double worst = 0;
    mesh.for_each_around(vertex, [&](u32 half_edge) {
        const Vec3 normal = (surface_.original.position(mesh.end(half_edge)) - centre)
                                .cross(surface_.original.position(mesh.apex(half_edge)) - centre);
        const double twice = normal.norm();
        if (!(twice > 0)) return;
        planes += normal * (normal.transpose() / twice);
        area += twice;
        const SignedErrors errors = surface_.errors(half_edge / 3);
        worst = std::max({worst, errors.outside, errors.inside});
    });
    double least = infinite;
    const auto offer = [&](u32 other) {
        const Vec3 to = surface_.original.position(other) - centre;
        least = std::min(least, to.dot(planes * to));
    };
    mesh.ring(vertex, ring_);
    for (const u32 other : ring_) offer(other);
    static const double beta = std::getenv("BETA") ? std::atof(std::getenv("BETA")) : 0.5;
    return std::sqrt(std::max(least, 0.0) / std::max(area, 1e-300)) + beta * worst;
}

}  // namespace scanmill::decimating
