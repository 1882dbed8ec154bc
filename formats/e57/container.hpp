// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The outer form of an E57 file: its header, its pages and the outline of its XML section.
///
/// libE57Format trusts these parts, so they are checked first, with code that allocates only what the file's size
/// allows. A page has 1024 bytes; its last 4 are a checksum, which only libE57Format checks.
/// Source: ASTM E2807-11, sections 5 and 6.

#include <string_view>

#include "scanmill/data/array.hpp"

namespace scanmill::e57_format {

struct Contents {
    u32 scans = 0;  ///< children of /data3D
    u32 images = 0;  ///< children of /images2D
};

/// Counts the scans and images of a file. Throws Error for: another signature; a version above 1.0; another page size;
/// a size other than the header's; an XML section outside of the file, or larger than 16 MiB; XML that is not UTF-8
/// or has a zero byte, whose tags do not match in number, that nests more than 64 elements or has elements with so many
/// children (one with 14,000) that parsing takes seconds; a document type or a schema location, because they would make
/// the XML parser read other files.
/// Cost: O(size of the XML section), which is copied.
Contents checked_contents(std::string_view bytes);

}  // namespace scanmill::e57_format
