// SPDX-License-Identifier: GPL-3.0-or-later
#include "alpha_solid/selection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "scanmill/geometry/tets/incremental_solid.hpp"

namespace scanmill::alpha {

namespace {

AlphaChoice choice_of(AlphaSearch search) {
    return search == AlphaSearch::binary ? AlphaChoice::binary : AlphaChoice::scan;
}

/// Distance from `alpha` to the range. The end of the range counts as a part of it.
double distance(const AlphaRange& range, double alpha) {
    return std::max(std::sqrt(range.from) - alpha, alpha - std::sqrt(range.to));
}

/// Whether the range contains the square of a double. There may be none between squares that differ in their last bits.
bool has_a_radius(const AlphaRange& range) {
    const double root = std::sqrt(range.from);
    const double least = root * root < range.from ? std::nextafter(root, range.to) : root;
    return least * least < range.to;
}

double number(std::string_view text) {
    double value = 0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

}  // namespace

std::string text_within(const AlphaInterval& interval, double alpha) {
    const bool is_above = interval.least > alpha;
    const double end = is_above ? interval.least : interval.largest;
    std::string text = fmt::format("{:.16e}", end);
    const int exponent = std::atoi(text.c_str() + text.find('e') + 1);
    for (int digits = 4; digits <= 17; ++digits) {
        const double last_place = number(fmt::format("1e{}", exponent + 1 - digits));
        for (double candidate : {end, is_above ? end + last_place : end - last_place}) {
            text = fmt::format("{:.{}g}", candidate, digits);
            if (const double value = number(text); value >= interval.least && value <= interval.largest) return text;
        }
    }
    return text;
}

/// The alpha-solid while alpha grows. Cells enter in groups of equal value. After each group, is_valid() tests the
/// solid.
class Selector::Ascent {
public:
    Ascent(const Selector& selector, const Selection& start)
        : selector_(selector),
          outside_(start.outside),
          vertices_(selector.one_component_ ? selector.tets_.positions.size() : 0) {
        solid_.emplace(selector.tets_, start.labels, start.defects.vertices);
        if (selector.one_component_) component_count_ = join_vertices(start.triangles, vertices_);
        if (selector.keeps_largest_) {
            components_.emplace(selector.tets_, start.labels);
            note_largest();
        }
    }

    bool at_hull() const { return outside_ == 0; }
    double next_value() const { return selector_.sweep_.values[outside_ - 1]; }
    std::size_t outside() const { return outside_; }

    /// Lets the next group enter.
    void step() {
        const std::size_t begin = selector_.sweep_.group_begin(outside_ - 1);
        const std::span<const u32> cells(selector_.sweep_.cells.data() + begin, outside_ - begin);
        outside_ = begin;
        if (components_) {
            solid_->add_joined(cells);
            components_->add(cells);
            return;
        }
        solid_->add(cells);
        // All points are covered, so new cells can only join components.
        if (component_count_ > 1)
            for (u32 cell : cells)
                for (u32 vertex : selector_.tets_.cells[cell])
                    component_count_ -= vertices_.unite(selector_.tets_.cells[cell][0], vertex);
    }

    /// With full coverage: whether the number of components is as requested. With less: whether a component has enough
    /// points; the largest component is then kept.
    bool has_required_component() {
        if (!components_) return component_count_ == 1;
        if (components_->most_points() < selector_.needed_) return false;
        follow_largest();
        return true;
    }

    IncrementalSolid& solid() { return *solid_; }

    AlphaRange range() const {
        const Array<double>& values = selector_.sweep_.values;
        return {values[outside_], at_hull() ? std::numeric_limits<double>::infinity() : values[outside_ - 1]};
    }

    bool is_valid() {
        triangles_.reset();
        if (!has_required_component()) return false;
        const IncrementalSolid::Verdict verdict = solid_->verdict();
        if (verdict != IncrementalSolid::Verdict::many_suspects) return verdict == IncrementalSolid::Verdict::manifold;
        const unsigned threads = selector_.context_.threads();
        triangles_ = boundary_triangles(selector_.tets_, solid_->labels(), threads);
        const BoundaryDefects defects = boundary_defects(*triangles_, selector_.tets_.positions.size(), threads);
        solid_->suspect_only(defects.vertices);
        return defects.vertices.empty();
    }
    /// Pre: is_valid() was true and no group has entered since.
    Selection valid_selection() {
        if (!triangles_)
            triangles_ = boundary_triangles(selector_.tets_, solid_->labels(), selector_.context_.threads());
        Selection selection;
        selection.outside = outside_;
        selection.labels = solid_->labels();
        selection.triangles = std::move(*triangles_);
        DisjointSets vertices(selector_.tets_.positions.size());
        selection.components = selector_.one_component_ ? 1 : join_vertices(selection.triangles, vertices);
        return selection;
    }

private:
    /// Keeps the largest component if another than the kept one may have as many points by now, or more. Components
    /// only gain points, so the choice stays valid as long as neither of the noted numbers changes.
    void follow_largest() {
        const bool is_noted = most_ == components_->most_points() && with_most_ == components_->components_with_most();
        const bool is_alone =
            components_->components_with_most() == 1 && solid_->covered() == components_->most_points();
        note_largest();
        if (is_noted || is_alone) return;
        const Selection largest = selector_.solid_without(outside_);
        solid_.emplace(selector_.tets_, largest.labels, largest.defects.vertices);
    }

    void note_largest() {
        most_ = components_->most_points();
        with_most_ = components_->components_with_most();
    }

