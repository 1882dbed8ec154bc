// SPDX-License-Identifier: GPL-3.0-or-later
#include "probe_planner/machine.hpp"

#include <algorithm>

#include "scanmill/geometry/distance/swept_distance.hpp"
#include "scanmill/geometry/spatial/triangle_distance.hpp"

namespace scanmill::probing {

Machine::Machine(const TriangleMesh& mesh, const Probe& probe, unsigned threads)
    : probe_(probe),
      tree_(mesh.positions.span(), mesh.triangles.span(), threads) {
    double highest = -std::numeric_limits<double>::infinity();
    BoundingBox box;
    for (const Triangle& triangle : mesh.triangles)
        for (const u32 vertex : triangle) {
            highest = std::max(highest, probe.axis.dot(mesh.positions[vertex]));
            box.add(mesh.positions[vertex]);
        }
    plane_ = highest + probe.radius + probe.clearance;
    diagonal_ = box.diagonal();
    const Vec3 middle = (box.low + box.high) / 2;
    home_ = middle + (plane_ - probe.axis.dot(middle)) * probe.axis;
}

bool Machine::stylus_meets(const Vec3& from, const Vec3& to, double clearance) const {
    const Vec3 low = probe_.radius * probe_.axis, high = probe_.stylus_length * probe_.axis;
    return is_nearer_when_moved(tree_, {Vec3(from + low), Vec3(from + high)}, to - from,
                                probe_.stylus_radius + clearance);
}

bool Machine::is_move_free(const Vec3& from, const Vec3& to) const {
    return !is_nearer(tree_, std::array{from, to}, probe_.radius + probe_.clearance) &&
           !stylus_meets(from, to, probe_.clearance);
}

bool Machine::is_approach_free(const Vec3& touch, const Vec3& start, const Vec3& end, double near) const {
    const auto is_far = [&](u32 slot) { return tree_.squared_distance(touch, slot) > near * near; };
    return !is_nearer(tree_, std::array{start, end}, probe_.radius, is_far) && !stylus_meets(start, end, 0);
}

FirstContact Machine::first_contact(const Vec3& touch, const Vec3& start, const Vec3& direction, double near,
                                    double beyond) const {
    // The steps of a grazing ball become ever shorter. `least_step` is the shortest step, as a share of the radius.
    constexpr double least_step = 1e-4, precision = 1e-9;
    const double length = (start - touch).dot(direction) + beyond;
    u32 hint = NearestTriangle::none;
    for (double passed = 0; passed <= length;) {
        const Vec3 centre = start - passed * direction;
        const NearestTriangle nearest = tree_.nearest(centre, hint);
        hint = nearest.slot;
        const double gap = std::sqrt(nearest.squared_distance) - probe_.radius;
        if (gap < precision * probe_.radius) {
            const Vec3 point = tree_.nearest_point(centre, nearest.slot);
            const double distance = (point - touch).norm();
            const bool is_edge = distance <= near && !stylus_meets(start, centre, 0);
            return {is_edge ? ProbeContact::edge : ProbeContact::elsewhere, distance, (centre - point).normalized()};
        }
        passed += std::max(gap, least_step * probe_.radius);
    }
    return {ProbeContact::missed, ProbeTouch::nan, Vec3::Zero()};
}

Vec3 Machine::lifted(const Vec3& centre) const {
    return centre + std::max(0.0, plane_ - probe_.axis.dot(centre)) * probe_.axis;
}

}  // namespace scanmill::probing
