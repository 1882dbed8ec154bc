// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The kind `markers`: named places. Only tests have it. A module's own kind needs such a header, registered as below.

#include <string>
#include <vector>

#include "scanmill/kinds/document.hpp"
#include "scanmill/kinds/kind_traits.hpp"

namespace scanmill {

struct Markers {
    Frame frame;
    Buffer<Vec3> positions;
    std::vector<std::string> names;
};

template <>
struct KindTraits<Markers> : FromPositions<Markers> {
    static constexpr std::string_view name = "markers";
    static void visit(FieldVisitor& visitor, Markers& markers) {
        visitor.frame("frame", markers.frame);
        visitor.positions("positions", markers.positions);
        visitor.small("names", markers.names);
    }
    static std::vector<PropertySpec> property_specs() { return {{"markers", Unit::count, "Markers."}}; }
    static std::vector<std::optional<double>> property_values(const Markers& markers) { return {markers.names.size()}; }
    static void require_usable(const Markers&) {}
    static constexpr std::string_view json_member = "markers";
    static void to_json(const Markers& markers, Json& document) {
        document = {{"scanmill", 1}, {"unit", unit_json(markers.frame.unit)}, {"markers", Json::array()}};
        for (std::size_t i = 0; i < markers.names.size(); ++i)
            document["markers"].push_back(
                {{"name", markers.names[i]}, {"at", json_of(markers.frame.origin + markers.positions[i])}});
    }
    static Markers from_json(const Json& document, const OnWarning&) {
        Markers markers;
        markers.frame.unit = unit_member(document);
        Array<Vec3> positions;
        for (const Json& marker : list_member(document, "markers", "the document")) {
            markers.names.push_back(text_member(marker, "name", "a marker"));
            positions.push_back(vector_of(member(marker, "at"), "a marker's 'at'"));
        }
        markers.positions = std::move(positions);
        return markers;
    }
};
inline const bool markers_registered = (register_kind(kind_of<Markers>()), true);

}  // namespace scanmill