    const Selector& selector_;
    std::optional<IncrementalSolid> solid_;
    std::size_t outside_;
    /// If one component is requested: the joined points, and the number of components left.
    DisjointSets vertices_;
    std::size_t component_count_ = 1;
    /// If the largest component is kept: the components, and their largest number of points and the number of
    /// components that have it, as of the last choice.
    std::optional<IncrementalComponents> components_;
    std::size_t most_ = 0, with_most_ = 0;
    /// The boundary, if the last test needed all of it.
    std::optional<Array<Triangle>> triangles_;
};

Selector::Selector(const TetMesh& tets, const SweepResult& sweep, const AlphaSolidParams& params, Context& context)
    : tets_(tets),
      sweep_(sweep),
      context_(context),
      search_(params.search),
      cover_(sweep.cover),
      needed_(sweep.needed) {
    const bool single = params.components == AlphaComponents::single;
    keeps_largest_ = single && params.coverage.value() < 1;
    one_component_ = single && !keeps_largest_;
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
    for (std::size_t i = 0; i < outside_cells; ++i) labels[sweep_.cells[i]] = outside;
    if (keeps_largest_) keep_largest_component(tets_, labels);
    return described(std::move(labels), outside_cells, choice_of(search_));
}

bool Selector::is_valid(const Selection& selection) const {
    if (!selection.defects.vertices.empty()) return false;
    if (one_component_ && selection.components != 1) return false;
    // From alpha_cover on, points can be missing only where components were left out.
    const bool is_covered = !keeps_largest_ && selection.outside <= sweep_.outside_above(cover_);
    return is_covered || covered_points(tets_, selection.labels) >= needed_;
}

Selection Selector::given(double value) const {
    Selection selection = solid_without(sweep_.outside_above(value));
    selection.choice = AlphaChoice::given;
    return selection;
}

Selector Selector::for_all_points() const {
    Selector all = *this;
    all.cover_ = sweep_.cover_all;
    all.needed_ = sweep_.points;
    all.one_component_ = true;
    all.keeps_largest_ = false;
    return all;
}

/// The smallest valid solid for a share is also valid for every smaller share. So is the smallest solid of one
/// component that is joined across facets, where repairs start. Therefore alpha never falls when the share grows. Only
/// repairs for all points start at a smaller alpha, from components that touch.
Selection Selector::scan() const {
    Selection chosen = scan_for_share();
    if (!keeps_largest_ || sweep_.values[chosen.outside] <= sweep_.cover_all) return chosen;
    Selection whole = for_all_points().scan_for_share();
    return sweep_.values[whole.outside] < sweep_.values[chosen.outside] ? std::move(whole) : std::move(chosen);
}

Selection Selector::scan_for_share() const {
    Selection start = solid_without(sweep_.outside_above(cover_));
    if (is_valid(start)) return start;

    Ascent ascent(*this, start);
    const double last = max_scan * max_scan * cover_;
    for (std::size_t steps = 0; !ascent.at_hull() && ascent.next_value() <= last; ++steps) {
        if (steps % 4096 == 0) context_.check_cancelled();
        ascent.step();
        if (!ascent.is_valid()) continue;
        Selection selection = ascent.valid_selection();
        assert(is_valid(described(selection.labels, selection.outside, AlphaChoice::scan)));
        return selection;
    }
    return repaired(start);
}

AlphaRange Selector::nearest_valid(double value) const {
    // Below alpha_cover points are left out.
    Ascent ascent(*this, solid_without(sweep_.outside_above(cover_)));
    const double alpha = std::sqrt(value);
    std::optional<AlphaRange> nearest;
    for (std::size_t steps = 0;; ++steps) {
        if (steps % 4096 == 0) context_.check_cancelled();
        // As alpha grows, ranges below `value` come nearer and ranges above it go farther away.
        const AlphaRange range = ascent.range();
        if (nearest && range.from > value && distance(range, alpha) > distance(*nearest, alpha)) return *nearest;
        if (has_a_radius(range) && ascent.is_valid()) {
            if (range.from > value) return range;
            nearest = range;
        }
        if (ascent.at_hull()) break;
        ascent.step();
    }
    assert(nearest);  // the hull is valid
    return *nearest;
}

std::optional<Selection> Selector::separate() const {
    assert(one_component_);
    Selector any = *this;
    any.one_component_ = false;
    // At alpha_cover all points are covered, so a larger alpha only joins components.
    if (any.solid_without(sweep_.outside_above(cover_)).components < 2) return std::nullopt;
    Selection selection = any.scan_for_share();
    if (selection.components < 2) return std::nullopt;
    return selection;
}

Selection Selector::repaired(const Selection& start) const {
    context_.check_cancelled();
    Ascent ascent(*this, start);
    while (!ascent.has_required_component()) ascent.step();

    Array<double> price(tets_.cells.size());
    std::ranges::fill(price, 0.0);
    for (std::size_t i = 0; i < ascent.outside(); ++i) price[sweep_.cells[i]] = sweep_.values[i];
    ascent.solid().repair(price, context_);

    Array<u8> labels = ascent.solid().labels();
    fill_cavities(tets_, labels);
    const bool is_hull = std::ranges::all_of(labels, [](u8 label) { return label == solid; });
    Selection selection =
        described(std::move(labels), ascent.outside(), is_hull ? AlphaChoice::hull : AlphaChoice::repaired);
    assert(is_valid(selection));
    return selection;
}

Selection Selector::bisect() const {
    // Every different alpha-solid from the hull (nothing outside) down to alpha_cover.
    const std::size_t cover = sweep_.outside_above(cover_);
    Array<std::size_t> candidates;
    for (std::size_t i = 0; i <= cover; ++i)
        if (i == 0 || sweep_.values[i] != sweep_.values[i - 1]) candidates.push_back(i);

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
