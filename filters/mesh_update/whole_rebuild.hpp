// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `rebuild: whole`: a closed surface through all points that are kept, by tight cocone.

#include "tight_cocone/tight_cocone.hpp"

namespace scanmill::updating {

/// A closed mesh whose vertices are rows of a list of points, first those of the model.
struct Rebuilt {
    Array<u32> rows;  ///< by vertex, ascending
    Array<Triangle> triangles;  ///< corners are vertices
    std::size_t fixed = 0;  ///< the first triangles that are facets of the model
    Array<u32> replaced;  ///< facets of the model that are not among the first `fixed` triangles, ascending
};

/// tight_cocone() of the points at these rows, with its warnings; `facets` is the number of the model's. The doubts of
/// tight_cocone() are left out, because they expect an even sampling of the whole surface. Throws Error as it does.
Rebuilt rebuild_whole(std::span<const Vec3> positions, const Frame& frame, std::span<const u32> rows,
                      std::size_t facets, const TightCoconeParams& params, Context& context);

/// A Context with the threads and the cancellation of another one, which nothing else reaches.
class NestedContext : public Context {
public:
    explicit NestedContext(const Context& outer);
};

}  // namespace scanmill::updating
