// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a probe plan as a DMIS program.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "scanmill/formats/common/writing.hpp"
#include "scanmill/formats/dmis/dmis.hpp"
#include "scanmill/formats/dmis/header.hpp"
#include "scanmill/formats/dmis/statements.hpp"
#include "scanmill/kinds/kind.hpp"

namespace scanmill::dmis {

namespace {

/// Decimals of coordinates and of directions. A direction with four decimals is a unit vector within unit_tolerance.
constexpr u32 least_decimals = 4;
/// Share of the ball's radius that the last decimal of a coordinate may be.
constexpr double exactness = 1e-4;
/// Coordinates beyond this do not fit on a line with a useful number of decimals.
constexpr double largest_coordinate = 1e12;

/// 10^-decimals, to a few ulps.
double step_of(u32 decimals) {
    double step = 1;
    for (u32 i = 0; i < decimals; ++i) step /= 10;
    return step;
}

bool is_exact(u32 decimals, double radius) {
    constexpr double rounding = 1e-9;
    return step_of(decimals) <= exactness * radius * (1 + rounding);
}

u32 auto_decimals(double radius) {
    u32 decimals = least_decimals;
    while (decimals < DmisOptions::most_decimals && !is_exact(decimals, radius)) ++decimals;
    return decimals;
}

/// Three numbers as they are written, and the numbers that a reader of the text gets.
struct Written {
    std::string text;  ///< "1.0000,2.0000,3.0000"
    Vec3 value;
};

Written written(const Vec3& vector, u32 decimals) {
    Written result;
    for (int axis = 0; axis < 3; ++axis) {
        const std::string number = fixed_text(vector[axis], decimals);
        parse_number(number, result.value[axis]);
        if (axis > 0) result.text += ",";
        result.text += number;
    }
    return result;
}

class ProgramWriter {
public:
    ProgramWriter(const ProbePlan& plan, OutputBuffer& out, const WriteOptions& options)
        : plan_(plan),
          out_(out),
          options_(options) {}

    void write() {
        choose_decimals();
        choose_touches();
        choose_labels();
        const std::string header = header_lines(plan_, approach_length(), decimals_);
        require_free_labels(header);
        if (const std::string name = comment_name(plan_.frame.name);
            plan_.dmis.header.empty() && name != one_line(plan_.frame.name))
            warn(options_.on_warning, "DMIS has the frame's name {} as {}", quote(plan_.frame.name), quote(name));
        put("DMISMN/'PROBES',05.2");
        put("FILNAM/'PROBES',05.2");
        out_.text(header);
        put_unmade();
        for (const u32 row : rows_) put_touch(row);
        put("ENDFIL");
    }

private:
    void choose_decimals() {
        const double radius = plan_.radius;
        if (!(radius > 0) || !std::isfinite(radius))
            throw Error("the plan's ball has the radius {}", number_text(radius))
                .hint("plan again with a radius above 0");
        decimals_ = plan_.dmis.decimals;
        if (decimals_ == DmisOptions::auto_decimals) decimals_ = auto_decimals(radius);
        if (decimals_ > DmisOptions::most_decimals)
            throw Error("the plan wants {} decimals in DMIS; at most {} are written", decimals_,
                        DmisOptions::most_decimals)
                .hint("null in the plan chooses them by the radius");
        if (!is_exact(decimals_, radius))
            warn(options_.on_warning, "coordinates have {} in DMIS; the last is {:.2g} of the ball's radius",
                 count_text(decimals_, "decimal", "decimals"), step_of(decimals_) / radius);
    }

    /// Computes rows_ and moves_.
    void choose_touches() {
        for (u32 row = 0; row < plan_.touches.size(); ++row)
            if (plan_.touches[row].is_made()) rows_.push_back(row);
        unmade_ = plan_.touches.size() - rows_.size();
        if (rows_.empty())
            throw Error("no touch of the plan is made: {} cannot be made", count_text(unmade_, "touch", "touches"))
                .hint("write JSON or CSV, which have the reasons");
        std::ranges::stable_sort(rows_, {}, [&](u32 row) { return plan_.touches[row].order; });
        moves_.assign(plan_.touches.size(), nullptr);
        for (const ProbeMove& move : plan_.moves)
            if (move.type == ProbeMoveType::clearance && move.touch < moves_.size()) {
                if (moves_[move.touch]) throw_moves(move.touch, "more than one clearance move leads");
                moves_[move.touch] = &move;
            }
        for (const u32 row : rows_) {
            const ProbeTouch& touch = plan_.touches[row];
            if (!moves_[row]) throw_moves(row, "no clearance move leads");
            for (const Vec3& point : moves_[row]->points) require_writable(row, point);
            for (const Vec3& point : {touch.position, touch.start}) require_writable(row, point);
            // Not a number if a component is none.
            if (!(std::abs(written(touch.approach, vector_decimals()).value.norm() - 1) <= unit_tolerance))
                throw Error("the approach of touch {} has the length {:.6g}, not 1", touch.touch, touch.approach.norm())
                    .hint("an approach is a unit vector from the part to the probe; plan again");
        }
    }

    [[noreturn]] void throw_moves(u32 row, std::string_view defect) const {
        throw Error("{} to touch {} (row {} of the plan)", defect, plan_.touches[row].touch, row)
            .hint("plan again: a machine must not move where nothing was checked");
    }

