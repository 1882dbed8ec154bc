// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Output of errors and findings: sentences on stderr, and with --json an object on stdout as well, so that
/// a program that reads the output always gets one.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "scanmill/base/error.hpp"
#include "scanmill/workflow/document.hpp"

namespace scanmill::runner {

/// The error with the command-line option for its remedy added to the hint.
Error with_option(const Error& error);

/// "error: …", the frames and the hint, each on one line: a file's name may contain a line break.
std::string error_text(const Error& error);

/// The error on stderr; with `json` also `{"scanmill": 1, "error": {"message", "where", "hint"}}` on stdout.
void print(const Error& error, bool json);

/// Every diagnostic on stderr, a line each, then how many errors there are.
void print(const Diagnostics& diagnostics);

/// `{"file", "ok", "diagnostics": [{"severity", "line", "column", "message"}]}`.
nlohmann::ordered_json to_json(const Diagnostics& diagnostics);
/// The same for a file that could not be read at all.
nlohmann::ordered_json unreadable_json(const std::string& file, const Error& error);

/// `{"scanmill": 1, "files": […]}` on stdout, of objects as above.
void print_files_json(nlohmann::ordered_json files);

}  // namespace scanmill::runner
