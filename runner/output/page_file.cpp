// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/page_file.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "commands/common.hpp"
#include "output/reproduce.hpp"
#include "output/terminal.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/io/atomic_file.hpp"
#include "scanmill/session/inspection_sheet.hpp"
#include "scanmill/session/page_template.hpp"
#include "scanmill/session/report_page.hpp"
#include "scanmill/session/session.hpp"

namespace scanmill::runner {

namespace {

/// Throws Error for a file that exists and is not a page, such as the records or a result.
void require_replaceable(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return;
    std::string text;
    if (std::filesystem::is_regular_file(file, ignored)) {
        std::ifstream stream(file, std::ios::binary);
        text.assign(std::istreambuf_iterator<char>(stream), {});
    }
    if (!is_page(text))
        throw Error("'{}' exists and is not a page of this program", file.string())
            .hint("choose another name for the page");
}

PreviewSettings preview_settings(std::optional<unsigned> jobs) {
    PreviewSettings settings;
    settings.jobs = jobs.value_or(usable_cores());
    settings.worker_command = {"/proc/self/exe", "worker"};
    return settings;
}

/// Writes the page with the data of `document`.
template <class Document>
void write(const std::filesystem::path& file, std::string page, const Document& document) {
    std::error_code ignored;  // the file then cannot be written, either
    if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), ignored);
    try {
        AtomicFile written(file);
        written.write(page_with(std::move(page), json_of(document)));
        written.commit();
    } catch (const Error& error) {
        throw error.reworded(fmt::format("'{}' {}", file.string(), error.sentence()));
    }
    for (const std::string& note : document.notes) print_warning(note);
}

}  // namespace

void write_page_file(const std::filesystem::path& file, const RecordedRun& which,
                     const std::optional<RecordedRun>& against, std::optional<unsigned> jobs) {
    std::string page = page_template(report_page);
    require_replaceable(file);
    FilterLibrary library = open_library();
    const PageDocument document =
        page_document(which, against, reproducing_command, library, preview_settings(jobs), warning_printer());
    write(file, std::move(page), document);
    fmt::print("the page of {} is {}\n", printable_line(document.batch), printable_line(file.string()));
}

void write_sheet_file(const std::filesystem::path& file, const RecordedRun& which, const std::string& parts,
                      std::optional<unsigned> jobs) {
    std::string page = page_template(sheet_page);
    require_replaceable(file);
    FilterLibrary library = open_library();
    const SheetDocument document = sheet_document(which, parts, library, preview_settings(jobs), warning_printer());
    write(file, std::move(page), document);
    fmt::print("the {} of {} {} {}\n", by_count(document.sheets.size(), "sheet", "sheets"),
               count_text(document.sheets.size(), "part", "parts"), by_count(document.sheets.size(), "is", "are in"),
               printable_line(file.string()));
}

}  // namespace scanmill::runner
