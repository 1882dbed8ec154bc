// SPDX-License-Identifier: GPL-3.0-or-later
#include "alpha_solid/selection.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "alpha_solid/growth.hpp"
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
      search_(params.search),
      cover_(flood.cover),
      needed_(flood.needed) {
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
    const bool is_covered = !keeps_largest_ && selection.outside <= flood_.outside_above(cover_);
    return is_covered || covered_points(tets_, selection.labels) >= needed_;
}

Selection Selector::given(double value) const {
    Selection selection = solid_without(flood_.outside_above(value));
    selection.choice = AlphaChoice::given;
    return selection;
}

Selector Selector::for_all_points() const {
    Selector all = *this;
    all.cover_ = flood_.cover_all;
    all.needed_ = flood_.points;
    all.one_piece_ = true;
    all.keeps_largest_ = false;
    return all;
}

/// For any share the least valid solid is one for every smaller share too, and so is the least in one piece, joined
/// across facets, where repairs start; so alpha never falls when the share grows. Only repairs for all points start
/// from less, from pieces that touch.
Selection Selector::scan() const {
    Selection chosen = scan_for_share();
    if (!keeps_largest_ || flood_.values[chosen.outside] <= flood_.cover_all) return chosen;
    Selection whole = for_all_points().scan_for_share();
    return flood_.values[whole.outside] < flood_.values[chosen.outside] ? std::move(whole) : std::move(chosen);
}

Selection Selector::scan_for_share() const {
    Selection start = solid_without(flood_.outside_above(cover_));
    if (is_valid(start)) return start;

    Growth growth(*this, start);
    const double last = max_scan * max_scan * cover_;
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
    Growth growth(*this, solid_without(flood_.outside_above(cover_)));
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

std::optional<Selection> Selector::apart() const {
    assert(one_piece_);
    Selector any = *this;
    any.one_piece_ = false;
    // All points are covered there, so a larger alpha only joins pieces.
    if (any.solid_without(flood_.outside_above(cover_)).components < 2) return std::nullopt;
    Selection selection = any.scan_for_share();
    if (selection.components < 2) return std::nullopt;
    return selection;
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
    const std::size_t cover = flood_.outside_above(cover_);
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
