// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What stands behind the help text of a declared parameter: bounds, words, sizes (see declare.hpp).

#include <string>
#include <utility>

#include "scanmill/filter/parameter.hpp"

namespace scanmill {

namespace constraint {
struct Low {
    Bound bound;
    void apply(ParameterSpec& spec) const { spec.low = bound; }
};
struct High {
    Bound bound;
    void apply(ParameterSpec& spec) const { spec.high = bound; }
};
struct InPlaceOfAValue {
    std::string text;
    void apply(ParameterSpec& spec) const {
        spec.word = text;
        spec.default_value = ParameterScalar(Word{text});
    }
};
struct Required {
    void apply(ParameterSpec& spec) const {
        spec.required = true;
        spec.default_value = std::monostate{};
    }
};
struct Size {
    std::size_t count;
    void apply(ParameterSpec& spec) const { spec.size = count; }
};
}  // namespace constraint

/// Lengths are compared as written, whatever their unit, so their bounds should be 0; angles in degrees, ratios as
/// fractions.
inline constraint::Low above(double value) { return {{value, false}}; }
inline constraint::Low at_least(double value) { return {{value, true}}; }
inline constraint::High below(double value) { return {{value, false}}; }
inline constraint::High at_most(double value) { return {{value, true}}; }
/// A word that may stand in place of a value, and is the default. Pre: the member is a std::optional, empty by default.
inline constraint::InPlaceOfAValue word(std::string text) { return {std::move(text)}; }
/// There is no sensible default: the workflow must give a value.
inline constexpr constraint::Required required{};
/// A list of exactly this many values.
inline constraint::Size size(std::size_t count) { return {count}; }

}  // namespace scanmill
