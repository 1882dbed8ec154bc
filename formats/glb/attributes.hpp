// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Columns as vertex attributes of glTF: which of its few types each one gets, and what none can hold.

#include <functional>
#include <string>
#include <vector>

#include "scanmill/data/columns.hpp"
#include "scanmill/data/frame.hpp"
#include "scanmill/formats/files.hpp"

namespace scanmill::glb {

struct Attribute {
    std::string name;  ///< "NORMAL", "_RING"
    int component_type;  ///< of tinygltf
    u32 components;
    bool is_normalised = false;
    /// Writes every row at `place`, stride() bytes apart; what lies between stays as it is.
    std::function<void(unsigned char* place)> fill;

    /// glTF wants every row on four bytes.
    std::size_t stride() const;
};

/// With y up: the direction or position, turned by a right angle around x.
inline Vec3 y_up(const Vec3& v) { return {v.x(), v.z(), -v.y()}; }

/// All that the columns become, in their order; what is left out or changed is told. The columns must outlive it.
std::vector<Attribute> attributes_of(const ColumnTable& columns, const WriteOptions& options);

}  // namespace scanmill::glb
