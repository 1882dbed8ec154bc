// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// PCD files as texts.

#include "core/formats/support.hpp"

namespace scanmill::test {

inline std::string header(const std::string& fields, const std::string& sizes, const std::string& types, u32 points,
                          const std::string& data, const std::string& more = "") {
    const std::string count = std::to_string(points);
    std::string counts;
    for (char c : fields) counts += c == ' ' ? " 1" : "";
    return "# .PCD v0.7 - Point Cloud Data file format\n" + more + "VERSION 0.7\nFIELDS " + fields + "\nSIZE " + sizes +
           "\nTYPE " + types + "\nCOUNT 1" + counts + "\nWIDTH " + count +
           "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA " + data + "\n";
}

inline std::string xyz_header(u32 points, const std::string& data, const std::string& more = "") {
    return header("x y z", "4 4 4", "F F F", points, data, more);
}

/// An LZF stream of the uncompressed bytes, in runs of at most 32.
inline std::string lzf_literals(const std::string& bytes) {
    std::string stream;
    for (std::size_t at = 0; at < bytes.size(); at += 32) {
        const std::string run = bytes.substr(at, 32);
        stream += static_cast<char>(run.size() - 1);
        stream += run;
    }
    return stream;
}

inline std::string compressed_block(const std::string& bytes) {
    const std::string stream = lzf_literals(bytes);
    return bytes_of(static_cast<u32>(stream.size())) + bytes_of(static_cast<u32>(bytes.size())) + stream;
}

}  // namespace scanmill::test
