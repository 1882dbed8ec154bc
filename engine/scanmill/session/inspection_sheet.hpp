// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Inspected parts as pages for paper.

#include <functional>
#include <string>

#include "scanmill/compare/recorded.hpp"
#include "scanmill/session/page_documents.hpp"
#include "scanmill/session/previews.hpp"

namespace scanmill {

inline constexpr const char* sheet_page = "sheet.html";  ///< name of the template

/// The data of one sheet per part. `parts` names them: a scan, 'SCAN [VARIANT]', a folder of scans, or "." for all.
/// A cell is a part if its workflow and variant have a step that inspects. Parts that failed come first, then in the order of the run.
///
/// The pictures of a part are those that its workflow drew of the inspection, at most two. Without such a picture that
/// still is as it was recorded, one of the written deviations is drawn, and kept as make_previews() keeps it. The
/// pictures have at most 40 MB together; of more, those of the last parts are left out, and a note says so.
///
/// Throws Error as compare_recorded() does, and if no such cell inspects a part.
SheetDocument sheet_document(const RecordedRun& which, const std::string& parts, FilterLibrary& library,
                             const PreviewSettings& settings, const std::function<void(std::string)>& warn);

}  // namespace scanmill
