// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// ZIP archives of a few compressed parts. Equal parts give equal bytes: the archive is dated 1980-01-01.
///
/// Source: PKWARE's APPNOTE 6.3, section 4.3.

#include <functional>
#include <string>
#include <string_view>

#include "scanmill/io/output_buffer.hpp"

namespace scanmill::threemf {

class ZipWriter {
public:
    explicit ZipWriter(OutputBuffer& out) : out_(out) {}

    /// Adds a part with the output of `write`. Throws Error if the part or the archive has 4 GiB or more.
    void add(std::string_view name, const std::function<void(OutputBuffer&)>& write);
    /// Writes the directory. Call it once, after the last part.
    void finish();

private:
    OutputBuffer& out_;
    std::string directory_;
    std::size_t parts_ = 0, size_ = 0;
};

}  // namespace scanmill::threemf
