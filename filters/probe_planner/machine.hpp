// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Simulates the probe beside the part: which moves are free, and what the ball meets first.
///
/// The ball's centre c moves along segments. The stylus is a capsule from c + r a to c + L a, where a is the machine's
/// axis. A clearance move is free if c keeps the distance r + clearance from the mesh, and the stylus' axis r_s +
/// clearance. An approach is free if the stylus' axis keeps r_s from all facets, and c keeps r from most facets. Facets
/// that reach into a ball around the touch are exempt.

#include "scanmill/data/probes.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill::probing {

struct Probe {
    double radius, clearance, stylus_radius, stylus_length;
    Vec3 axis;  ///< unit vector
};

struct FirstContact {
    ProbeContact contact;
    double distance;  ///< from T to the point that the ball meets; NaN without one
    Vec3 normal;  ///< from that point to the ball's centre, unit vector; 0 without one
};

class Machine {
public:
    /// Pre: the mesh has triangles, and their vertices are finite. `mesh` is not kept.
    Machine(const TriangleMesh& mesh, const Probe& probe, unsigned threads);

    bool is_move_free(const Vec3& from, const Vec3& to) const;
    /// Whether the approach of a ball from `start` to `end` is free. Facets within the distance `near` of `touch` are
    /// those to be touched.
    bool is_approach_free(const Vec3& touch, const Vec3& start, const Vec3& end, double near) const;

    /// Moves the ball from `start` against `direction`. Each step is as long as the ball's distance from the mesh,
    /// until they meet. The stylus is then moved along the same way. The contact is `edge` if the ball meets a point
    /// within `near` of the touch and the stylus meets nothing. It is `missed` if the centre passes the touch by more
    /// than `beyond`. This function is independent of those above: only distances of points decide for the ball.
    FirstContact first_contact(const Vec3& touch, const Vec3& start, const Vec3& direction, double near,
                               double beyond) const;

    /// The point above `centre` on the clearance plane, or `centre` itself if it is higher. The plane is perpendicular
    /// to the axis, r + clearance above the highest vertex.
    Vec3 lifted(const Vec3& centre) const;
    bool is_lift_free(const Vec3& centre) const { return is_move_free(centre, lifted(centre)); }
    /// The point of the clearance plane above the middle of the part's box.
    Vec3 home() const { return home_; }
    double diagonal() const { return diagonal_; }
    const TriangleTree& mesh() const { return tree_; }

private:
    bool stylus_meets(const Vec3& from, const Vec3& to, double clearance) const;

    Probe probe_;
    TriangleTree tree_;
    double plane_;  ///< height along the axis
    double diagonal_;
    Vec3 home_;
};

}  // namespace scanmill::probing
