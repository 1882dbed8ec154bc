// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A part of a batch's cells, chosen by name: to run one cell again.

#include <string>
#include <vector>

#include "scanmill/batch/batch.hpp"

namespace scanmill {

/// Empty lists choose everything.
struct BatchChoice {
    std::vector<std::string> scans;      ///< paths from the batch's folder, or as they were found
    std::vector<std::string> workflows;  ///< names
    std::vector<std::string> variants;

    bool is_all() const { return scans.empty() && workflows.empty() && variants.empty(); }
};

/// Leaves the chosen cells in the batch's parts. Throws Error for a name that is not in the batch, and for names that
/// together choose no cell.
void choose(CheckedBatch& batch, const BatchChoice& choice);

}  // namespace scanmill
