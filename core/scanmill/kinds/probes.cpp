// SPDX-License-Identifier: GPL-3.0-or-later
/// The kind `probes`. Its JSON form:
///
///     {"scanmill": 1, "unit": "mm", "frame": "machine",
///      "radius": 2, "scanner-error": 1, "clearance": 2, "stylus-radius": 1.2, "stylus-length": 40,
///      "machine-axis": [0, 0, 1],
///      "touches": [{"touch": 0, "feature": 3, "point": [0, 0, 0], "tangent": [0, 1, 0], "left-normal": [0, 0, 1],
///                   "right-normal": [1, 0, 0], "interior-angle": 1.57, "assumed": false, "phi-min": -0.26,
///                   "phi-max": 0.26, "phi-known-min": null, "phi-known-max": null, "phi": 0,
///                   "approach": [0.7, 0, 0.7], "start": [8, 0, 8], "centre": [1.4, 0, 1.4], "reason": "none",
///                   "false-share": 0, "contact": "edge", "contact-distance": 0.1, "order": 0}, …],
///      "moves": [{"type": "clearance", "touch": 0, "points": [[8, 0, 20], [8, 0, 8]]}, …]}
///
/// Points are world coordinates, angles radians. `reason` is none, concave, too-narrow, too-tilted or obstructed;
/// `contact` is none, edge, elsewhere or missed; `type` is clearance, approach or retract; `touch` of a move is a row
/// of `touches`. What is not defined is null: a range without directions, the direction of a touch that is not made,
/// the order of one; also `unit` and `frame` if unknown. Numbers are read back bit for bit.
#include "scanmill/data/probes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/data/bounds.hpp"
#include "scanmill/kinds/document.hpp"
#include "scanmill/kinds/kind_traits.hpp"
#include "scanmill/kinds/probes.hpp"

