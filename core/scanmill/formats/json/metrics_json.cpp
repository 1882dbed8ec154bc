// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/json/metrics_json.hpp"

#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/io/output_buffer.hpp"

namespace scanmill {

using Json = nlohmann::ordered_json;

Json metrics_json(const Metrics& metrics) {
    Json json = Json::object();
    for (const Metric& metric : metrics.values) {
        if (metric.unit == Unit::boolean)
            json[metric.name] = metric.value != 0;
        else if (std::isfinite(metric.value))
            json[metric.name] = metric.value;
        else
            json[metric.name] = nullptr;
    }
    return json;
}

Json metrics_document(const Metrics& metrics) {
    const bool is_known = metrics.unit != LengthUnit::unknown;
    Json json{{"scanmill", 1},
              {"unit", is_known ? Json(symbol(metrics.unit)) : Json(nullptr)},
              {"metrics", metrics_json(metrics)},
              {"units", Json::object()}};
    for (const Metric& metric : metrics.values) json["units"][metric.name] = name_of(metric.unit);
    return json;
}

void write_metrics_json(const Value& value, OutputBuffer& out, const WriteOptions&) {
    out.text(metrics_document(*std::get<std::shared_ptr<const Metrics>>(value)).dump(2));
    out.text("\n");
}

Recognition recognise_json(std::string_view, u64) { return Recognition::no; }  // by its extension alone

LoadedFile refuse_json(const FileBytes&, const ReadOptions&) {
    throw Error("a JSON file holds no points and no mesh").hint("name the scan or mesh itself");
}

}  // namespace scanmill
