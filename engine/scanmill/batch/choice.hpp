// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Chooses cells of a batch by name, for example to run one cell again.

#include <string>
#include <vector>

#include "scanmill/batch/batch.hpp"

namespace scanmill {

/// Names of the chosen scans, workflows and variants. An empty list chooses all.
struct BatchChoice {
    std::vector<std::string> scans;      ///< paths relative to the batch's folder, or as BatchScan::file
    std::vector<std::string> workflows;  ///< names
    std::vector<std::string> variants;

    bool is_all() const { return scans.empty() && workflows.empty() && variants.empty(); }
};

/// Removes all cells that are not chosen from the batch's parts. Throws Error for a name that is not in the batch, and
/// for names that together choose no cell.
void choose(CheckedBatch& batch, const BatchChoice& choice);

}  // namespace scanmill
