// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `points`: a scan as an unordered list of positions with per-point columns.

#include <optional>

#include "scanmill/data/bounds.hpp"
#include "scanmill/data/columns.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

struct PointCloud {
    Frame frame;
    /// #points, relative to frame.origin. May contain NaN or infinity after reading; a scan that enters a workflow has
    /// only valid rows (see valid_rows()).
    Buffer<Vec3> positions;
    /// Every column has #points rows.
    ColumnTable columns;

    std::size_t size() const { return positions.size(); }
};
constexpr auto fields(const PointCloud*) {
    return std::tuple{field("frame", &PointCloud::frame),
                      field("positions", &PointCloud::positions).means(Meaning::position),
                      field("columns", &PointCloud::columns)};
}

/// The points at `rows` with all their columns, in the order of `rows`.
PointCloud gather(const PointCloud& cloud, std::span<const u32> rows);

/// Throws Error if a coordinate is NaN or infinite, with the number of such points and the first of them. `what` names
/// the elements in the message: "points", "vertices".
void require_finite(std::span<const Vec3> positions, std::string_view what = "points");

/// The rows of the positions whose three coordinates are finite, ascending.
Array<u32> finite_rows(std::span<const Vec3> positions);

/// The valid rows, ascending. A valid row has three finite coordinates. If the box of the finite rows has a side longer
/// than largest_side, a valid row is also within half of largest_side of the median along every axis. The box of the
/// valid rows is therefore not too long.
///
/// Throws Error with the number of far rows if at most half of the finite rows are near the median, because the scan
/// itself is then too long. Cost: one pass; if the box is too long, also one selection per axis.
Array<u32> valid_rows(std::span<const Vec3> positions);

/// The treatment of invalid rows in a scan that enters a workflow.
enum class InvalidRows {
    by_format,  ///< drop if the file's format writes NaN for a ray without a return, else refuse
    refuse,
    drop
};
/// "refuse" and "drop"; empty for by_format.
std::string_view name_of(InvalidRows rule);
/// The rule with this name; nullopt for texts other than "refuse" and "drop".
std::optional<InvalidRows> invalid_rows_named(std::string_view name);

template <class Geometry>
struct Cleaned {
    Geometry result;
    std::size_t points = 0;  ///< number of points or vertices removed
    std::size_t triangles = 0;  ///< number of triangles removed
};

/// The points at the valid rows, in order, with all columns. Throws Error if no row is valid.
Cleaned<PointCloud> without_invalid_points(const PointCloud& cloud);

/// The scan if all its rows are valid; else without_invalid_points() or an Error with the number of invalid rows and
/// the first of them. Throws Error also for a scan outside the supported range (see require_supported_range()).
/// `nan_is_no_return`: whether the file's format writes NaN for a ray without a return.
Cleaned<PointCloud> accepted(const PointCloud& cloud, InvalidRows rule, bool nan_is_no_return);

/// Adds `shift` to every position.
Buffer<Vec3> translated(const Buffer<Vec3>& positions, const Vec3& shift);

}  // namespace scanmill
