// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A strict reader of the DMIS programs that scanmill writes with its default header. It is independent of the library:
/// it checks every rule of the subset and rebuilds the plan from the program alone.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <regex>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "scanmill/data/probes.hpp"

namespace scanmill::test {

class DmisProgram {
public:
    /// Throws std::runtime_error with the rule that the program breaks.
    explicit DmisProgram(const std::string& text) {
        split(text);
        read_head();
        while (!at("ENDFIL")) read_touch();
        next();
        require(at_ == statements_.size(), "statements after ENDFIL");
        rebuild();
    }

    const ProbePlan& plan() const { return plan_; }
    std::size_t decimals() const { return decimals_; }
    double approach() const { return approach_; }
    const std::vector<std::string>& labels() const { return labels_; }

private:
    struct Touch {
        u32 number;
        std::string letter;
        Vec3 position, direction, start;
        Array<Vec3> way;
        u32 order;
    };

    static void require(bool holds, const std::string& rule) {
        if (!holds) throw std::runtime_error(rule);
    }

    /// Lines, comments and continuation.
    void split(const std::string& text) {
        require(!text.empty() && text.back() == '\n', "no line end at the end");
        std::string statement;
        std::size_t begin = 0;
        for (std::size_t end; begin < text.size(); begin = end + 1) {
            end = text.find('\n', begin);
            const std::string line = text.substr(begin, end - begin);
            require(line.size() <= 80, "a line of more than 80 characters");
            for (const char c : line) require(c >= ' ' && c <= '~', "a character that is not printable ASCII");
            require(!line.empty(), "an empty line");
            if (line.starts_with("$$")) {
                require(statement.empty(), "a comment inside a statement");
                read_comment(line.substr(2));
                continue;
            }
            require(line.find("$$") == std::string::npos, "a comment beside a statement");
            const bool goes_on = line.back() == '$';
            statement += goes_on ? line.substr(0, line.size() - 1) : line;
            require(statement.find('$') == std::string::npos, "a dollar sign inside a line");
            if (goes_on) continue;
            statements_.push_back(statement);
            statement.clear();
        }
        require(statement.empty(), "the last statement is not complete");
    }

    void read_comment(const std::string& comment) {
        std::smatch match;
        if (std::regex_match(comment, match, std::regex(" (radius|scanner-error|stylus-length|frame) (.+)")))
            require(comments_.emplace(match[1], match[2]).second, "a comment twice");
        else if (std::regex_match(comment, match, std::regex(" touches left out: ([0-9]+)")))
            left_out_ = std::stoul(match[1]);
        else
            require(false, "an unknown comment");
    }

    bool at(const std::string& begin) const { return at_ < statements_.size() && statements_[at_].starts_with(begin); }
    const std::string& next() {
        require(at_ < statements_.size(), "the program ends without ENDFIL");
        return statements_[at_++];
    }
    /// The groups of the next statement, which must match the whole pattern.
    std::smatch take(const std::string& pattern) {
        const std::string& statement = next();
        std::smatch match;
        require(std::regex_match(statement, match, std::regex(pattern)),
                "'" + statement + "' where '" + pattern + "' is needed");
        return match;
    }

    static double parse(const std::string& text) {
        double number = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        require(error == std::errc() && end == text.data() + text.size(), "'" + text + "' is not a number");
        return number;
    }
    double number(const std::string& text, std::size_t decimals) const {
        require(std::regex_match(text, std::regex("-?(0|[1-9][0-9]*)(\\.[0-9]+)?")), "'" + text + "' has a bad form");
        require(text.find_first_of("123456789") != std::string::npos || text.front() != '-', "a negative zero");
        const std::size_t point = std::min(text.find('.'), text.size() - 1);
        require(text.size() - point - 1 == decimals, "'" + text + "' has another number of decimals");
        return parse(text);
    }
    Vec3 vector(const std::string& text, std::size_t decimals) const {
        std::smatch match;
        require(std::regex_match(text, match, std::regex("([^,]*),([^,]*),([^,]*)")), "'" + text + "' is not a vector");
        return {number(match[1], decimals), number(match[2], decimals), number(match[3], decimals)};
    }
    Vec3 direction(const std::string& text) const {
        const Vec3 result = vector(text, std::max<std::size_t>(decimals_, 4));
        require(std::abs(result.norm() - 1) <= 1e-4, "'" + text + "' is not a unit vector");
        return result;
    }
    double length(const std::string& keyword) { return number(take(keyword + ",([^,]*)")[1], decimals_); }

    void read_head() {
        take("DMISMN/'[A-Z0-9_]+',05\\.2");
        take("FILNAM/'[A-Z0-9_]+',05\\.2");
        static const std::map<std::string, LengthUnit> units{{"MM", LengthUnit::millimetre},
                                                             {"CM", LengthUnit::centimetre},
                                                             {"M", LengthUnit::metre},
                                                             {"INCH", LengthUnit::inch},
                                                             {"FEET", LengthUnit::foot}};
        const std::string unit = take("UNITS/([A-Z]+),ANGDEC")[1];
        require(units.contains(unit), "an unknown unit");
        plan_.frame.unit = units.at(unit);
        decimals_ = std::stoul(take("DECPL/ALL,([0-9]+)")[1]);
        plan_.frame.name = comments_["frame"];
        for (const char* name : {"radius", "scanner-error", "stylus-length"})
            require(comments_.contains(name), std::string("no comment with the ") + name);
        plan_.radius = parse(comments_["radius"]);
        plan_.scanner_error = parse(comments_["scanner-error"]);
        plan_.stylus_length = parse(comments_["stylus-length"]);
        const std::string three = "([^,]*,[^,]*,[^,]*)";
        const std::smatch sensor = take("S\\(TIP1\\)=SNSDEF/PROBE,FIXED,CART," + three + "," + three + ",([^,]*)");
        const Vec3 offset = vector(sensor[1], decimals_);
        plan_.machine_axis = -direction(sensor[2]);
        require((offset + plan_.stylus_length * plan_.machine_axis).norm() <= std::pow(10.0, -double(decimals_)),
                "the ball is not at the end of the stylus");
        require(near(number(sensor[3], decimals_), 2 * plan_.radius), "the diameter is not twice the radius");
        take("SNSLCT/S\\(TIP1\\)");
        take("PRCOMP/ON");
        take("MODE/PROG,MAN");
        approach_ = length("SNSET/APPRCH");
        require(length("SNSET/RETRCT") == approach_, "the retract distance is not the approach distance");
        require(near(length("SNSET/SEARCH"), plan_.radius + 2 * plan_.scanner_error), "another search distance");
        plan_.clearance = length("SNSET/CLRSRF");
    }

