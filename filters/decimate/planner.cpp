// SPDX-License-Identifier: GPL-3.0-or-later
#include "decimate/planner.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "scanmill/geometry/spatial/triangle_distance.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::decimating {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
/// Cosine of the largest angle between the normals of neighbours: 170 degrees. At larger angles, one triangle counts as
/// folded onto the other.
constexpr double fold_cosine = -0.984807753012208;

/// Cosine of 0.1 degrees: the surface is flat where no normal differs more from the mean.
constexpr double flat_cosine = 0.999998476913288;

bool meet(const BoundingBox& one, const BoundingBox& other) {
    return (one.low.array() <= other.high.array()).all() && (other.low.array() <= one.high.array()).all();
}

}  // namespace

Vec3 Planner::normal_of(const Triangle& t) const {
    return area_vector(surface_.position(t[0]), surface_.position(t[1]), surface_.position(t[2]));
}

double Planner::least_angle_sine(const Triangle& t) const {
    const double x = (surface_.position(t[1]) - surface_.position(t[0])).squaredNorm(),
                 y = (surface_.position(t[2]) - surface_.position(t[1])).squaredNorm(),
                 z = (surface_.position(t[0]) - surface_.position(t[2])).squaredNorm();
    const double longer_two = x * y * z / std::min({x, y, z});
    return longer_two > 0 ? normal_of(t).norm() / std::sqrt(longer_two) : 0.0;
}

void Planner::find_side(u32 vertex, u32 first, u32 corners, bool is_cut, Side& side) const {
    const u32 size = static_cast<u32>(ring_.size()), triangles = is_cut ? corners - 1 : corners;
    const auto at = [&](u32 i) { return (first + i) % size; };
    side.corners.clear();
    side.points.clear();
    side.old_errors.clear();
    side.old_edges.clear();
    side.ring_triangles.clear();
    side.up = Vec3::Zero();
    side.angle_sine = limits_.angle_sine;
    for (u32 i = 0; i < corners; ++i) side.corners.push_back({ring_[at(i)], at(i), surface_.position(ring_[at(i)])});
    for (u32 i = 0; i < triangles; ++i) {
        const u32 row = star_[at(i)] / 3;
        side.up += normal_of(surface_.mesh().triangle(row));
        side.angle_sine = std::min(side.angle_sine, least_angle_sine(surface_.mesh().triangle(row)));
        surface_.for_each_point(row, [&](u32 point) { side.points.push_back(point); });
        if (mode_ == DecimateMode::direct) continue;
        side.old_errors.push_back(surface_.errors(row));
        side.ring_triangles.push_back(i);
        if (!is_cut || i > 0)
            side.old_edges.push_back(
                {surface_.position(vertex), side.corners[i].position, {i, i > 0 ? i - 1 : triangles - 1}});
    }
    side.ring_triangles.resize(corners, triangles);
    side.up.normalize();
    side.is_height_field = true;
    for (u32 i = 0; i < triangles && mode_ == DecimateMode::accumulated; ++i)
        side.is_height_field =
            side.is_height_field && !(normal_of(surface_.mesh().triangle(star_[at(i)] / 3)).dot(side.up) < 0);
    bool is_flat = true;
    for (u32 i = 0; i < triangles && is_flat; ++i) {
        const Vec3 normal = normal_of(surface_.mesh().triangle(star_[at(i)] / 3));
        is_flat = normal.dot(side.up) >= flat_cosine * normal.norm();
    }
    if (is_flat) side.angle_sine = std::min(side.angle_sine, limits_.flat_angle_sine);
    side.angle_sine *= 1 - 1e-9;
}

bool Planner::find_sides(u32 vertex) {
    const EditableMesh& mesh = surface_.mesh();
    mesh.ring(vertex, ring_);
    const u32 size = static_cast<u32>(ring_.size());
    if (size < 3 || size > limits_.max_valence) return false;
    star_.clear();
    outside_.clear();
    mesh.for_each_around(vertex, [&](u32 half_edge) {
        star_.push_back(half_edge);
        outside_.push_back(mesh.opposite(EditableMesh::after(half_edge)));
    });
    const VertexClass kind = surface_.original.features().vertex_class(vertex);
    side_count_ = 1;
    if (kind == VertexClass::smooth) {
        find_side(vertex, 0, size, false, sides_[0]);
        sides_[0].points.push_back(vertex);
    } else {
        const auto [one, other] = surface_.line_ends(vertex, [](u32) {});
        const u32 a = static_cast<u32>(std::ranges::find(ring_, one) - ring_.begin()),
                  b = static_cast<u32>(std::ranges::find(ring_, other) - ring_.begin());
        if (a == b || a == size || b == size || mesh.has_edge(one, other)) return false;
        const u32 low = std::min(a, b), high = std::max(a, b);
        line_ends_[0] = ring_[low];
        line_ends_[1] = ring_[high];
        find_side(vertex, low, high - low + 1, true, sides_[0]);
        if (kind == VertexClass::crease) {
            find_side(vertex, high, size - (high - low) + 1, true, sides_[1]);
            side_count_ = 2;
        }
    }
    return std::all_of(sides_, sides_ + side_count_,
                       [](const Side& side) { return side.corners.size() >= 3 && side.up.norm() > 0.5; });
}

