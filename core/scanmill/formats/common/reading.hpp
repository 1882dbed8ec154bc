// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What every reader needs: telling warnings, quoting doubtful bytes, the frame that a file declares, and positions
/// near their origin.

#include <fmt/format.h>

#include <map>

#include "scanmill/base/text.hpp"
#include "scanmill/data/columns.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/formats/common/format.hpp"

namespace scanmill {

template <class... Arguments>
void warn(const std::function<void(std::string)>& on_warning, fmt::format_string<Arguments...> sentence,
          Arguments&&... arguments) {
    if (on_warning) on_warning(fmt::format(sentence, std::forward<Arguments>(arguments)...));
}

/// Text editors of Windows begin a file with a mark of three bytes.
std::string_view without_byte_order_mark(std::string_view text);

/// What follows `keyword` and a blank in a comment, without blanks around it; empty when the comment does not begin so.
std::string_view declaration_in(std::string_view comment, std::string_view keyword);
/// Whether what follows "unit" is a sentence that happens to begin so.
bool is_prose(std::string_view unit);

/// Unit and name as declared by lines "unit mm" and "frame NAME" among the comments; the options' unit counts more. A
/// unit that is none is told.
Frame declared_frame(const std::vector<std::string>& comments, const ReadOptions& options);

/// Length exponents of columns by name, as declared by comments "length-exponent N NAME".
std::map<std::string, int, std::less<>> declared_exponents(const std::vector<std::string>& comments);
/// The columns with their declared exponents.
ColumnTable with_exponents(const ColumnTable& columns, const std::vector<std::string>& comments);

/// Throws Error unless `count` elements can be numbered with 32 bits.
void require_countable(u64 count, std::string_view elements);

/// Chooses frame.origin for world positions that lie in `box` and makes them relative to it.
void move_near_origin(Array<Vec3>& positions, const BoundingBox& box, Frame& frame);

}  // namespace scanmill
