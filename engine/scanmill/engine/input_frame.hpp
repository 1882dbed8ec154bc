// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The name that a workflow gives to the frame of what it reads: a fixed text, or one that holds {stem}, the file's
/// name without folder and extension. So every scan of a list can have a frame of its own, by which its pose is found.

#include <filesystem>
#include <string>
#include <string_view>

#include "scanmill/engine/diagnostics.hpp"

namespace scanmill {

/// Reports braces that are not `{stem}`. `what` begins the message: "the frame".
void check_stem_template(const std::string& text, std::string_view what, Position position, Diagnostics& diagnostics);
void check_frame_template(const std::string& frame, Position position, Diagnostics& diagnostics);

/// The text with the file's stem for every {stem}.
std::string with_stem(std::string text, const std::filesystem::path& file);
std::string frame_of_file(std::string frame, const std::filesystem::path& file);

}  // namespace scanmill
