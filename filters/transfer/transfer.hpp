// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Carries columns, above all colours, from one cloud or mesh to the points or vertices of another.
///
/// Source: Callieri, Cignoni, Corsini, Scopigno 2008, "Masked photo blending", for weights by viewing angle; Comaniciu
/// and Meer 2002, "Mean shift", for the mode of the colours; IEC 61966-2-1 for sRGB.

#include <optional>
#include <string>
#include <vector>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct TransferParams {
    enum class Method {
        nearest,  ///< the values of the nearest point, or of the nearest corner of the nearest triangle
        blend  ///< the weighted mean of near points, or the value at the nearest point of the surface
    };
    /// Names of columns of `from`. Without a value: `colour` and `colour16`, if `from` has them.
    std::optional<std::vector<std::string>> columns;
    Method method = Method::blend;
    /// Rows farther than this from `from` get no values; above 0. If absent, about 3 spacings: see samples.hpp.
    std::optional<Length> max_distance;
    /// Whether rows of `to` that the column `filled` marks get values, too.
    bool filled = false;
};

/// `Geometry`: PointCloud or TriangleMesh.
template <class Geometry>
struct TransferResult {
    /// `to` with the columns of `from` and the column `transferred` (uint8): 1 for rows with values of `from`, 0 for
    /// rows with neutral ones. If no column is carried, `to` itself.
    Geometry result;
    /// Number of rows by outcome; their sum is the number of rows. All are 0 if no column is carried.
    std::size_t transferred = 0, unknown = 0, filled = 0;
    /// Rows among `unknown` that have points within the distance, but only of surfaces that face the other way.
    std::size_t facing_away = 0;
    /// The largest distance that was used; 0 if no column is carried.
    double max_distance = 0;
};

/// Gives every row of `to` the values of `from` beside it. The rows of a mesh are its vertices.
///
/// Sides. A point, or a triangle, counts for a row only if it faces the same way, so that the colour of a thin wall's
/// back does not come through. `to` faces along its vertex normals (of a mesh) or its column `normal`; `from` along its
/// triangles' normals, its column `normal` and towards the scanner (its column `approach`). The angle between them must
/// be below about 100 degrees (cosine above -0.2, as normals have noise). A direction that is missing, 0 or NaN allows
/// every side.
///
/// Points, blend. The samples of a row are the points among the 12 nearest positions that count. The nearest must be
/// within `max_distance`, the others within four times that. If none of the 12 counts, more positions are searched. A
/// sample at distance d has the weight (1 - d² / r²), where r is slightly beyond the farthest of them, times the
/// cosines to its normal and to its `approach` (at least 0.05 each).
///  - Colours: `colour` of 3 or 4 bytes, `colour16` of 3 or 4 × uint16. The result is the mean, in linear light, of the
///    samples whose colour is similar to the colour that has the most weight of similar samples around it (ties: the
///    nearer one). So edges between colours stay sharp. Two colours are similar if their distance (of the codes of red,
///    green and blue) is at most 2.5 times the median distance between a point's colour and its nearest neighbour's,
///    and in any case if it is at most 12 of 255.
///  - Columns of float32 and float64: the mean of the finite values. `normal` and `approach` get the length 1.
///  - Other integers, lists: as nearest; they may be numbers of views, labels or flags.
/// Points, nearest. The nearest point that counts. Ties: the lowest row.
///
/// Mesh. The nearest point of the surface that counts. With blend, a vertex column has its linearly interpolated value
/// there, colours in linear light. With nearest, it has the value of the triangle's nearest corner (ties: the lowest
/// row). A face column has the value of the triangle. Ties: the triangle with the lowest row. If a vertex and a face
/// column have the same name, the vertex column is carried.
///
/// Rows without values: rows with nothing of `from` within `max_distance` that counts, and rows whose column `filled`
/// is 1, unless params.filled. Their values are neutral: the middle grey (128, or 32896 of uint16) with full alpha
/// for colours, an empty list, 0 for all others.
///
/// Pre:  finite coordinates; one unit and one frame (origins may differ); `from` has points or triangles, `to` has
///       rows. A column that is named exists, and none is named `transferred`. If columns are not named and `from` has
///       no colours, nothing else is checked and `to` is returned. Throws Error otherwise; also if no row is within
///       `max_distance`.
/// Post: a column of `to` with the name of a carried column, or `transferred`, is replaced. Carrying from a mesh to
///       itself changes nothing if its vertices are in triangles, at different positions, and no triangle at a vertex
///       faces away from it. Neither does method nearest from points at different positions. Doubts the result if more
///       than 5 % of the rows near `from` face away from it.
/// Deterministic: the same bytes for any number of threads and any processor.
/// Cost: O(m log n) for m rows and n points; about 3 us per row, 1 us and 150 bytes per point.
/// Metrics: `transferred`, `unknown`, `filled`, `max-distance`.
template <class From, class To>
TransferResult<To> transfer(const From& from, const To& to, const TransferParams& params, Context& context);

}  // namespace scanmill
