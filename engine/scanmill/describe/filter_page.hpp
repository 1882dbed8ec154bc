// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What a filter declares, as texts for people: an example workflow, and a page in Markdown.

#include <string>
#include <string_view>

#include "scanmill/plugin/library.hpp"

namespace scanmill {

/// A whole workflow with this filter, every parameter at its default. What no file holds is made by the first filter of
/// the library that can; then, and when the filter takes nothing but points and meshes, it passes `scanmill check`.
std::string example_workflow(const FilterSpec& spec, const FilterLibrary& library);

/// The filter's page: ports, parameters, metrics and the example.
std::string filter_page(const FilterSpec& spec, const FilterLibrary& library);

/// The page that lists the pages of these filters.
std::string filter_index(const std::vector<FilterSpec>& specs);

/// Whether the text is such a page, or their list.
bool is_filter_page(std::string_view text);

/// When the filter reads its scan piece by piece, as a sentence. Pre: spec.streams.
std::string stream_text(const FilterSpec& spec);

}  // namespace scanmill
