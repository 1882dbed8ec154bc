// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// PNG, the image files of browsers and papers: pictures.
///
/// Writing: 8-bit RGB in the sRGB colour space, not interlaced. The caption is the text `Description` (`tEXt` if it is
/// ASCII, else `iTXt`), without control characters other than line breaks; `Software` is scanmill. The time is not
/// written, so equal values give equal bytes.
///
/// Reading: 8-bit grey and RGB, with or without alpha, interlaced or not. Grey becomes RGB. Alpha is left out, with a
/// warning that counts the pixels that are not opaque. Colours are kept as they are stored; profiles and gamma are not
/// applied. The caption, also the file's comment, is the text `Description`. Other texts are left out. Palettes and
/// other bit depths are refused. A file whose header declares more pixels than its size can hold is refused before
/// memory is allocated.
///
/// Source: Portable Network Graphics specification, second edition, ISO/IEC 15948:2004.

#include "scanmill/formats/common/format.hpp"

namespace scanmill::png {

LoadedFile read_png(const FileBytes& file, const ReadOptions& options);
void write_png(const Value& value, OutputBuffer& out, const WriteOptions& options);

}  // namespace scanmill::png
