// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Openings: one or two flips, whatever they cost, after which an exposing step brings a deeper point to the boundary.

#include <optional>
#include <vector>

#include "scanmill/geometry/tets/vertex_stars.hpp"
#include "sculpt/criteria.hpp"

namespace scanmill::sculpting {

struct Opening {
    /// Sum of the gains of the flips and the exposing step.
    double gain = 0;
    /// Cells to remove in this order. `first` may be none; if `second` is none, there is no opening.
    u32 first = none, second = none;
};

class Openings {
public:
    /// Queries change the solid temporarily.
    Openings(CarvedSolid& solid, const StepCriteria& criteria);

    /// Returns the next opening. Interior points are processed in rounds: in each round, those that can be reached are
    /// ordered by falling gain. Returns no opening after a round in which no point could be reached. Pre: no exposing
    /// step is left.
    Opening next();

    enum class Reason { blocked, deep };
    /// Reason why an interior point was not reached.
    Reason reason(u32 vertex);
    /// Vertices of the solid that are not on its boundary, ascending.
    Array<u32> interior_points();

private:
    struct Candidate {
        double gain;
        u32 vertex;
    };

    void start_round();
    VertexStars& stars();
    Opening best_for(u32 vertex);
    void consider(Opening& best, u32 vertex, u32 below);
    void consider_after(Opening& best, u32 first, u32 second, u32 below, double gain_of_first);
    bool is_interior(u32 vertex) { return !solid_.is_on_boundary(vertex) && solid_.has(stars().any_cell(vertex)); }

    CarvedSolid& solid_;
    const TetMesh& tets_;
    const StepCriteria& criteria_;
    std::vector<Candidate> round_;
    std::size_t next_in_round_ = 0;
    bool reached_ = true;
    std::optional<VertexStars> stars_;  ///< empty until it is needed
};

}  // namespace scanmill::sculpting
