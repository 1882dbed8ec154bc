// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Text for a terminal. Names of files, comments in them and keys of workflows may hold any byte; none of them may
/// clear the screen, change its title or break a line in two.

#include <string>

namespace scanmill::runner {

/// Control characters, but for line ends, become '?'.
std::string printable(std::string text);
/// Line ends, too.
std::string printable_line(std::string text);

}  // namespace scanmill::runner
