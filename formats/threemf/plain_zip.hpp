// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Rewrites lib3mf's package so that every program can open it.
///
/// lib3mf writes every size as ZIP64, whatever its value, and day 0 of month 0 as the time; assimp, for example, finds
/// no files in such an archive. The same compressed bytes are written as a plain ZIP archive dated 1980-01-01. Source:
/// PKWARE's APPNOTE 6.3, sections 4.3 and 4.5.3.

#include <string_view>

#include "scanmill/io/output_buffer.hpp"

namespace scanmill::threemf {

/// An archive that needs ZIP64 (4 GiB), or has another form than that of lib3mf 1.8, is written unchanged.
void write_plain_zip(std::string_view archive, OutputBuffer& out);

}  // namespace scanmill::threemf