    bool near(double a, double b) const { return std::abs(a - b) <= 0.501 * std::pow(10.0, -double(decimals_)); }

    Vec3 read_goto() {
        const std::smatch match = take("GOTO/(CART,)?([^,]*,[^,]*,[^,]*)");
        const DmisGoto spelling = match[1].matched ? DmisGoto::cart : DmisGoto::plain;
        if (has_moved_) require(plan_.dmis.moves == spelling, "two spellings of GOTO");
        plan_.dmis.moves = spelling;
        has_moved_ = true;
        return vector(match[2], decimals_);
    }

    void read_touch() {
        Touch touch;
        touch.order = static_cast<u32>(touches_.size());
        while (at("GOTO")) touch.way.push_back(read_goto());
        require(!touch.way.empty() || has_moved_, "a touch without a move to it");
        if (touch.way.empty()) touch.way.push_back(here_);
        touch.start = touch.way.back();
        const std::smatch feature = take("F\\(([^)]*)\\)=FEAT/POINT,CART,([^,]*,[^,]*,[^,]*),([^,]*,[^,]*,[^,]*)");
        const std::string label = feature[1];
        require(std::regex_match(label, std::regex("[A-Z0-9_]{1,10}")), "a label with other characters, or too long");
        require(std::ranges::find(labels_, label) == labels_.end(), "a label twice");
        labels_.push_back(label);
        std::smatch parts;
        require(std::regex_match(label, parts, std::regex("P([0-9]{6}|[1-9][0-9]{6,})([AB]?)")), "another label");
        touch.number = static_cast<u32>(std::stoul(parts[1]));
        touch.letter = parts[2];
        touch.position = vector(feature[2], decimals_);
        touch.direction = direction(feature[3]);
        const std::smatch measurement = take("MEAS/POINT,F\\(([^)]*)\\),([0-9]+)");
        require(measurement[1] == label, "a measurement of another feature");
        std::size_t points = 0;
        for (; at("PTMEAS"); ++points) {
            const std::smatch point = take("PTMEAS/CART,([^,]*,[^,]*,[^,]*),([^,]*,[^,]*,[^,]*)");
            require(point[1] == feature[2] && point[2] == feature[3], "a touch of another point");
        }
        require(std::to_string(points) == measurement[2] && points == 1, "another number of touches");
        take("ENDMES");
        require(take("OUTPUT/FA\\(([^)]*)\\)")[1] == label, "an output of another feature");
        here_ = read_goto();
        require(here_ == touch.start, "the ball does not return to the start");
        touches_.push_back(std::move(touch));
    }

    void rebuild() {
        require(!touches_.empty(), "no touches");
        std::map<u32, std::set<std::string>> letters;
        double least = INFINITY;
        for (const Touch& one : touches_) {
            letters[one.number].insert(one.letter);
            least = std::min(least, (one.start - one.position).norm());
        }
        for (const auto& [number, of_touch] : letters)
            require(of_touch == std::set<std::string>{""} || of_touch == std::set<std::string>{"A", "B"},
                    "directions that are not A and B");
        require(near(approach_, std::max(0.0, least - plan_.radius)), "another approach distance");
        // Rows are in the order of their labels, moves in the order of the program.
        std::vector<const Touch*> rows;
        for (const Touch& one : touches_) rows.push_back(&one);
        std::ranges::sort(rows, {}, [](const Touch* one) { return std::pair(one->number, one->letter); });
        std::vector<u32> row_of(rows.size());
        for (const Touch* one : rows) {
            row_of[one->order] = static_cast<u32>(plan_.touches.size());
            ProbeTouch& touch = plan_.touches.emplace_back();
            touch.touch = one->number;
            touch.position = one->position;
            touch.approach = one->direction;
            touch.start = one->start;
            touch.centre = one->position + plan_.radius * one->direction;
            touch.order = one->order;
        }
        for (const Touch& one : touches_) plan_.moves.push_back({ProbeMoveType::clearance, row_of[one.order], one.way});
        for (std::size_t i = 0; i < left_out_; ++i) {
            plan_.touches.emplace_back();
            plan_.touches.back().reason = ProbeReason::obstructed;
        }
        plan_.dmis.decimals = static_cast<u32>(decimals_);
    }

    std::vector<std::string> statements_, labels_;
    std::map<std::string, std::string> comments_;
    std::size_t at_ = 0, decimals_ = 0, left_out_ = 0;
    double approach_ = 0;
    bool has_moved_ = false;
    Vec3 here_;
    std::vector<Touch> touches_;
    ProbePlan plan_;
};

}  // namespace scanmill::test
