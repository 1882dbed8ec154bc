// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Hoppe's text of points: rows that begin with a letter, "p 0.1 0.2 0.3" for a point. Other letters stand for
/// attributes of what follows, such as d, s and g for its colours; those rows are left out and told.

#include "scanmill/formats/common/format.hpp"
#include "scanmill/formats/common/text_cursor.hpp"

namespace scanmill {

/// Whether the text's first row is one of p, d, s or g and three numbers.
bool are_tagged_points(std::string_view text);

/// The points of the text. Throws Error with the line for a row that is no single letter and numbers, or a point of
/// other than three numbers.
LoadedFile read_tagged_points(std::string_view text, const ReadOptions& options);

}  // namespace scanmill
