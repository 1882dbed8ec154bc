// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/error_output.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "output/terminal.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill::runner {

namespace {

using Json = nlohmann::ordered_json;

void print_json_line(const Json& json) {
    fmt::print("{}\n",
               json.dump(-1, ' ', false, Json::error_handler_t::replace));  // names of files may be invalid UTF-8
}

}  // namespace

Error with_option(const Error& error) {
    const auto option = [&]() -> std::string_view {
        switch (error.remedy()) {
            case Remedy::none: return "";
            case Remedy::name_scans: return "scanmill run WORKFLOW SCAN…";
            case Remedy::name_input_files: return "scanmill run … --in NAME=FILE";
            case Remedy::declare_unit: return "on the command line: --unit mm";
            case Remedy::convert_unit: return "scanmill convert --to-unit mm IN OUT";
            case Remedy::drop_invalid_points:
                return "'scanmill convert --drop-invalid IN OUT' writes a copy without them";
            case Remedy::drop_invalid_rows:
                return "or drop them while reading: --invalid drop on the command line, `invalid: drop` in a workflow "
                       "or batch";
            case Remedy::choose_output_folder: return "on the command line: -o DIR";
            case Remedy::choose_cache_folder: return "on the command line: --cache DIR";
            case Remedy::run_without_workers: return "on the command line: -j 0";
            case Remedy::declare_truth_unit: return "with scanmill measure: --truth-unit mm";
            case Remedy::move_to_frame: return "the filter apply-transform moves data to another frame";
            case Remedy::mesh_points: return "the filters sculpt and region-grow mesh points";
            case Remedy::use_other_disk: return "";
            case Remedy::add_memory: return "";
        }
        return "";
    }();
    Error complete = error;
    if (!option.empty()) complete.set_hint(error.hint() + (error.hint().empty() ? "" : "; ") + std::string(option));
    return complete;
}

std::string error_text(const Error& error) {
    std::string text = "error: " + printable_line(error.sentence());
    for (const std::string& frame : error.frames()) text += "\n  " + printable_line(frame);
    if (!error.hint().empty()) text += "\nhint: " + printable_line(error.hint());
    return text;
}

void print(const Error& plain, bool json) {
    const Error error = with_option(plain);
    print_stderr("{}\n", for_stderr(error_text(error)));
    if (!json) return;
    Json described{{"message", error.sentence()}, {"where", error.frames()}};
    if (!error.hint().empty()) described["hint"] = error.hint();
    print_json_line({{"scanmill", 1}, {"error", std::move(described)}});
}

void print(const Diagnostics& diagnostics) {
    for (const Diagnostic& diagnostic : diagnostics.sorted())
        print_stderr("{}\n", for_stderr(printable_line(text(diagnostic, diagnostics.file()))));
    if (diagnostics.has_errors())
        print_stderr("{} in '{}'\n", count_text(diagnostics.errors(), "error", "errors"),
                     printable_line(diagnostics.file()));
}

Json to_json(const Diagnostics& diagnostics) {
    Json list = Json::array();
    for (const Diagnostic& diagnostic : diagnostics.sorted())
        list.push_back({{"severity", diagnostic.severity == Diagnostic::Severity::error ? "error" : "warning"},
                        {"line", diagnostic.position.line},
                        {"column", diagnostic.position.column},
                        {"message", diagnostic.message}});
    return {{"file", diagnostics.file()}, {"ok", !diagnostics.has_errors()}, {"diagnostics", std::move(list)}};
}

Json unreadable_json(const std::string& file, const Error& error) {
    Diagnostics diagnostics(file);
    diagnostics.error({}, error.sentence());
    return to_json(diagnostics);
}

void print_files_json(Json files) { print_json_line({{"scanmill", 1}, {"files", std::move(files)}}); }

}  // namespace scanmill::runner
