// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Finds out whether a module can be loaded without harm.

#include <filesystem>

namespace scanmill {

/// Loads the module in a copy of this process, which ends afterwards. Throws Error, with the last line that it wrote to
/// standard error, when that copy was ended by a signal (an exception that a static object throws, say), by exit(), or
/// had to be ended after 30 seconds. A module that the loader refuses with a reason passes. Pre: no other thread is
/// inside the loader, whose locks the copy inherits. Cost: a fork and a dlopen, from one millisecond for a plain module
/// to some thirty for one that brings large libraries.
void require_harmless_loading(const std::filesystem::path& module);

}  // namespace scanmill
