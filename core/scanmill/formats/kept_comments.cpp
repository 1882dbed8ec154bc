// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/kept_comments.hpp"

#include <optional>

#include "scanmill/formats/reading.hpp"

namespace scanmill {

namespace {

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
    if (place == 0) {
        place = texts_.size();
        texts_.emplace_back();
    }
    texts_[place] = comment;
}

void KeptComments::append(const KeptComments& following) {
    for (const std::string& text : following.texts_) add(text);
    added_ += following.others();
}

}  // namespace scanmill
