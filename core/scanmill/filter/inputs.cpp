// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/filter/inputs.hpp"

#include "scanmill/base/error.hpp"

namespace scanmill {

void require_points(std::size_t points, std::string_view need) {
    if (points == 0) throw Error("the cloud has 0 points; {}", need).hint("`scanmill info` shows what a file contains");
    if (points > ~u32(0))
        throw Error("the cloud has {} points; at most {} are supported", points, ~u32(0))
            .hint("split the scan, or thin it before this step");
}

void require_points(const PointCloud& cloud, std::string_view need) {
    require_points(cloud.size(), need);
    require_finite(cloud.positions.span());
}

void require_triangles(const TriangleMesh& mesh, std::string_view need) {
    if (mesh.triangles.empty())
        throw Error("the mesh has no triangles; {}", need).hint("`scanmill info` shows what a file contains");
    require_consistent(mesh);
    require_finite(mesh.positions.span(), "vertices");
}

void add_column(ColumnTable& columns, Column column, Context& context) {
    if (columns.find(column.name())) {
        ColumnTable others;
        for (const Column& other : columns)
            if (other.name() != column.name()) others.add(other);
        columns = std::move(others);
        context.warn(fmt::format("the column '{}' of the input is replaced", column.name()));
    }
    columns.add(std::move(column));
}

void warn_of_dropped(const ColumnTable& columns, std::string_view what, std::string_view because, Context& context) {
    if (columns.empty()) return;
    std::string names;
    for (const Column& column : columns) names += (names.empty() ? "'" : ", '") + column.name() + "'";
    context.warn(fmt::format("{} are dropped, because {}: {}", what, because, names));
}

}  // namespace scanmill