    void require_writable(u32 row, const Vec3& point) const {
        const Vec3 p = world(plan_.frame, point);
        for (const double coordinate : p)
            if (!(std::abs(coordinate) <= largest_coordinate))
                throw Error("touch {} or the way to it has the coordinate {}, beyond what DMIS can write",
                            plan_.touches[row].touch, number_text(coordinate))
                    .hint("write JSON, or plan in a frame nearer to the part");
    }

    /// P000012, and P000012A and P000012B for the touches of one reference point.
    void choose_labels() {
        std::map<u32, std::vector<u32>> rows_of;
        for (u32 row = 0; row < plan_.touches.size(); ++row)
            if (plan_.touches[row].is_made()) rows_of[plan_.touches[row].touch].push_back(row);
        labels_.resize(plan_.touches.size());
        for (const auto& [touch, rows] : rows_of) {
            if (rows.size() > 2)
                throw Error("touch {} occurs {} times in the plan; DMIS labels distinguish two directions", touch,
                            rows.size())
                    .hint("number the touches of other reference points differently");
            for (std::size_t i = 0; i < rows.size(); ++i) {
                std::string& label = labels_[rows[i]];
                label = fmt::format("P{:06}", touch);
                if (rows.size() > 1) label += static_cast<char>('A' + i);
                if (label.size() > longest_label)
                    throw Error("touch {} needs the label {}; DMIS labels have at most {} characters", touch, label,
                                longest_label)
                        .hint("number the touches from 0");
            }
        }
    }

    /// Throws Error if the header defines one of the labels.
    void require_free_labels(const std::string& header) const {
        const std::set<std::string_view> used(labels_.begin(), labels_.end());
        Statements statements(header);
        while (statements.next())
            if (const Statement& one = statements.current(); one.is("F", "FEAT") && used.contains(one.label))
                throw Error("the DMIS header defines the feature {}, which is the label of a touch", one.label)
                    .hint("labels of touches are P and six digits or more; choose another name");
    }

    /// The distance from an edge to the ball's surface where the nearest approach begins. It is the shortest one,
    /// because the way beyond a start is not checked. It is computed from the written numbers, so that the program
    /// determines it.
    double approach_length() const {
        double least = std::numeric_limits<double>::infinity();
        for (const u32 row : rows_)
            least = std::min(
                least, (position(plan_.touches[row].start).value - position(plan_.touches[row].position).value).norm());
        return std::max(0.0, least - plan_.radius);
    }

    u32 vector_decimals() const { return std::max(decimals_, least_decimals); }
    Written position(const Vec3& point) const { return written(world(plan_.frame, point), decimals_); }

    void put(std::string_view statement) { out_.text(lines_of(statement)); }

    void put_unmade() {
        if (unmade_ == 0) return;
        put(fmt::format("$$ touches left out: {}", unmade_));
        warn(options_.on_warning, "{} that cannot be made {} left out of the program; JSON and CSV have the reasons",
             count_text(unmade_, "touch", "touches"), by_count(unmade_, "was", "were"));
    }

    /// A move of the ball's centre, unless it is there.
    void put_move(const Vec3& point) {
        std::string there = position(point).text;
        if (there == here_) return;
        here_ = std::move(there);
        put((plan_.dmis.moves == DmisGoto::cart ? "GOTO/CART," : "GOTO/") + here_);
    }

    void put_touch(u32 row) {
        const ProbeTouch& touch = plan_.touches[row];
        for (const Vec3& point : moves_[row]->points) put_move(point);
        put_move(touch.start);
        const std::string& label = labels_[row];
        const std::string nominal =
            position(touch.position).text + "," + written(touch.approach, vector_decimals()).text;
        put(fmt::format("F({})=FEAT/POINT,CART,{}", label, nominal));
        put(fmt::format("MEAS/POINT,F({}),1", label));
        put("PTMEAS/CART," + nominal);
        put("ENDMES");
        put(fmt::format("OUTPUT/FA({})", label));
        here_.clear();  // the machine has retracted, so the next move must be written even to the same place
        put_move(touch.start);
    }

    const ProbePlan& plan_;
    OutputBuffer& out_;
    const WriteOptions& options_;
    u32 decimals_ = 0;
    std::vector<u32> rows_;  ///< touches that are made, in their order
    std::size_t unmade_ = 0;
    std::vector<const ProbeMove*> moves_;  ///< the clearance move to each touch
    std::vector<std::string> labels_;  ///< one per touch; empty if it is not made
    std::string here_;  ///< where the ball's centre is, as text; empty if unknown
};

}  // namespace

void write_program(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const ProbePlan& plan = *value.get<ProbePlan>();
    if (plan.frame.unit == LengthUnit::unknown)
        throw Error("the plan's unit is unknown, and a machine must not guess it")
            .hint("declare the unit of the scan, for example `unit: mm` of the input in the workflow, and plan again");
    if (plan.frame.unit == LengthUnit::micrometre) {
        warn(options.on_warning, "DMIS has no micrometres; the program is in mm");
        return write_program(in_unit(value, LengthUnit::millimetre), out, options);
    }
    ProgramWriter(plan, out, options).write();
}

}  // namespace scanmill::dmis
