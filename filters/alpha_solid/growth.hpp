// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// An alpha-solid while alpha grows, for the selector's search alone: cells enter level by level, and at every level it
/// is known what the solid holds and whether it is valid.

#include <limits>
#include <optional>
#include <span>

#include "alpha_solid/growing_pieces.hpp"
#include "alpha_solid/growing_solid.hpp"
#include "alpha_solid/selection.hpp"

namespace scanmill::alpha {

class Selector::Growth {
public:
    Growth(const Selector& selector, const Selection& start)
        : selector_(selector),
          outside_(start.outside),
          vertices_(selector.one_piece_ ? selector.tets_.positions.size() : 0) {
        growing_.emplace(selector.tets_, start.labels, start.defects.vertices);
        if (selector.one_piece_) pieces_ = join_vertices(start.triangles, vertices_);
        if (selector.keeps_largest_) {
            held_.emplace(selector.tets_, start.labels);
            note_judged();
        }
    }

    bool at_hull() const { return outside_ == 0; }
    double next_value() const { return selector_.flood_.values[outside_ - 1]; }
    std::size_t outside() const { return outside_; }

    void step() {
        const std::size_t begin = selector_.flood_.group_begin(outside_ - 1);
        const std::span<const u32> cells(selector_.flood_.cells.data() + begin, outside_ - begin);
        outside_ = begin;
        if (held_) {
            growing_->add_joined(cells);
            held_->add(cells);
            return;
        }
        growing_->add(cells);
        // Every point is covered, so pieces only merge.
        if (pieces_ > 1)
            for (u32 cell : cells)
                for (u32 vertex : selector_.tets_.cells[cell])
                    pieces_ -= vertices_.unite(selector_.tets_.cells[cell][0], vertex);
    }

    bool holds_enough() {
        if (!held_) return pieces_ == 1;
        if (held_->most() < selector_.needed_) return false;
        follow_largest();
        return true;
    }

    GrowingSolid& solid() { return *growing_; }

    AlphaRange range() const {
        const Array<double>& values = selector_.flood_.values;
        return {values[outside_], at_hull() ? std::numeric_limits<double>::infinity() : values[outside_ - 1]};
    }

    /// Judges the solid as it stands.
    bool is_valid() {
        triangles_.reset();
        if (!holds_enough()) return false;
        const GrowingSolid::Verdict verdict = growing_->verdict();
        if (verdict != GrowingSolid::Verdict::many_suspects) return verdict == GrowingSolid::Verdict::manifold;
        const unsigned threads = selector_.context_.threads();
        triangles_ = boundary_triangles(selector_.tets_, growing_->labels(), threads);
        const BoundaryDefects defects = boundary_defects(*triangles_, selector_.tets_.positions.size(), threads);
        growing_->suspect_only(defects.vertices);
        return defects.vertices.empty();
    }
    /// Pre: it was judged valid and has not grown since.
    Selection valid_selection() {
        if (!triangles_)
            triangles_ = boundary_triangles(selector_.tets_, growing_->labels(), selector_.context_.threads());
        Selection selection;
        selection.outside = outside_;
        selection.labels = growing_->labels();
        selection.triangles = std::move(*triangles_);
        DisjointSets vertices(selector_.tets_.positions.size());
        selection.components = selector_.one_piece_ ? 1 : join_vertices(selection.triangles, vertices);
        return selection;
    }

private:
    /// Another piece than the one that grew may hold the most points by now, or as many. Pieces only gain points, so as
    /// long as neither number changes the choice between equals stays.
    void follow_largest() {
        const bool is_judged = most_ == held_->most() && with_most_ == held_->pieces_with_most();
        const bool is_alone = held_->pieces_with_most() == 1 && growing_->covered() == held_->most();
        note_judged();
        if (is_judged || is_alone) return;
        const Selection largest = selector_.solid_without(outside_);
        growing_.emplace(selector_.tets_, largest.labels, largest.defects.vertices);
    }

    void note_judged() {
        most_ = held_->most();
        with_most_ = held_->pieces_with_most();
    }

    const Selector& selector_;
    std::optional<GrowingSolid> growing_;
    std::size_t outside_;
    /// When one piece is asked for: points joined by it, and the number of pieces left.
    DisjointSets vertices_;
    std::size_t pieces_ = 1;
    /// When the largest piece is kept: what the pieces hold, and what they held when the largest was last chosen.
    std::optional<GrowingPieces> held_;
    /// The boundary, when all of it was looked at for the last judgement.
    std::optional<Array<Triangle>> triangles_;
    std::size_t most_ = 0, with_most_ = 0;
};

}  // namespace scanmill::alpha
