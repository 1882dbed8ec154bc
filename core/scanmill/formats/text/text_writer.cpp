// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/common/text_output.hpp"
#include "scanmill/formats/common/writing.hpp"
#include "scanmill/formats/text/text.hpp"
#include "scanmill/io/output_buffer.hpp"

namespace scanmill {

void write_xyz(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const PointCloud& cloud = *value.get<PointCloud>();
    const Column* const normal = TextColumns(cloud.columns).normal;
    warn_lost_precision(cloud.frame, cloud.positions.span(), false, "XYZ", options);
    std::vector<std::string_view> kept;
    if (normal) kept.push_back(normal->name());
    warn_left_out(cloud.columns, "points", "XYZ", options, kept);

    out.text(comment_lines(cloud.frame));
    for (std::size_t row = 0; row < cloud.size(); ++row) {
        const Vec3 p = world(cloud.frame, cloud.positions[row]);
        for (int axis = 0; axis < 3; ++axis) {
            if (axis > 0) out.text(" ");
            out.number(p[axis]);
        }
        if (normal) put_row(*normal, row, out);
        out.text("\n");
    }
}

}  // namespace scanmill
