// SPDX-License-Identifier: GPL-3.0-or-later
#include "alpha_solid/selection.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "alpha_solid/growing_pieces.hpp"
#include "alpha_solid/growing_solid.hpp"
#include "alpha_solid/pieces.hpp"

namespace scanmill::alpha {

namespace {

AlphaChoice choice_of(AlphaSearch search) {
    return search == AlphaSearch::binary ? AlphaChoice::binary : AlphaChoice::scan;
}

/// From `alpha` to the nearest radius in the range; to its end where that lies below, though it is not in the range.
double distance(const AlphaRange& range, double alpha) {
    return std::max(std::sqrt(range.from) - alpha, alpha - std::sqrt(range.to));
}

/// No number may lie between two squares that differ in their last bits.
bool has_a_radius(const AlphaRange& range) {
    const double root = std::sqrt(range.from);
    const double least = root * root < range.from ? std::nextafter(root, range.to) : root;
    return least * least < range.to;
}

}  // namespace

Selector::Selector(const TetMesh& tets, const Flood& flood, const AlphaSolidParams& params, Context& context)
    : tets_(tets),
      flood_(flood),
      context_(context),
      search_(params.search) {
    const bool single = params.components == AlphaComponents::single;
    keeps_largest_ = single && params.coverage.value() < 1;
    one_piece_ = single && !keeps_largest_;
}

Selection Selector::described(Array<u8> labels, std::size_t outside, AlphaChoice choice) const {
    Selection selection;
    selection.outside = outside;
    selection.choice = choice;
    selection.triangles = boundary_triangles(tets_, labels, context_.threads());
    selection.defects = boundary_defects(selection.triangles, tets_.positions.size(), context_.threads());
    DisjointSets vertices(tets_.positions.size());
    selection.components = join_vertices(selection.triangles, vertices);
    selection.labels = std::move(labels);
    return selection;
}

Selection Selector::solid_without(std::size_t outside_cells) const {
    context_.check_cancelled();
    Array<u8> labels(tets_.cells.size());
    std::ranges::fill(labels, solid);
    for (std::size_t i = 0; i < outside_cells; ++i) labels[flood_.cells[i]] = outside;
    if (keeps_largest_) keep_largest_piece(tets_, labels);
    return described(std::move(labels), outside_cells, choice_of(search_));
}

bool Selector::is_valid(const Selection& selection) const {
    if (!selection.defects.vertices.empty()) return false;
    if (one_piece_ && selection.components != 1) return false;
    // From alpha_cover on, only what was left out can be missing.
    const bool is_covered = !keeps_largest_ && selection.outside <= flood_.outside_above(flood_.cover);
    return is_covered || covered_points(tets_, selection.labels) >= flood_.needed;
}

Selection Selector::given(double value) const {
    Selection selection = solid_without(flood_.outside_above(value));
    selection.choice = AlphaChoice::given;
    return selection;
}

/// An alpha-solid while alpha grows: cells enter level by level.
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
        if (held_->most() < selector_.flood_.needed) return false;
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

Selection Selector::scan() const {
    Selection start = solid_without(flood_.outside_above(flood_.cover));
    if (is_valid(start)) return start;

    Growth growth(*this, start);
    const double last = max_scan * max_scan * flood_.cover;
    for (std::size_t steps = 0; !growth.at_hull() && growth.next_value() <= last; ++steps) {
        if (steps % 4096 == 0) context_.check_cancelled();
        growth.step();
        if (!growth.is_valid()) continue;
        Selection selection = growth.valid_selection();
        assert(is_valid(described(selection.labels, selection.outside, AlphaChoice::scan)));
        return selection;
    }
    return repaired(start);
}

AlphaRange Selector::nearest_valid(double value) const {
    // Below alpha_cover points are left out.
    Growth growth(*this, solid_without(flood_.outside_above(flood_.cover)));
    const double alpha = std::sqrt(value);
    std::optional<AlphaRange> nearest;
    for (std::size_t steps = 0;; ++steps) {
        if (steps % 4096 == 0) context_.check_cancelled();
        // While alpha grows, ranges below `value` come nearer, those above go farther away.
        const AlphaRange range = growth.range();
        if (nearest && range.from > value && distance(range, alpha) > distance(*nearest, alpha)) return *nearest;
        if (has_a_radius(range) && growth.is_valid()) {
            if (range.from > value) return range;
            nearest = range;
        }
        if (growth.at_hull()) break;
        growth.step();
    }
    assert(nearest);  // the hull is valid
    return *nearest;
}

Selection Selector::repaired(const Selection& start) const {
    context_.check_cancelled();
    Growth growth(*this, start);
    while (!growth.holds_enough()) growth.step();

    Array<double> price(tets_.cells.size());
    std::ranges::fill(price, 0.0);
    for (std::size_t i = 0; i < growth.outside(); ++i) price[flood_.cells[i]] = flood_.values[i];
    growth.solid().repair(price);

    Array<u8> labels = growth.solid().labels();
    fill_cavities(tets_, labels);
    const bool is_hull = std::ranges::all_of(labels, [](u8 label) { return label == solid; });
    Selection selection =
        described(std::move(labels), growth.outside(), is_hull ? AlphaChoice::hull : AlphaChoice::repaired);
    assert(is_valid(selection));
    return selection;
}

Selection Selector::bisect() const {
    // Every different alpha-solid from the hull (nothing outside) down to alpha_cover.
    const std::size_t cover = flood_.outside_above(flood_.cover);
    Array<std::size_t> candidates;
    for (std::size_t i = 0; i <= cover; ++i)
        if (i == 0 || flood_.values[i] != flood_.values[i - 1]) candidates.push_back(i);

    Selection best = solid_without(cover);
    if (is_valid(best)) return best;
    std::size_t valid = 0, invalid = candidates.size() - 1;
    best = solid_without(candidates[valid]);
    while (invalid - valid > 1) {
        const std::size_t middle = valid + (invalid - valid) / 2;
        Selection selection = solid_without(candidates[middle]);
        if (is_valid(selection)) {
            valid = middle;
            best = std::move(selection);
        } else {
            invalid = middle;
        }
    }
    return best;
}

}  // namespace scanmill::alpha
