// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What a filter declares, as texts for people: an example workflow, and a page in Markdown.

#include <string>

#include "scanmill/filter/spec.hpp"

namespace scanmill {

/// A whole workflow with this filter alone, every parameter at its default. It passes `scanmill check` when the filter
/// takes nothing but points and meshes; inputs of other kinds stand in comments.
std::string example_workflow(const FilterSpec& spec);

/// The filter's page: ports, parameters, metrics and the example.
std::string filter_page(const FilterSpec& spec);

/// The page that lists the pages of these filters.
std::string filter_index(const std::vector<FilterSpec>& specs);

}  // namespace scanmill
