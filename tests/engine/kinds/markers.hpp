// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The kind `markers`: named points. Only tests have it. A module's own kind needs such a header, registered as below.

#include <string>
#include <vector>

#include "scanmill/kinds/document.hpp"

namespace scanmill {

struct Markers {
    Frame frame;
    Buffer<Vec3> positions;
    std::vector<std::string> names;
};
constexpr auto fields(const Markers*) {
    return std::tuple{field("frame", &Markers::frame), field("positions", &Markers::positions).means(Meaning::position),
                      field("names", &Markers::names)};
}

struct Marker {
    std::string name;
    Vec3 at;
};
constexpr auto fields(const Marker*) { return std::tuple{field("name", &Marker::name), field("at", &Marker::at)}; }

struct MarkersDocument {
    Frame frame;
    std::vector<Marker> markers;
};
constexpr auto fields(const MarkersDocument*) {
    return std::tuple{field("frame", &MarkersDocument::frame).flat(), field("markers", &MarkersDocument::markers)};
}

template <>
struct KindTraits<Markers> : FromPositions<Markers>, HasDocument<Markers, MarkersDocument> {
    static constexpr std::string_view name = "markers";
    static std::vector<PropertySpec> property_specs() { return {{"markers", Unit::count, "Markers."}}; }
    static std::vector<std::optional<double>> property_values(const Markers& markers) { return {markers.names.size()}; }
    static void require_usable(const Markers&) {}
    static constexpr std::string_view json_member = "markers";
    static MarkersDocument document(const Markers& markers) {
        MarkersDocument document{markers.frame, {}};
        for (std::size_t i = 0; i < markers.names.size(); ++i)
            document.markers.push_back({markers.names[i], markers.positions[i]});
        return document;
    }
    static Markers object(const MarkersDocument& document) {
        Markers markers{document.frame, {}, {}};
        Array<Vec3> positions;
        for (const Marker& marker : document.markers) {
            markers.names.push_back(marker.name);
            positions.push_back(marker.at);
        }
        markers.positions = std::move(positions);
        return markers;
    }
};
inline const bool markers_registered = (register_kind(kind_of<Markers>()), true);

}  // namespace scanmill
