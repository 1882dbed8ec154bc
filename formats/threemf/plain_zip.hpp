// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// lib3mf's package as every program can open it.
///
/// lib3mf writes each size as ZIP64, whatever it is, and the 0th of a 0th month as its time; assimp, for one, finds
/// nothing in such an archive. The same compressed bytes go out in a plain ZIP archive of 1980-01-01.
/// Source: PKWARE's APPNOTE 6.3, sections 4.3 and 4.5.3.

#include <string_view>

#include "scanmill/io/output_buffer.hpp"

namespace scanmill::threemf {

/// An archive that needs ZIP64 (4 GiB), or of another form than lib3mf 1.8 makes, goes out as it is.
void write_plain_zip(std::string_view archive, OutputBuffer& out);

}  // namespace scanmill::threemf
