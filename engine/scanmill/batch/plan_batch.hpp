// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A batch and its workflows, checked together: which plan every scan runs under.

#include <memory>
#include <vector>

#include "scanmill/batch/batch.hpp"
#include "scanmill/plan/plan.hpp"

namespace scanmill {

/// One workflow under one set of values, and the scans that take it.
struct BatchPart {
    std::shared_ptr<const Plan> plan;
    std::size_t workflow = 0;        ///< index into Batch::workflows
    std::vector<std::size_t> scans;  ///< indices into Batch::scans, ascending
};

struct CheckedBatch {
    Batch batch;
    /// Workflow by workflow, within one in the order of the first scan. A workflow whose first input is a list takes
    /// all scans of a part at once.
    std::vector<BatchPart> parts;
    /// Of the batch file, then of each workflow that could be read, over all the values it is run with.
    std::vector<Diagnostics> diagnostics;

    /// With errors no part must be run.
    bool has_errors() const;
    /// Variants of all workflows; one that several parts of a workflow have counts once.
    std::size_t variants() const;
    /// Scans times variants, over all workflows.
    std::size_t cells() const;
};

/// Checks the batch in `text`, which stands in `file`. A scan's values are the batch's `set`, overridden by its own, as
/// far as the workflow declares their names; scans with equal values share a part, and its plan is made once. What is
/// wrong with a value is told where it stands in the batch; a name that none of the workflows declares is, too.
CheckedBatch check_batch(const std::string& text, const std::string& file, const FilterLibrary& library);

}  // namespace scanmill
