// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What an E57 file declares about a scan: its fields, pose and limits. Nothing is read from the binary section.

#include <E57Format.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scanmill/data/columns.hpp"
#include "scanmill/data/transform.hpp"

namespace scanmill::e57_format {

/// A field of the points' prototype that holds numbers.
struct Field {
    std::string name;  ///< "cartesianX", or "nor:normalX" in an extension
    bool is_integer = false;  ///< an Integer; ScaledInteger and Float are read as double
    ScalarType type = ScalarType::float64;  ///< the smallest type that holds all declared values
    double low = 0, high = 0;  ///< declared bounds; after scaling
};

struct Scan {
    Scan(u32 number_in_file, const ::e57::CompressedVectorNode& its_points)
        : number(number_in_file),
          points(its_points) {}

    u32 number;  ///< from 1, as in FILE#1
    u64 records = 0;
    u64 bits = 1;  ///< of a record in the binary section, at least; never 0
    std::vector<Field> fields;
    std::vector<std::string> texts;  ///< names of the fields that hold text
    std::optional<RigidTransform> pose;  ///< absent for the identity
    std::vector<std::string> comments;  ///< name and limits
    std::optional<::e57::StructureNode> colour_limits;
    ::e57::CompressedVectorNode points;

    const Field* field(std::string_view name) const;
    bool has(std::initializer_list<std::string_view> names) const;
};

/// Throws Error for a structure that is not that of a scan, too many fields, a negative count, and a quaternion that
/// rotation_of() refuses. Throws what libE57Format throws.
Scan described(const ::e57::StructureNode& node, u32 number, const std::function<void(std::string)>& on_warning);

/// The number in an Integer, ScaledInteger or Float. Throws Error for other nodes. `what` names it: "its pose".
double number_in(const ::e57::Node& node, std::string_view what);

}  // namespace scanmill::e57_format
