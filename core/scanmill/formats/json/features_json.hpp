// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Features as JSON. Written only:
///
///     {"scanmill": 1, "unit": "mm", "frame": "part",
///      "polylines": [{"type": "crease", "closed": false, "points": [[0, 0, 0], [0, 1, 0]],
///                     "left-normals": [[0, 0, 1]], "right-normals": [[1, 0, 0]]}, …],
///      "corners": [[0, 0, 0], [0, 1, 0]]}
///
/// `type`: outer boundary, hole or crease, as in VTP. Points are world coordinates, as double; a closed polyline does
/// not repeat its first one. Normals belong to segments: one for each, in order, that of a closed polyline's last one
/// leads back to its first point; null where there is no surface. `unit` and `frame` are null when they are not known.
/// Vertices that neither a polyline nor a corner names are left out.

#include <nlohmann/json.hpp>

#include "scanmill/data/features.hpp"
#include "scanmill/formats/common/format.hpp"

namespace scanmill {

class OutputBuffer;

nlohmann::ordered_json features_document(const FeatureGraph& graph);

/// Pre: the value is of the kind features.
void write_features_json(const Value& value, OutputBuffer& out, const WriteOptions& options);

}  // namespace scanmill
