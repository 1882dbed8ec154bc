// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The table that `run` and `batch` print after a run.

#include <filesystem>
#include <optional>
#include <string>

#include "scanmill/graph/graph.hpp"
#include "scanmill/worker/report.hpp"

namespace scanmill::runner {

/// How much of a run its table shows. Neither hides a failure: failed and doubtful cells come first if there are too
/// many.
enum class TableExtent {
    /// The numbers of the cell's result, in at most 100 columns (fewer on a narrower terminal) and at most 50 rows: the
    /// properties of the mesh that the last geometric step wrote, the headline metrics of steps that measure it, and
    /// those of the step itself. What does not fit is left out from the right, and a line says so.
    result,
    everything,  ///< a column for every headline metric of every step, and every file, however wide
};

/// A table with one row per cell: scan, outcome, numbers, seconds, files. A column has the numbers of one step of each
/// cell; if a cell has a metric of one name from several steps, the columns are named `step.metric`. Cells of one scan
/// share a row if a file of the scan could not be read. Lengths, areas and volumes are in the scan's unit. If all scans
/// of a column declare one unit, its header names the unit; if they differ, each cell does. Lines about doubtful and
/// failed cells follow. `width`: columns of the terminal; empty if stdout is not a terminal.
std::string run_table(const RunGraph& graph, const RunReport& report, TableExtent extent,
                      std::optional<std::size_t> width = {});

/// The path from the working folder, unless it is outside of it.
std::string shown_path(const std::filesystem::path& file);

}  // namespace scanmill::runner
