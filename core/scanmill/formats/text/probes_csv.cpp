// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numbers>

#include "scanmill/formats/common/built_in.hpp"
#include "scanmill/formats/common/writing.hpp"

namespace scanmill {

namespace {

/// The fields of a touch in the order of the columns. Fields that are not listed follow.
constexpr std::array<std::string_view, 21> order{
    "touch",  "feature", "point",       "approach",      "order",         "reason",         "assumed",
    "phi",    "phi-min", "phi-max",     "phi-known-min", "phi-known-max", "interior-angle", "start",
    "centre", "tangent", "left-normal", "right-normal",  "false-share",   "contact",        "contact-distance"};

/// A field's columns: their names, or the texts of one row.
struct Cells {
    std::string_view field;
    std::vector<std::string> texts;
};

/// The names of a field's columns: one for a number, three for a vector. The columns of point and approach do not have
/// the field's name in them.
template <class Field>
Cells names_of_columns(const Field& field) {
    const std::string_view name = field.name;
    if constexpr (!std::same_as<typename Field::Member, Vec3>) {
        return {name, {std::string(name)}};
    } else {
        Cells cells{name, {}};
        const std::string prefix = name == "point" || name == "approach" ? "" : std::string(name) + "-";
        for (const char axis : std::string_view(field.meaning == Meaning::position ? "xyz" : "ijk"))
            cells.texts.push_back(prefix + axis);
        return cells;
    }
}

std::string text_of(double number) { return std::isfinite(number) ? number_text(number) : ""; }

template <class Field>
Cells cells_of(const Frame& frame, const ProbeTouch& touch, const Field& field) {
    using Member = typename Field::Member;
    const Member& member = touch.*field.member;
    const bool applies = !field.applies || field.applies(touch);
    if constexpr (std::same_as<Member, Vec3>) {
        if (!applies) return {field.name, {"", "", ""}};
        const Vec3 vector = field.meaning == Meaning::position ? world(frame, member) : member;
        return {field.name, {text_of(vector.x()), text_of(vector.y()), text_of(vector.z())}};
    } else if constexpr (std::same_as<Member, double>) {
        const bool is_angle = field.unit_text == std::string_view("rad");
        return {field.name, {text_of(is_angle ? member * 180 / std::numbers::pi : member)}};  // in degrees
    } else if constexpr (std::same_as<Member, bool>) {
        return {field.name, {member ? "yes" : "no"}};
    } else if constexpr (Named<Member>) {
        return {field.name, {std::string(name_of(member))}};
    } else {
        const bool is_undefined = field.is_nullable && member == std::numeric_limits<Member>::max();
        return {field.name, {is_undefined ? "" : std::to_string(member)}};
    }
}

/// Writes a line with the texts that cells(field) returns for each field.
void write_line(OutputBuffer& out, auto&& cells) {
    std::vector<Cells> all;
    for_each_field<ProbeTouch>([&](const auto& field) { all.push_back(cells(field)); });
    std::ranges::stable_sort(all, {}, [](const Cells& one) { return std::ranges::find(order, one.field); });
    bool is_first = true;
    for (const Cells& one : all)
        for (const std::string& text : one.texts) {
            if (!std::exchange(is_first, false)) out.text(",");
            out.text(text);
        }
    out.text("\n");
}

void write(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const ProbePlan& plan = *value.get<ProbePlan>();
    warn_lost_precision(plan.frame, positions_of(value).span(), false, "CSV", options);
    out.text(comment_lines(plan.frame));
    write_line(out, [](const auto& field) { return names_of_columns(field); });
    for (const ProbeTouch& touch : plan.touches)
        write_line(out, [&](const auto& field) { return cells_of(plan.frame, touch, field); });
}

}  // namespace

Format probes_csv_format() {
    const auto recognise = [](std::string_view, u64) { return Recognition::no; };
    // The format of points reads files with this extension.
    const auto refuse = [](const FileBytes&, const ReadOptions&) -> LoadedFile {
        throw Error("probes are not read from CSV").hint("read them from JSON");
    };
    return {"CSV of probes", {"csv"}, recognise, refuse, {{kind_of<ProbePlan>(), write}}, true};
}

}  // namespace scanmill