namespace scanmill {

namespace {

constexpr std::array<std::string_view, 5> reasons{"none", "concave", "too-narrow", "too-tilted", "obstructed"};
constexpr std::array<std::string_view, 4> contacts{"none", "edge", "elsewhere", "missed"};
constexpr std::array<std::string_view, 3> move_types{"clearance", "approach", "retract"};

constexpr std::array sizes{&ProbePlan::radius, &ProbePlan::scanner_error, &ProbePlan::clearance,
                           &ProbePlan::stylus_radius, &ProbePlan::stylus_length};
constexpr std::array<const char*, sizes.size()> size_names{"radius", "scanner-error", "clearance", "stylus-radius",
                                                           "stylus-length"};

/// A field of every touch as one array that a visitor may change.
template <class T, class Field, class Visit>
void visit_rows(std::vector<T>& rows, Field&& field, Visit&& visit) {
    using Member = std::remove_cvref_t<decltype(field(rows[0]))>;
    using Element = std::conditional_t<std::is_same_v<Member, bool>, u8, Member>;
    Array<Element> elements(rows.size());
    for (std::size_t row = 0; row < rows.size(); ++row) elements[row] = field(rows[row]);
    Buffer<Element> buffer(std::move(elements));
    visit(buffer);
    rows.resize(buffer.size());
    for (std::size_t row = 0; row < rows.size(); ++row) field(rows[row]) = static_cast<Member>(buffer[row]);
}

/// Throws Error if a number of a row or of a point is out of range.
void require_consistent(const ProbePlan& plan) {
    for (std::size_t row = 0; row < plan.moves.size(); ++row) {
        const ProbeMove& move = plan.moves[row];
        if (move.touch >= plan.touches.size())
            throw Error("move {} names touch {}; there are {}", row, move.touch, plan.touches.size());
        if (move.begin > move.end || move.end > plan.path.size())
            throw Error("move {} names the points {} to {}; there are {}", row, move.begin, move.end, plan.path.size());
    }
}

Json number_json(double number) { return std::isfinite(number) ? Json(number) : Json(nullptr); }

Json point_json(const ProbePlan& plan, const Vec3& position) { return json_of(Vec3(plan.frame.origin + position)); }

Json touch_json(const ProbePlan& plan, const ProbeTouch& touch) {
    const bool is_made = touch.reason == ProbeReason::none;
    return {{"touch", touch.touch},
            {"feature", touch.feature},
            {"point", point_json(plan, touch.position)},
            {"tangent", json_of(touch.tangent)},
            {"left-normal", json_of(touch.left_normal)},
            {"right-normal", json_of(touch.right_normal)},
            {"interior-angle", number_json(touch.interior_angle)},
            {"assumed", touch.assumed},
            {"phi-min", number_json(touch.range.min)},
            {"phi-max", number_json(touch.range.max)},
            {"phi-known-min", number_json(touch.known_range.min)},
            {"phi-known-max", number_json(touch.known_range.max)},
            {"phi", number_json(touch.phi)},
            {"approach", is_made ? json_of(touch.approach) : Json(nullptr)},
            {"start", is_made ? point_json(plan, touch.start) : Json(nullptr)},
            {"centre", is_made ? point_json(plan, touch.centre) : Json(nullptr)},
            {"reason", name_of(touch.reason)},
            {"false-share", number_json(touch.false_share)},
            {"contact", name_of(touch.contact)},
            {"contact-distance", number_json(touch.contact_distance)},
            {"order", touch.order == ProbeTouch::no_order ? Json(nullptr) : Json(touch.order)}};
}

Json move_json(const ProbePlan& plan, const ProbeMove& move) {
    Json points = Json::array();
    for (u32 row = move.begin; row < move.end; ++row) points.push_back(point_json(plan, plan.path[row]));
    return {{"type", name_of(move.type)}, {"touch", move.touch}, {"points", std::move(points)}};
}

class ProbesReader {
public:
    ProbePlan read(const Json& document) {
        std::vector<std::string> known{"scanmill", "unit", "frame", "machine-axis", "touches", "moves"};
        known.insert(known.end(), size_names.begin(), size_names.end());
        require_document(document, known);
        plan_.frame.unit = unit_member(document);
        plan_.frame.name = text_member(document, "frame", "the document");
        for (std::size_t i = 0; i < sizes.size(); ++i) {
            const double size = number(document, size_names[i], "the document");
            if (!(size >= 0)) throw Error("the document: '{}' is not a length of 0 or more", size_names[i]);
            plan_.*sizes[i] = size;
        }
        plan_.machine_axis = direction(document, "machine-axis", "the document");
        for (const Json& touch : list_member(document, "touches", "the document"))
            read_touch(touch, fmt::format("touch {}", plan_.touches.size()));
        for (const Json& move : list_member(document, "moves", "the document"))
            read_move(move, fmt::format("move {}", plan_.moves.size()));
        use_origin();
        return std::move(plan_);
    }

private:
    static double number(const Json& object, std::string_view key, const std::string& place) {
        const Json& value = member(object, key);
        if (value.is_null()) return ProbeTouch::nan;
        if (!value.is_number()) throw Error("{}: '{}' is not a number or null", place, key);
        return value.get<double>();
    }
    static Vec3 point(const Json& object, std::string_view key, const std::string& place) {
        return vector_of(member(object, key), fmt::format("{}: '{}'", place, key));
    }
    static Vec3 direction(const Json& object, std::string_view key, const std::string& place) {
        const Vec3 vector = point(object, key, place);
        constexpr double most = 1e-4;
        if (!(std::abs(vector.norm() - 1) <= most))
            throw Error("{}: '{}' has the length {:.6g}; a direction's is 1", place, key, vector.norm());
        return vector;
    }
    static u32 index(const Json& object, std::string_view key, const std::string& place) {
        const Json& value = member(object, key);
        if (!value.is_number_unsigned() || value.get<u64>() >= ProbeTouch::no_order)
            throw Error("{}: '{}' is not a whole number from 0 to {}", place, key, ProbeTouch::no_order - 1);
        return value.get<u32>();
    }
    template <class Enumeration, std::size_t count>
    static Enumeration word(const std::array<std::string_view, count>& words, const Json& object, std::string_view key,
                            const std::string& place) {
        const std::string text = text_member(object, key, place);
        const auto found = std::ranges::find(words, text);
        if (found == words.end())
            throw Error("{}: unknown {} '{}'; expected one of {}", place, key, text, fmt::join(words, ", "));
        return static_cast<Enumeration>(found - words.begin());
    }

