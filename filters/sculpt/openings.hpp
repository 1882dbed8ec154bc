// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Getting at points that lie deeper: one or two flips, whatever they cost, after which an exposing step is possible.

#include <vector>

#include "sculpt/judge.hpp"

namespace scanmill::sculpting {

struct Opening {
    /// Of the flips and the exposing step together.
    double gain = 0;
    /// Cells to remove in this order; `first` may be none, and there is no opening when `second` is.
    u32 first = none, second = none;
};

class Openings {
public:
    /// The solid is changed while a question is answered, and then is what it was.
    Openings(CarvedSolid& solid, const Judge& judge);

    /// The next opening. Points inside are taken in rounds: each is looked at once, and those that can be reached are
    /// served by falling gain. Returns none after a round that reached nobody. Pre: no exposing step is left.
    Opening next();

    enum class Reason { blocked, deep };
    /// Why a point inside was not reached.
    Reason reason(u32 vertex);
    /// Vertices of the solid that are not on its boundary, ascending.
    Array<u32> interior_points();

private:
    struct Candidate {
        double gain;
        u32 vertex;
    };

    void find_anchors();
    void start_round();
    /// The cells round a vertex inside the solid.
    const std::vector<u32>& star(u32 vertex);
    Opening best_for(u32 vertex);
    void consider(Opening& best, u32 vertex, u32 below);
    void consider_after(Opening& best, u32 first, u32 second, u32 below, double gain_of_first);
    bool is_interior(u32 vertex) const { return anchor_[vertex] != none && !solid_.is_on_boundary(vertex); }

    CarvedSolid& solid_;
    const TetMesh& tets_;
    const Judge& judge_;
    std::vector<Candidate> round_;
    std::size_t next_in_round_ = 0;
    bool reached_ = true;
    /// Per vertex a cell of the solid at it; per cell when it was last visited. Empty until they are needed.
    Array<u32> anchor_, visited_;
    u32 visit_ = 0;
    std::vector<u32> star_;
};

}  // namespace scanmill::sculpting
