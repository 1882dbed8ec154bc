// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Columns as vertex attributes of glTF: decides which columns can be written, and with which type.

#include <functional>
#include <string>
#include <vector>

#include "scanmill/data/columns.hpp"
#include "scanmill/data/frame.hpp"
#include "scanmill/formats/files.hpp"

namespace scanmill::glb {

struct Attribute {
    std::string name;  ///< for example "NORMAL" or "_RING"
    int component_type;  ///< tinygltf's constant
    u32 components;
    bool is_normalised = false;
    /// Writes the rows to `rows`, stride() bytes apart; does not change the bytes between them.
    std::function<void(unsigned char* rows)> fill;

    /// Bytes from one row to the next: glTF requires rows to be aligned to four bytes.
    std::size_t stride() const;
};

/// A direction or position with y up: rotated by a right angle around x.
inline Vec3 y_up(const Vec3& v) { return {v.x(), v.z(), -v.y()}; }

/// The attributes of the columns, in their order. Warns about columns that are left out or changed. The columns must
/// outlive the result.
std::vector<Attribute> attributes_of(const ColumnTable& columns, const WriteOptions& options);

}  // namespace scanmill::glb