bool Planner::add_line_errors(u32 vertex) {
    const Vec3 &begin = surface_.position(line_ends_[0]), &end = surface_.position(line_ends_[1]);
    const Vec3 up = side_count_ == 2 ? Vec3(sides_[0].up + sides_[1].up) : sides_[0].up;
    SignedErrors all;
    const auto add = [&](u32 passed) {
        const Vec3& position = surface_.position(passed);
        const Vec3 off = position - nearest_on_segment(position, begin, end);
        all.add(off.norm(), off.dot(up) >= 0);
    };
    add(vertex);
    // In mode accumulated, errors grow by the distance between the old line and the new one, which is largest at the
    // vertex.
    const SignedErrors last = all;
    surface_.line_ends(vertex, add);
    line_ = mode_ == DecimateMode::direct ? all : last;
    return all.is_within(limits_.error);
}

bool Planner::triangulate(const Side& side, const Vec3* removed, Edit& edit) {
    const bool is_direct = mode_ == DecimateMode::direct;
    if (!is_direct && !side.is_height_field) return false;
    if (is_direct)
        direct_.begin(side.corners, side.up, side.points);
    else
        accumulated_.begin(side.corners, side.up, side.old_errors, side.old_edges, side.ring_triangles, removed, line_);
    HoleErrors& judge = is_direct ? static_cast<HoleErrors&>(direct_) : accumulated_;
    if (!triangulator_.triangulate(side.corners, side.up, side.angle_sine, limits_, judge, triangles_)) return false;
    if (is_direct) {
        if (!direct_.assign(triangles_, static_cast<u32>(edit.triangles.size()), edit.owners)) return false;
        edit.points.insert(edit.points.end(), side.points.begin(), side.points.end());
        for (HoleTriangle& triangle : triangles_) triangle.errors.add(line_);
    }
    for (const auto& [corners, errors] : triangles_) {
        const auto& [i, k, j] = corners;
        edit.triangles.push_back({side.corners[i].vertex, side.corners[k].vertex, side.corners[j].vertex});
        edit.ring_triangles.push_back(
            {side.corners[i].ring_position, side.corners[k].ring_position, side.corners[j].ring_position});
        edit.errors.push_back(errors);
    }
    return true;
}

void Planner::plan_removal(u32 vertex, Edit& edit) {
    edit.clear(vertex, false);
    line_ = {};
    if (!find_sides(vertex)) return;
    const bool is_smooth = surface_.original.features().vertex_class(vertex) == VertexClass::smooth;
    if (!is_smooth && !add_line_errors(vertex)) return;
    const Vec3* removed = is_smooth ? &surface_.position(vertex) : nullptr;
    for (std::size_t i = 0; i < side_count_; ++i)
        if (!triangulate(sides_[i], removed, edit)) return;
    for (const u32 half_edge : star_) edit.old_rows.push_back(half_edge / 3);
    // The triangulation avoids existing edges. A corner of a tetrahedron is the only remaining violation of the link
    // condition.
    if (ring_.size() == 3 && !surface_.mesh().can_remove(vertex, edit.ring_triangles)) return;
    edit.is_possible = !exceeds_valence(edit) && !folds(edit) && !intersects(edit, 0);
}

void Planner::plan_flip(u32 half_edge, Edit& edit) {
    edit.clear(half_edge, true);
    line_ = {};
    const EditableMesh& mesh = surface_.mesh();
    const u32 other = mesh.opposite(half_edge);
    const u32 a = mesh.start(half_edge), b = mesh.end(half_edge), c = mesh.apex(half_edge), d = mesh.apex(other);
    const Triangle old[2] = {{a, b, c}, {b, a, d}}, planned[2] = {{d, c, a}, {c, d, b}};
    const double before = std::min(least_angle_sine(old[0]), least_angle_sine(old[1])),
                 after = std::min(least_angle_sine(planned[0]), least_angle_sine(planned[1]));
    if (!(after > before * (1 + 1e-9) + 1e-12)) return;
    if (!mesh.can_flip(half_edge) || mesh.valence(c) >= limits_.max_valence || mesh.valence(d) >= limits_.max_valence)
        return;
    // Triangulates the polygon a d b c. The edge a b exists, so the other diagonal is the only choice.
    ring_ = {a, d, b, c};
    outside_ = {mesh.opposite(EditableMesh::after(other)), mesh.opposite(EditableMesh::before(other)),
                mesh.opposite(EditableMesh::after(half_edge)), mesh.opposite(EditableMesh::before(half_edge))};
    Side& side = sides_[0];
    side.corners.clear();
    side.points.clear();
    for (u32 i = 0; i < 4; ++i) side.corners.push_back({ring_[i], i, surface_.position(ring_[i])});
    side.up = (normal_of(old[0]) + normal_of(old[1])).normalized();
    if (!(side.up.norm() > 0.5)) return;
    side.angle_sine = 0;
    side.is_height_field = !(normal_of(old[0]).dot(side.up) < 0) && !(normal_of(old[1]).dot(side.up) < 0);
    edit.old_rows = {half_edge / 3, other / 3};
    for (const u32 row : edit.old_rows) surface_.for_each_point(row, [&](u32 point) { side.points.push_back(point); });
    side.old_errors = {surface_.errors(half_edge / 3), surface_.errors(other / 3)};
    side.old_edges = {{surface_.position(a), surface_.position(b), {0, 1}}};
    side.ring_triangles = {1, 1, 0, 0};
    if (!triangulate(side, nullptr, edit)) return;
    if (edit.triangles[0][0] != a || edit.triangles[0][1] != d || edit.triangles[0][2] != c) {
        std::swap(edit.triangles[0], edit.triangles[1]);
        std::swap(edit.errors[0], edit.errors[1]);
        for (u32& owner : edit.owners) owner = 1 - owner;
    }
    edit.is_possible = !folds(edit) && !intersects(edit, 0);
}

