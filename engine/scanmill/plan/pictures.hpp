// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Pictures beside the outputs of a workflow whose file has no step that draws them.

#include "scanmill/plan/plan.hpp"

namespace scanmill {

/// The names of the filters that draw a value and need no other input.
std::vector<std::string> drawing_filters(const FilterLibrary& library);

/// make_plan() of the workflow with one more step and one more output: a picture of the last surface among its outputs.
///
/// - The surface is the last output that is a mesh or patches in any variant, or else the last output of another kind
///   that the drawing filter takes. A variant in which this output has a kind that the filter does not take gets no
///   picture.
/// - The picture's file has the name of that output with the extension `.png`, and `-picture` before it if another
///   output has this name.
/// - The step is named `picture-VALUE`, with a number if a step or an input has this name.
///
/// Reports errors of the workflow, no or several drawing filters, and a workflow without an output that can be drawn.
Plan make_plan_with_picture(Workflow workflow, const FilterLibrary& library, const Settings& settings,
                            Diagnostics& diagnostics);

}  // namespace scanmill
