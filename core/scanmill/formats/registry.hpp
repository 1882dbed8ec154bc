// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The table of all file formats.

#include <span>
#include <vector>

#include "scanmill/formats/common/format.hpp"

namespace scanmill {

/// Every format, in the order in which they are asked and listed: the built-in ones, then those of modules.
std::span<const Format> formats();

/// The formats of loadable modules. Defined in plugin/format_modules.cpp, which loads them: this folder knows no
/// modules.
std::vector<Format> module_formats();

/// The format of a file: the first that is certain of its content, else that of its extension, else the first that
/// finds the content plausible. Throws Error with what the file begins with.
const Format& format_of(const FileBytes& file);

}  // namespace scanmill