    void read_touch(const Json& json, const std::string& place) {
        if (!json.is_object()) throw Error("{} is not an object", place);
        require_keys(json, place, {"touch",         "feature",        "point",       "tangent",  "left-normal",
                                   "right-normal",  "interior-angle", "assumed",     "phi-min",  "phi-max",
                                   "phi-known-min", "phi-known-max",  "phi",         "approach", "start",
                                   "centre",        "reason",         "false-share", "contact",  "contact-distance",
                                   "order"});
        ProbeTouch touch;
        touch.touch = index(json, "touch", place);
        touch.feature = index(json, "feature", place);
        touch.position = touch.start = touch.centre = point(json, "point", place);
        touch.tangent = direction(json, "tangent", place);
        touch.left_normal = direction(json, "left-normal", place);
        touch.right_normal = direction(json, "right-normal", place);
        touch.interior_angle = number(json, "interior-angle", place);
        if (!member(json, "assumed").is_boolean()) throw Error("{}: 'assumed' is not true or false", place);
        touch.assumed = member(json, "assumed").get<bool>();
        touch.range = {number(json, "phi-min", place), number(json, "phi-max", place)};
        touch.known_range = {number(json, "phi-known-min", place), number(json, "phi-known-max", place)};
        touch.phi = number(json, "phi", place);
        touch.reason = word<ProbeReason>(reasons, json, "reason", place);
        touch.contact = word<ProbeContact>(contacts, json, "contact", place);
        if (touch.reason == ProbeReason::none) {
            touch.approach = direction(json, "approach", place);
            touch.start = point(json, "start", place);
            touch.centre = point(json, "centre", place);
        } else {
            for (const char* key : {"approach", "start", "centre"})
                if (!member(json, key).is_null())
                    throw Error("{} is not made ({}), but has '{}'", place, name_of(touch.reason), key);
        }
        touch.false_share = number(json, "false-share", place);
        touch.contact_distance = number(json, "contact-distance", place);
        if (!member(json, "order").is_null()) touch.order = index(json, "order", place);
        plan_.touches.push_back(touch);
    }

    void read_move(const Json& json, const std::string& place) {
        if (!json.is_object()) throw Error("{} is not an object", place);
        require_keys(json, place, {"type", "touch", "points"});
        ProbeMove move{word<ProbeMoveType>(move_types, json, "type", place), index(json, "touch", place),
                       static_cast<u32>(path_.size()), 0};
        if (move.touch >= plan_.touches.size())
            throw Error("{} names touch {}; there are {}", place, move.touch, plan_.touches.size());
        for (const Json& point : list_member(json, "points", place))
            path_.push_back(vector_of(point, place + ": a point"));
        move.end = static_cast<u32>(path_.size());
        plan_.moves.push_back(move);
    }

    void use_origin() {
        BoundingBox box = bounding_box(path_);
        for (const ProbeTouch& touch : plan_.touches)
            for (const Vec3& p : {touch.position, touch.start, touch.centre}) box.add(p);
        plan_.frame.origin = distant_origin(box);
        for (ProbeTouch& touch : plan_.touches)
            for (Vec3* p : {&touch.position, &touch.start, &touch.centre}) *p -= plan_.frame.origin;
        for (Vec3& p : path_) p -= plan_.frame.origin;
        plan_.path = std::move(path_);
    }

    ProbePlan plan_;
    Array<Vec3> path_;
};

Array<Vec3> touch_points(const ProbePlan& plan) {
    Array<Vec3> points;
    for (const ProbeTouch& touch : plan.touches) points.push_back(touch.position);
    return points;
}

}  // namespace

std::string_view name_of(ProbeReason reason) { return reasons[static_cast<std::size_t>(reason)]; }
std::string_view name_of(ProbeContact contact) { return contacts[static_cast<std::size_t>(contact)]; }
std::string_view name_of(ProbeMoveType type) { return move_types[static_cast<std::size_t>(type)]; }

template <>
struct KindTraits<ProbePlan> {
    static constexpr std::string_view name = "probes";
    static constexpr bool is_geometric = true;
    /// Of the reference points.
    static RobustBox box(const ProbePlan& plan) { return bounding_box(touch_points(plan)); }
    static double spacing(const ProbePlan& plan) { return point_spacing(touch_points(plan)); }

