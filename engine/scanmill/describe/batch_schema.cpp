// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/describe/batch_schema.hpp"

#include "scanmill/batch/batch.hpp"
#include "scanmill/describe/schema_parts.hpp"

namespace scanmill {

namespace {

using schema::Json;
using schema::object_of;

/// A number that is not 0.
constexpr const char* positive = R"((?![+]?[0.]+([eE]|[^0-9.]|$))[+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?)";

Json described(Json schema, const char* description) {
    schema["description"] = description;
    return schema;
}

/// Of a section that may be left empty.
Json section(Json properties, const char* description) {
    Json map = object_of(std::move(properties));
    map["type"] = Json::array({"object", "null"});
    return described(std::move(map), description);
}

Json text_of(const std::string& pattern, Json examples) {
    return {{"type", "string"}, {"pattern", "^" + pattern + "$"}, {"examples", std::move(examples)}};
}

/// A path is any scalar but an empty text.
Json path(const char* description) { return described({{"type", "string"}, {"minLength", 1}}, description); }

Json numbers(std::size_t count) {
    return {{"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", count}, {"maxItems", count}};
}

Json pose() {
    Json parts = object_of({{"translation", described(numbers(3), "x, y, z in the scan's unit.")},
                            {"rotation", described(numbers(4), "A quaternion of length 1: qx, qy, qz, qw.")}});
    parts["required"] = Json::array({"translation", "rotation"});
    const Json matrix{{"type", "array"}, {"items", numbers(4)}, {"minItems", 4}, {"maxItems", 4}};
    return {{"description", "Where the scan lies: a file of poses over {stem}, a matrix in rows, or a motion."},
            {"anyOf", Json::array({path("A file of poses."), matrix, std::move(parts)})}};
}

Json settings() {
    return schema::map_from_names(schema::any_value(), "Values of the workflows' parameters, by their names.");
}

Json scan() {
    Json details = object_of({{"path", path("A file, or several by *, ?, […] and **.")},
                              {"unit", schema::unit()},
                              {"frame", schema::text("The coordinate system's name; may hold {stem}.")},
                              {"pose", pose()},
                              {"truth", path("What the result should be: a file over {stem}.")},
                              {"set", settings()}});
    details["required"] = Json::array({"path"});
    return {{"anyOf", Json::array({path("A file, or several by *, ?, […] and **."), std::move(details)})}};
}

Json caps() {
    return {{"memory", described(text_of(positive + std::string(" *([KMGT]iB|[kMGT]?B)"), {"8 GiB"}),
                                 "Most memory, beyond which the work is stopped.")},
            {"time", described(text_of(positive + std::string(" *(ms|s|min|h)"), {"10 min"}),
                               "Longest time, after which the work is stopped.")}};
}

Json limits() {
    Json properties = caps();
    properties["step"] = described(object_of(caps()), "The same for one step.");
    properties["retries"] = {{"type", "integer"},
                             {"minimum", 0},
                             {"maximum", most_retries},
                             {"description", "How often work that failed is tried again."}};
    return section(std::move(properties), "What one scan under one variant may cost.");
}

}  // namespace

std::string batch_schema() {
    const Json files{{"type", "array"}, {"items", path("A workflow file.")}, {"minItems", 1}};
    return schema::document("Scanmill batch", Json::array({"scanmill", "batch", "scans", "workflows"}),
                            {{"scanmill", {{"const", 1}, {"description", "The version of the grammar."}}},
                             {"batch", schema::name_of("The batch's name.")},
                             {"summary", schema::text("What the batch is for, in a sentence.")},
                             {"scans",
                              {{"type", "array"},
                               {"minItems", 1},
                               {"description", "The scans; paths count from the batch file's folder."},
                               {"items", scan()}}},
                             {"workflows",
                              {{"description",
                                "The workflows that every scan runs under; paths count from the batch file's folder."},
                               {"anyOf", Json::array({path("A workflow file."), files})}}},
                             {"set", settings()},
                             {"limits", limits()}})
               .dump(2) +
           "\n";
}

}  // namespace scanmill
