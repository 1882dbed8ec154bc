// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What the program runs on, for records.

#include <string>

namespace scanmill::runner {

/// "AMD …, 8 cores, 31.3 GiB, Linux 6.1.0 x86_64".
std::string machine_text();

/// The libraries that decide what comes out, with their versions.
std::string libraries_text();

}  // namespace scanmill::runner