    static void visit(FieldVisitor& visitor, ProbePlan& plan) {
        visitor.frame("frame", plan.frame);
        const auto positions = [&](const char* name, Vec3 ProbeTouch::*field) {
            visit_rows(
                plan.touches, [&](auto& touch) -> auto& { return touch.*field; },
                [&](Buffer<Vec3>& rows) { visitor.positions(name, rows); });
        };
        const auto directions = [&](const char* name, Vec3 ProbeTouch::*field) {
            visit_rows(
                plan.touches, [&](auto& touch) -> auto& { return touch.*field; },
                [&](Buffer<Vec3>& rows) { visitor.directions(name, rows); });
        };
        const auto plain = [&](const char* name, auto&& field) {
            visit_rows(plan.touches, field, [&](auto& rows) { visitor.plain(name, rows); });
        };
        positions("points", &ProbeTouch::position);
        positions("starts", &ProbeTouch::start);
        positions("centres", &ProbeTouch::centre);
        directions("tangents", &ProbeTouch::tangent);
        directions("left-normals", &ProbeTouch::left_normal);
        directions("right-normals", &ProbeTouch::right_normal);
        directions("approaches", &ProbeTouch::approach);
        plain("touches", [](auto& touch) -> auto& { return touch.touch; });
        plain("features", [](auto& touch) -> auto& { return touch.feature; });
        plain("interior-angles", [](auto& touch) -> auto& { return touch.interior_angle; });
        plain("assumed", [](auto& touch) -> auto& { return touch.assumed; });
        plain("phi-min", [](auto& touch) -> auto& { return touch.range.min; });
        plain("phi-max", [](auto& touch) -> auto& { return touch.range.max; });
        plain("phi-known-min", [](auto& touch) -> auto& { return touch.known_range.min; });
        plain("phi-known-max", [](auto& touch) -> auto& { return touch.known_range.max; });
        plain("phi", [](auto& touch) -> auto& { return touch.phi; });
        plain("reasons", [](auto& touch) -> auto& { return touch.reason; });
        plain("false-shares", [](auto& touch) -> auto& { return touch.false_share; });
        plain("contacts", [](auto& touch) -> auto& { return touch.contact; });
        visit_rows(
            plan.touches, [](auto& touch) -> auto& { return touch.contact_distance; },
            [&](Buffer<double>& rows) { visitor.lengths("contact-distances", rows, 1); });
        plain("orders", [](auto& touch) -> auto& { return touch.order; });

        const auto plain_of_moves = [&](const char* name, auto&& field) {
            visit_rows(plan.moves, field, [&](auto& rows) { visitor.plain(name, rows); });
        };
        plain_of_moves("move-types", [](auto& move) -> auto& { return move.type; });
        plain_of_moves("move-touches", [](auto& move) -> auto& { return move.touch; });
        plain_of_moves("move-begins", [](auto& move) -> auto& { return move.begin; });
        plain_of_moves("move-ends", [](auto& move) -> auto& { return move.end; });
        visitor.positions("path", plan.path);

        Array<double> lengths;
        for (const auto size : sizes) lengths.push_back(plan.*size);
        Buffer<double> visited_lengths(std::move(lengths));
        visitor.lengths("sizes", visited_lengths, 1);
        for (std::size_t i = 0; i < visited_lengths.size(); ++i) plan.*sizes[i] = visited_lengths[i];
        Buffer<Vec3> axis{plan.machine_axis};
        visitor.directions("machine-axis", axis);
        if (!axis.empty()) plan.machine_axis = axis[0];
    }

    static std::vector<PropertySpec> property_specs() {
        return {{"touches", Unit::count, "Touches, with those that are not made."},
                {"unreachable", Unit::count, "Touches that are not made.", Better::smaller}};
    }
    static std::vector<std::optional<double>> property_values(const ProbePlan& plan) {
        return {plan.touches.size(), std::ranges::count_if(plan.touches, [](const ProbeTouch& touch) {
                    return touch.reason != ProbeReason::none;
                })};
    }
    static void require_usable(const ProbePlan& plan) {
        require_consistent(plan);
        if (plan.touches.empty()) throw Error("the result has no touches");
    }

    static constexpr std::string_view json_member = "touches";
    static void to_json(const ProbePlan& plan, Json& document) {
        document = {{"scanmill", 1},
                    {"unit", unit_json(plan.frame.unit)},
                    {"frame", plan.frame.name.empty() ? Json(nullptr) : Json(plan.frame.name)}};
        for (std::size_t i = 0; i < sizes.size(); ++i) document[size_names[i]] = plan.*sizes[i];
        document["machine-axis"] = json_of(plan.machine_axis);
        document["touches"] = Json::array();
        document["moves"] = Json::array();
        for (const ProbeTouch& touch : plan.touches) document["touches"].push_back(touch_json(plan, touch));
        for (const ProbeMove& move : plan.moves) document["moves"].push_back(move_json(plan, move));
    }
    static ProbePlan from_json(const Json& document, const OnWarning&) { return ProbesReader().read(document); }
};

template Kind kind_of<ProbePlan>();

}  // namespace scanmill
