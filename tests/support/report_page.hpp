// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Whether the report page and the sheet were built. They need Node and npm, which a build may lack.

#include <filesystem>

#include "support/folders.hpp"

namespace scanmill::test {

inline constexpr const char* no_report_page = "the report page is not built; it needs Node and npm";

inline bool has_report_page() {
    const std::filesystem::path folder = std::filesystem::path(build_folder()) / "share/scanmill/report";
    return std::filesystem::exists(folder / "page.html") && std::filesystem::exists(folder / "sheet.html");
}

}  // namespace scanmill::test
