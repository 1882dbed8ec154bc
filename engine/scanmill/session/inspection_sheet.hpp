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
/// A cell is a part if its workflow and variant have a step that inspects; if no step of the run
/// inspected, every cell that failed or is missing is one. Parts that failed, are missing or were not inspected come
/// first.
///
/// The pictures of a part are those that its workflow drew of the inspection, at most two, if their files are still as
/// they were recorded. If none is, a written output with the deviations is drawn, and kept as make_previews() keeps it.
/// The pictures have at most 40 MB together; further ones are left out, and a note says so.
///
/// Throws Error as compare_recorded() does, and if no such cell inspects a part.
SheetDocument sheet_document(const RecordedRun& which, const std::string& parts, FilterLibrary& library,
                             const PreviewSettings& settings, const std::function<void(std::string)>& warn);

}  // namespace scanmill
