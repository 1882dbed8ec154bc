// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The pages of an E57 file, to change its content under correct checksums.

#include <string>
#include <string_view>

namespace scanmill::test {

/// The content of all pages of a file, without their checksums. An incomplete last page is kept as far as it goes.
std::string e57_content(std::string_view file);
/// A file of pages with this content and their checksums. The last page is filled with zeros.
std::string e57_sealed(std::string_view content);

}  // namespace scanmill::test
