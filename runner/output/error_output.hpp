// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Output of errors and findings as sentences on stderr. With --json an object is also written to stdout, so that a
/// program that reads the output always gets one.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "scanmill/base/error.hpp"
#include "scanmill/workflow/document.hpp"

namespace scanmill::runner {

/// The error with a hint that also names the command-line option that helps.
Error with_option(const Error& error);

/// "error: …", the frames and the hint, each on one line. Line breaks in names of files are escaped.
std::string error_text(const Error& error);

/// Prints the error on stderr. With `json` also `{"scanmill": 1, "error": {"message", "where", "hint"}}` on stdout.
void print(const Error& error, bool json);

/// Prints every diagnostic on one line of stderr, then the number of errors.
void print(const Diagnostics& diagnostics);

/// The diagnostics as `{"file", "ok", "diagnostics": [{"severity", "line", "column", "message"}]}`.
nlohmann::ordered_json to_json(const Diagnostics& diagnostics);
/// The same for a file that cannot be read.
nlohmann::ordered_json unreadable_json(const std::string& file, const Error& error);

/// Prints `{"scanmill": 1, "files": […]}` on stdout; `files` are objects of to_json() or unreadable_json().
void print_files_json(nlohmann::ordered_json files);

}  // namespace scanmill::runner
