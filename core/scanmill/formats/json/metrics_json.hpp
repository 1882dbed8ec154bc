// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Metrics as JSON. Written only:
///
///     {"scanmill": 1, "unit": "mm", "metrics": {"hausdorff": 0.12, "closed": true, …}, "units": {"hausdorff":
///     "length", …}}
///
/// `unit`: what lengths are in, areas and volumes in its powers; null when it is not known. Angles are in radians,
/// ratios plain fractions; yes and no are true and false; what is no number is null.

#include <nlohmann/json.hpp>

#include "scanmill/formats/common/format.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill {

class OutputBuffer;

/// The numbers alone, by name.
nlohmann::ordered_json metrics_json(const Metrics& metrics);

/// All of it, as above.
nlohmann::ordered_json metrics_document(const Metrics& metrics);

/// Pre: the value is of the kind metrics.
void write_metrics_json(const Value& value, OutputBuffer& out, const WriteOptions& options);

Recognition recognise_json(std::string_view head, u64 file_size);
/// Always throws: JSON is only written.
LoadedFile refuse_json(const FileBytes& file, const ReadOptions& options);

}  // namespace scanmill
