// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>

#include "scanmill/formats/common/built_in.hpp"
#include "scanmill/formats/common/writing.hpp"
#include "scanmill/kinds/probes.hpp"

namespace scanmill {

namespace {

constexpr std::string_view header =
    "touch,feature,x,y,z,i,j,k,order,reason,assumed,phi,phi-min,phi-max,phi-known-min,phi-known-max,interior-angle,"
    "start-x,start-y,start-z,centre-x,centre-y,centre-z,tangent-i,tangent-j,tangent-k,left-normal-i,left-normal-j,"
    "left-normal-k,right-normal-i,right-normal-j,right-normal-k,false-share,contact,contact-distance\n";

/// Writes fields of one row; the first has no comma before it.
class Row {
public:
    explicit Row(OutputBuffer& out) : out_(out) {}
    void index(u32 number) {
        separate();
        out_.number(number);
    }
    void number(double number) {
        separate();
        if (std::isfinite(number)) out_.number(number);
    }
    void degrees(double radians) { number(radians * 180 / std::numbers::pi); }
    void word(std::string_view word) {
        separate();
        out_.text(word);
    }
    void vector(const Vec3& vector) {
        for (const double component : {vector.x(), vector.y(), vector.z()}) number(component);
    }
    void nothing(int fields) {
        for (int field = 0; field < fields; ++field) separate();
    }

private:
    void separate() {
        if (!is_first_) out_.text(",");
        is_first_ = false;
    }
    OutputBuffer& out_;
    bool is_first_ = true;
};

void write_touch(const ProbePlan& plan, const ProbeTouch& touch, OutputBuffer& out) {
    const bool is_made = touch.reason == ProbeReason::none;
    Row row(out);
    row.index(touch.touch);
    row.index(touch.feature);
    row.vector(world(plan.frame, touch.position));
    is_made ? row.vector(touch.approach) : row.nothing(3);
    touch.order == ProbeTouch::no_order ? row.nothing(1) : row.index(touch.order);
    row.word(name_of(touch.reason));
    row.word(touch.assumed ? "yes" : "no");
    for (const double angle : {touch.phi, touch.range.min, touch.range.max, touch.known_range.min,
                               touch.known_range.max, touch.interior_angle})
        row.degrees(angle);
    if (is_made) {
        row.vector(world(plan.frame, touch.start));
        row.vector(world(plan.frame, touch.centre));
    } else {
        row.nothing(6);
    }
    for (const Vec3& direction : {touch.tangent, touch.left_normal, touch.right_normal}) row.vector(direction);
    row.number(touch.false_share);
    row.word(name_of(touch.contact));
    row.number(touch.contact_distance);
    out.text("\n");
}

void write(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const ProbePlan& plan = *value.get<ProbePlan>();
    warn_lost_precision(plan.frame, positions_of(value).span(), false, "CSV", options);
    out.text(comment_lines(plan.frame));
    out.text(header);
    for (const ProbeTouch& touch : plan.touches) write_touch(plan, touch, out);
}

}  // namespace

Format probes_csv_format() {
    const auto recognise = [](std::string_view, u64) { return Recognition::no; };
    // Files with this extension are read by the format of points as CSV.
    const auto refuse = [](const FileBytes&, const ReadOptions&) -> LoadedFile {
        throw Error("probes are not read from CSV").hint("read them from JSON");
    };
    return {"CSV of probes", {"csv"}, recognise, refuse, {{kind_of<ProbePlan>(), write}}, true};
}

}  // namespace scanmill
