// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Parts of Markdown pages that are written from the filters' declarations, so that people write the rest of the page.

#include <string>
#include <string_view>

#include "scanmill/plugin/library.hpp"

namespace scanmill {

/// Replaces every part of the page between the lines `<!-- generated: WHAT -->` and `<!-- end -->`. WHAT is one of
/// - `filter NAME`: the ports, parameters, metrics and doubts of this filter;
/// - `filters LINK`: a table of all filters. LINK is the page of each, with `{filter}` for its name and `{folder}` for
///   its name with underscores;
/// - `doubts LINK`: a table that lists when filters doubt their results.
/// Throws Error, with the number of the line, for another WHAT, for an unknown filter, for a part without an end, and
/// if there is no such part.
std::string with_generated_parts(std::string_view page, const FilterLibrary& library);

}  // namespace scanmill
