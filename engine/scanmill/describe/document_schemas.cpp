// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/describe/document_schemas.hpp"

#include <array>
#include <cassert>

#include "scanmill/data/patches.hpp"
#include "scanmill/describe/schema_parts.hpp"
#include "scanmill/kinds/probes.hpp"

namespace scanmill {

namespace {

using namespace schema_parts;

/// A list of so many of these.
Json tuple_of(std::size_t size, Json item) {
    Json list = list_of(std::move(item));
    list["minItems"] = size;
    list["maxItems"] = size;
    return list;
}
Json vector() { return tuple_of(3, number()); }
Json text_or_null() { return {{"type", {"string", "null"}}}; }
Json frame() { return described("The name of the coordinate system; null: it has none.", text_or_null()); }

Json patches_schema() {
    const Json row_or_null{{"type", {"integer", "null"}}, {"minimum", 0}};
    const Json tet = object(
        {{"vertices", described("Rows of the points.", tuple_of(4, count()))},
         {"weights", described("c_ijkl, (i, j, k, l) falling lexicographically: 3000, 2100, …, 0003.",
                               tuple_of(std::tuple_size_v<PatchWeights>, number()))},
         {"kind", {{"enum", {"face", "edge", "sharp", "continuation"}}}},
         {"side", described("1 outside the mesh, 0 inside.", {{"enum", {0, 1}}})},
         {"patch", described("The row of the mesh's triangle.", count())},
         {"edge?", described("The number of the mesh's edge; null: it stands on a triangle.", row_or_null)},
         {"combine?",
          described("How the function is combined with the partner's.", {{"enum", {"none", "max", "min"}}})},
         {"partner?", described("The row of the other tetrahedron with the same points; null: none.", row_or_null)}});
    return document("patches", object({{"unit", length_unit_or_null()},
                                       {"frame", frame()},
                                       {"points", described("World coordinates.", list_of(vector()))},
                                       {"tets", list_of(tet)}}));
}

Json features_schema() {
    const Json normal{{"anyOf", {vector(), Json{{"type", "null"}}}}};
    const Json line =
        object({{"type", {{"enum", {"outer boundary", "hole", "crease"}}}},
                {"closed", flag()},
                {"points", described("World coordinates.", list_of(vector()))},
                {"left-normals", described("Of the surface left of each segment; null: none.", list_of(normal))},
                {"right-normals", described("Of the surface right of each segment; null: none.", list_of(normal))}});
    return document("features", object({{"unit", length_unit_or_null()},
                                        {"frame", frame()},
                                        {"polylines", list_of(line)},
                                        {"corners", list_of(vector())}}));
}

Json probes_schema() {
    const auto or_null = [](Json schema) -> Json { return {{"anyOf", {std::move(schema), Json{{"type", "null"}}}}}; };
    const Json angle_or_null = described("Radians; null: not defined.", {{"type", {"number", "null"}}});
    const Json touch =
        object({{"touch", count()},
                {"feature", described("The line that it measures.", count())},
                {"point", described("The reference point, in world coordinates.", vector())},
                {"tangent", vector()},
                {"left-normal", vector()},
                {"right-normal", vector()},
                {"interior-angle", angle_or_null},
                {"assumed", described("Whether the right normal is an assumption.", flag())},
                {"phi-min", angle_or_null},
                {"phi-max", angle_or_null},
                {"phi-known-min", angle_or_null},
                {"phi-known-max", angle_or_null},
                {"phi", angle_or_null},
                {"approach", described("From the part to the probe; null: the touch is not made.", or_null(vector()))},
                {"start", or_null(vector())},
                {"centre", described("Of the ball at the contact, as predicted.", or_null(vector()))},
                {"reason", names(ProbeReason::none, ProbeReason::obstructed)},
                {"false-share", described("Of the admissible reference points.", {{"type", {"number", "null"}}})},
                {"contact", names(ProbeContact::none, ProbeContact::missed)},
                {"contact-distance", {{"type", {"number", "null"}}}},
                {"order", {{"type", {"integer", "null"}}, {"minimum", 0}}}});
    const Json move = object({{"type", names(ProbeMoveType::clearance, ProbeMoveType::retract)},
                              {"touch", described("A row of the touches.", count())},
                              {"points", described("World coordinates.", list_of(vector()))}});
    return document("probes", object({{"unit", length_unit_or_null()},
                                      {"frame", frame()},
                                      {"radius", number()},
                                      {"scanner-error", number()},
                                      {"clearance", number()},
                                      {"stylus-radius", number()},
                                      {"stylus-length", number()},
                                      {"machine-axis", vector()},
                                      {"touches", list_of(touch)},
                                      {"moves", list_of(move)}}));
}

Json transform_schema() {
    const Json pose =
        object({{"scan?", described("The name of the coordinate system, or of the scan, that it starts from.", text())},
                {"rotation?", described("A quaternion x, y, z, w.", tuple_of(4, number()))},
                {"translation?", vector()},
                {"matrix?", described("In place of both: four rows.", tuple_of(4, tuple_of(4, number())))}});
    return document("transform",
                    object({{"unit?", length_unit_or_null()},
                            {"frame?", described("The coordinate system that it leads to.", text_or_null())},
                            {"poses", tuple_of(1, pose)}}));
}

Json metrics_schema() {
    return document("metrics",
                    object({{"unit", length_unit_or_null()}, {"metrics", metrics()}, {"units", map_of(unit())}}));
}

constexpr std::array<std::pair<std::string_view, Json (*)()>, 5> documents{{{"features", features_schema},
                                                                            {"metrics", metrics_schema},
                                                                            {"patches", patches_schema},
                                                                            {"probes", probes_schema},
                                                                            {"transform", transform_schema}}};

}  // namespace

const std::vector<std::string>& document_names() {
    static const std::vector<std::string> all = [] {
        std::vector<std::string> names;
        for (const auto& [name, make] : documents) names.emplace_back(name);
        return names;
    }();
    return all;
}

std::string document_schema(std::string_view name) {
    for (const auto& [each, make] : documents)
        if (name == each) return make().dump(2) + "\n";
    assert(false);
    return {};
}

}  // namespace scanmill
