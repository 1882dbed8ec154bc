// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The report of a recorded run as one HTML file, which opens from disk and needs nothing else.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "scanmill/compare/recorded.hpp"
#include "scanmill/session/page_documents.hpp"
#include "scanmill/session/previews.hpp"

namespace scanmill {

inline constexpr const char* report_page = "page.html";  ///< name of the template

/// The data of the page: the comparison of `which` with `against`, as compare_recorded() makes it; steps, parameters
/// and logs from the records; the values of the last `most_nights` runs of the batch; and previews, which are made
/// where they are missing (make_previews()).
///
/// A page has at most `limits.cells` cells, and pictures of at most `limits.pictured` of them: the cells with the worst
/// verdicts, and of equal ones the first. Counts and rules are those of all cells, changes those of the shown ones.
///
/// The data have at most about 15 MB for up to 80 cells, and 40 MB for more. Above that, the page leaves out its
/// largest views in 3D, and then its largest pictures. Its notes count what it leaves out.
///
/// Cost: reads the records of the compared runs and of `most_nights` earlier ones, and makes the missing previews.
constexpr std::size_t most_nights = 30;
struct PageLimits {
    std::size_t cells = 5000, pictured = 1000;
};
PageDocument page_document(const RecordedRun& which, const std::optional<RecordedRun>& against,
                           const CommandFor& command, FilterLibrary& library, const PreviewSettings& settings,
                           const std::function<void(std::string)>& warn, const PageLimits& limits = {});

}  // namespace scanmill
