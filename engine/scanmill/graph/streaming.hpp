// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Which scans are read piece by piece instead of being in memory as a whole: decided before anything runs.
///
/// A scan is streamed when everything that reads it is a step that can take it so. Whether its file can be read so is
/// known for certain when it is opened; one that cannot is read as a whole, with the same results.

#include "scanmill/graph/graph.hpp"

namespace scanmill {

/// Whether the step can take its scan as a stream: its filter says so, the parameters that it asks for have values, and
/// no parameter is in spacings, which take all points to measure.
bool can_stream(const PlannedStep& step);

/// Whether scans that feed this input of the workflow are streamed, as far as their files allow: points that every
/// step which reads them, at least one, can stream, and that are no output themselves.
bool is_streamed(const Plan& plan, std::size_t input);

/// Sets LeafSource::is_streamed of the leaves that are: as above, counting what the graph really runs and writes;
/// without a pose, and from a file that begins like one that can be streamed.
void mark_streams(RunGraph& graph);

}  // namespace scanmill
