// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/output_buffer.hpp"
#include "scanmill/formats/writing.hpp"
#include "scanmill/formats/xyz.hpp"

namespace scanmill {

namespace {

const Column* normals_of(const PointCloud& cloud) {
    const Column* normal = cloud.columns.find("normal");
    const bool usable = normal && normal->components() == 3 &&
                        (normal->type() == ScalarType::float32 || normal->type() == ScalarType::float64);
    return usable ? normal : nullptr;
}

void put_normal(const Column& normal, std::size_t row, OutputBuffer& out) {
    for (std::size_t i = 3 * row; i < 3 * row + 3; ++i) {
        out.text(" ");
        // Each in its own type: the shortest decimals of a float are fewer than those of the same double.
        if (normal.type() == ScalarType::float32)
            out.number(normal.values<float>()[i]);
        else
            out.number(normal.values<double>()[i]);
    }
}

}  // namespace

void write_xyz(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const PointCloud& cloud = *std::get<std::shared_ptr<const PointCloud>>(value);
    const Column* normal = normals_of(cloud);
    tell_lost_precision(cloud.frame, cloud.positions.span(), false, "XYZ", options);
    tell_left_out(cloud.columns, "points", "XYZ", options, normal ? "normal" : "");

    out.text(comment_lines(cloud.frame));
    for (std::size_t row = 0; row < cloud.size(); ++row) {
        const Vec3 p = world(cloud.frame, cloud.positions[row]);
        for (int axis = 0; axis < 3; ++axis) {
            if (axis > 0) out.text(" ");
            out.number(p[axis]);
        }
        if (normal) put_normal(*normal, row, out);
        out.text("\n");
    }
}

}  // namespace scanmill
