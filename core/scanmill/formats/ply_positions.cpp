// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/ply_positions.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace scanmill {

namespace {

struct PackedPositions {
    ScalarType type;
    std::size_t offset = 0;    ///< of x in a row
    std::size_t row_size = 0;
};

std::optional<PackedPositions> packed_positions(const PlyElement& vertex, PlyEncoding encoding) {
    const bool native = encoding == (std::endian::native == std::endian::little ? PlyEncoding::binary_little_endian
                                                                                : PlyEncoding::binary_big_endian);
    if (!native || vertex.has_lists()) return {};
    PackedPositions packed{vertex.find("x")->type};
    if (packed.type != ScalarType::float32 && packed.type != ScalarType::float64) return {};
    constexpr std::array<std::string_view, 3> axes{"x", "y", "z"};
    std::size_t seen = 0;
    for (const PlyProperty& property : vertex.properties) {
        if (seen < 3 && property.name == axes[seen] && property.type == packed.type) {
            if (seen++ == 0) packed.offset = packed.row_size;
        } else if (seen == 1 || seen == 2) {
            return {};
        }
        packed.row_size += size_of(property.type);
    }
    if (seen != 3) return {};
    return packed;
}

/// `source` is the first row's x, rows are `stride` bytes apart. One pass: bounds and doubles together.
template <class Scalar>
FiniteBounds widen_positions(const char* source, std::size_t stride, Array<Vec3>& positions) {
    FiniteBounds all;
    constexpr std::size_t block = 1024;
    for (std::size_t first = 0; first < positions.size(); first += block) {
        const std::size_t rows = std::min(block, positions.size() - first);
        Scalar low[3], high[3], poison[3] = {0, 0, 0};
        std::memcpy(low, source, sizeof low);
        std::memcpy(high, source, sizeof high);
        for (std::size_t row = 0; row < rows; ++row, source += stride) {
            Scalar p[3];
            std::memcpy(p, source, sizeof p);
            for (int axis = 0; axis < 3; ++axis) {
                low[axis] = p[axis] < low[axis] ? p[axis] : low[axis];
                high[axis] = p[axis] > high[axis] ? p[axis] : high[axis];
                poison[axis] += p[axis] * 0;  // 0, unless the coordinate is NaN or infinite: then NaN, and so it stays
                positions[first + row][axis] = static_cast<double>(p[axis]);
            }
        }
        FiniteBounds bounds{{Vec3(low[0], low[1], low[2]), Vec3(high[0], high[1], high[2])},
                            poison[0] + poison[1] + poison[2] == 0};
        if (!bounds.finite) bounds.box = bounding_box({positions.data() + first, rows});
        all.add(bounds);
    }
    return all;
}

}  // namespace

std::optional<FiniteBounds> widen_packed_positions(std::string_view body, const PlyElement& vertex,
                                                   PlyEncoding encoding, Array<Vec3>& positions) {
    const auto packed = packed_positions(vertex, encoding);
    if (!packed) return std::nullopt;
    const char* source = body.data() + packed->offset;
    return packed->type == ScalarType::float32 ? widen_positions<float>(source, packed->row_size, positions)
                                               : widen_positions<double>(source, packed->row_size, positions);
}

}  // namespace scanmill
