// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "merge/fuse.hpp"
#include "merge/merge_steps.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/filter/inputs.hpp"

namespace scanmill::merging {

namespace {

using Clouds = std::span<const std::shared_ptr<const PointCloud>>;

constexpr std::size_t most_named = 5;  // inputs in a warning

bool has_directions(const ColumnTable& columns, std::string_view name) {
    const Column* column = columns.find(name);
    return column && !column->is_list() && column->components() == 3;
}

Vec3 direction(const Column& column, std::size_t row) {
    return {column.number(row, 0), column.number(row, 1), column.number(row, 2)};
}

/// The directions of the points to the scanner: the column `approach`, and `side` where it has no direction.
Array<Vec3> approaches(const Column& column, std::size_t begin, std::size_t count, const Vec3& side) {
    Array<Vec3> result;
    result.reserve(count);
    for (std::size_t row = begin; row < begin + count; ++row) {
        const Vec3 v = direction(column, row);
        result.push_back(v.allFinite() && !v.isZero(0) ? v : side);
    }
    return result;
}

void warn_of_sides(std::span<const std::string> assumed, std::size_t inputs, bool are_posed, Context& context) {
    if (assumed.empty()) return;
    context.warn(fmt::format(
        "{} of {} inputs {} neither normals nor a column `approach`: for `fuse`, the scanner is assumed on the side of "
        "+z of {} ({} {})",
        assumed.size(), inputs, by_count(assumed.size(), "has", "have"),
        are_posed ? "their own frames" : "the common frame", by_count(assumed.size(), "input", "inputs"),
        enumerated(assumed.first(std::min(assumed.size(), most_named)))));
}

}  // namespace

std::size_t fuse_points(PointCloud& all, Clouds clouds, std::span<const RigidTransform> poses,
                        std::span<const u32> numbers, const Length& length, Context& context) {
    const bool have_normals =
        std::ranges::all_of(clouds, [](const auto& cloud) { return has_directions(cloud->columns, "normal"); }) &&
        all.columns.find("normal");
    Array<Vec3> normals;
    if (have_normals) {
        const Column& column = *all.columns.find("normal");
        for (std::size_t row = 0; row < all.size(); ++row) normals.push_back(direction(column, row));
    }
    const bool have_approaches = has_directions(all.columns, "approach");
    std::vector<Array<Vec3>> to_scanner;
    std::vector<ViewToFuse> views;
    std::vector<std::string> assumed;  // numbers of inputs
    std::size_t begin = 0;
    for (std::size_t i = 0; i < clouds.size(); ++i) {
        const std::size_t count = clouds[i]->size();
        const Vec3 side = poses.empty() ? Vec3(Vec3::UnitZ()) : Vec3(poses[i].rotation.col(2));
        const bool is_known = have_approaches && has_directions(clouds[i]->columns, "approach");
        to_scanner.push_back(is_known ? approaches(*all.columns.find("approach"), begin, count, side)
                                      : Array<Vec3>{side});
        ViewToFuse view{all.positions.span().subspan(begin, count), {}, to_scanner.back(), is_known || !poses.empty()};
        if (have_normals) view.normals = std::span<const Vec3>(normals).subspan(begin, count);
        views.push_back(view);
        if (!is_known && !have_normals) assumed.push_back(fmt::format("{}", numbers[i]));
        begin += count;
    }
    if (clouds.size() > 1) warn_of_sides(assumed, clouds.size(), !poses.empty(), context);

    Fused fused = fuse(views, length, context);
    Array<float> moved(all.size());
    for (std::size_t row = 0; row < all.size(); ++row) moved[row] = static_cast<float>(std::abs(fused.moved[row]));
    all.positions = std::move(fused.positions);
    add_column(all.columns, Column("moved", 1, Buffer<float>(std::move(moved))).with_length_exponent(1), context);
    return fused.count;
}

}  // namespace scanmill::merging
