// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The declaration of a filter as an example workflow, and as a page in Markdown.

#include <string>
#include <string_view>

#include "scanmill/plugin/library.hpp"

namespace scanmill {

/// A whole workflow with this filter, every parameter at its default. Inputs that no file can hold are made by the
/// first filter of the library that can; if there is one, the workflow passes `scanmill check`.
std::string example_workflow(const FilterSpec& spec, const FilterLibrary& library);

/// The filter's page: ports, parameters, metrics and the example.
std::string filter_page(const FilterSpec& spec, const FilterLibrary& library);

/// The page that lists the pages of these filters.
std::string filter_index(const std::vector<FilterSpec>& specs);

/// Whether the text is one of these pages.
bool is_filter_page(std::string_view text);

/// The sentence about reading the scan in chunks. Pre: spec.streams.
std::string stream_text(const FilterSpec& spec);
/// A sentence that names the measured input and its truth.
std::string measures_text(const MeasureSpec& measures);

}  // namespace scanmill
