// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Writes an example workflow and a page in Markdown from the declaration of a filter.

#include <string>
#include <string_view>

#include "scanmill/plugin/library.hpp"

namespace scanmill {

/// A whole workflow with this filter, in which every parameter has its default. If no file can hold an input, the first
/// filter of the library that can make it is an earlier step. If such filters exist, the workflow passes `scanmill
/// check`.
std::string example_workflow(const FilterSpec& spec, const FilterLibrary& library);

/// The sections of the filter's page that come from its declaration: ports, parameters, metrics, doubts, details. They
/// begin with an empty line.
std::string filter_reference(const FilterSpec& spec);
/// The filter's page: filter_reference() and the example.
std::string filter_page(const FilterSpec& spec, const FilterLibrary& library);

/// Tables of the filters: what they take, give and do; and when they doubt their results. `link` is the page of a
/// filter, with `{filter}` for its name and `{folder}` for its name with underscores.
std::string filter_table(const std::vector<FilterSpec>& specs, std::string_view link);
std::string doubt_table(const std::vector<FilterSpec>& specs, std::string_view link);
/// The page that lists the pages of these filters.
std::string filter_index(const std::vector<FilterSpec>& specs);

/// Whether the text is one of these pages.
bool is_filter_page(std::string_view text);

/// A sentence that states when the filter reads the scan in chunks. Pre: spec.streams.
std::string stream_text(const FilterSpec& spec);
/// A text that names the input port of the measured value and that of the truth.
std::string measures_text(const MeasureSpec& measures);
/// A text that names the input port of the drawn value.
std::string draws_text(const DrawSpec& draws);
/// A text that names the input port of the mesh to simplify and the two parameters.
std::string simplifies_text(const SimplifySpec& simplifies);

}  // namespace scanmill
