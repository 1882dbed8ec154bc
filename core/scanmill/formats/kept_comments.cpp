// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/kept_comments.hpp"

#include <optional>

#include "scanmill/formats/reading.hpp"

namespace scanmill {

namespace {

std::optional<LengthUnit> unit_of(std::string_view comment) { return length_unit(declaration_in(comment, "unit")); }

/// 0 to 2, for what the comment declares.
std::optional<std::size_t> kind_of(std::string_view comment) {
    if (!declaration_in(comment, "frame").empty()) return 2;
    const std::string_view unit = declaration_in(comment, "unit");
    if (unit.empty() || is_prose(unit)) return {};
    return length_unit(unit) ? 0 : 1;
}

}  // namespace

void KeptComments::add(std::string_view comment) {
    ++added_;
    if (added_ <= most) {
        texts_.emplace_back(comment);
        return;
    }
    const std::optional<std::size_t> kind = kind_of(comment);
    if (!kind) return;
    std::size_t& place = places_[*kind];
    if (*kind == 0 && place != 0 && unit_of(texts_[place]) != unit_of(comment)) keep_other_unit();
    if (place == 0) {
        place = texts_.size();
        texts_.emplace_back();
    }
    texts_[place] = comment;
}

void KeptComments::keep_other_unit() {
    if (other_unit_ == 0) {
        other_unit_ = places_[0];
        places_[0] = 0;
    } else
        texts_[other_unit_] = texts_[places_[0]];
}

void KeptComments::append(const KeptComments& following) {
    for (const std::string& text : following.texts_) add(text);
    added_ += following.others();
}

}  // namespace scanmill
