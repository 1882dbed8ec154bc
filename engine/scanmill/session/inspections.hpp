// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The numbers of an inspected part, for pages.

#include <optional>

#include "scanmill/session/cell_files.hpp"
#include "scanmill/session/page_documents.hpp"

namespace scanmill {

/// Nothing if the step did not run.
std::optional<PageInspection> page_inspection(const InspectionStep& inspection);

}  // namespace scanmill