bool Planner::exceeds_valence(const Edit& edit) const {
    const bool is_open = surface_.mesh().is_boundary_vertex(edit.element);
    for (u32 i = 0; i < ring_.size(); ++i) {
        u32 triangles = 0;
        for (const auto& triangle : edit.ring_triangles) triangles += std::ranges::count(triangle, i);
        // A ring vertex has one new edge less than it has new triangles, and loses its edge to the removed vertex. At
        // both ends of an open ring, the edge that closes the ring is new as well.
        const u32 edges = is_open && (i == 0 || i + 1 == ring_.size()) ? triangles : triangles - 1;
        if (edges > 1 && surface_.mesh().valence(ring_[i]) + edges - 1 > limits_.max_valence) return true;
    }
    return false;
}

bool Planner::folds(const Edit& edit) const {
    const EditableMesh& mesh = surface_.mesh();
    const auto is_fold = [](const Vec3& one, const Vec3& other) {
        return one.dot(other) < fold_cosine * std::sqrt(one.squaredNorm() * other.squaredNorm());
    };
    for (std::size_t t = 0; t < edit.triangles.size(); ++t) {
        const Vec3 normal = normal_of(edit.triangles[t]);
        for (std::size_t i = 0; i < 3; ++i) {
            const u32 a = edit.triangles[t][i], b = edit.triangles[t][(i + 1) % 3];
            for (const u32 outside : outside_)
                if (outside != half_edges::boundary && mesh.start(outside) == b && mesh.end(outside) == a &&
                    is_fold(normal, normal_of(mesh.triangle(outside / 3))))
                    return true;
            for (std::size_t other = t + 1; other < edit.triangles.size(); ++other)
                for (std::size_t k = 0; k < 3; ++k)
                    if (edit.triangles[other][k] == b && edit.triangles[other][(k + 1) % 3] == a &&
                        is_fold(normal, normal_of(edit.triangles[other])))
                        return true;
        }
    }
    return false;
}

bool Planner::intersects(const Edit& edit, u32 stamp) {
    BoundingBox all;
    boxes_.clear();
    for (const Triangle& triangle : edit.triangles) {
        boxes_.push_back(surface_.box_of(triangle));
        all.add(boxes_.back().low);
        all.add(boxes_.back().high);
    }
    const auto intersect = [&](const Triangle& one, const Triangle& other) {
        return surface_.original.intersect(one, other);
    };
    bool found = false;
    surface_.boxes().for_each_meeting(
        all,
        [&](u32 row) {
            if (found || std::ranges::find(edit.old_rows, row) != edit.old_rows.end()) return;
            const Triangle other = surface_.mesh().triangle(row);
            const BoundingBox box = surface_.box_of(other);
            std::ptrdiff_t count = 0;
            for (std::size_t i = 0; i < boxes_.size(); ++i)
                count += meet(box, boxes_[i]) && intersect(edit.triangles[i], other);
            if (count == 0) return;
            // Intersections that existed before are allowed.
            for (const u32 old : edit.old_rows) count -= intersect(surface_.mesh().triangle(old), other);
            found = count > 0;
        },
        stamp);
    return found;
}

double Planner::estimate(u32 vertex) {
    const EditableMesh& mesh = surface_.mesh();
    if (!mesh.is_used(vertex) || surface_.original.features().vertex_class(vertex) == VertexClass::corner)
        return infinite;
    const Vec3& centre = surface_.position(vertex);
    Eigen::Matrix3d planes = Eigen::Matrix3d::Zero();
    double twice_area = 0;
    mesh.for_each_around(vertex, [&](u32 half_edge) {
        const Vec3 normal = normal_of(mesh.triangle(half_edge / 3));
        const double length = normal.norm();
        if (!(length > 0)) return;
        planes += normal * (normal.transpose() / length);
        twice_area += length;
    });
    if (!(twice_area > 0)) return 0;
    double least = infinite;
    mesh.ring(vertex, ring_);
    for (const u32 other : ring_) {
        const Vec3 to = surface_.position(other) - centre;
        least = std::min(least, to.dot(planes * to));
    }
    return std::sqrt(std::max(least, 0.0) / twice_area);
}

}  // namespace scanmill::decimating
