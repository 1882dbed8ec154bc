// SPDX-License-Identifier: GPL-3.0-or-later
// Reads measured points from the output of a measuring machine.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "scanmill/formats/common/built_in.hpp"
#include "scanmill/formats/dmis/dmis.hpp"
#include "scanmill/formats/dmis/statements.hpp"

namespace scanmill {

namespace dmis {

namespace {

/// Greatest difference from 1 of a direction's length: machines print three decimals, or more.
constexpr double direction_tolerance = 0.01;

/// Statements of programs that have nothing to read.
bool is_of_programs(std::string_view major) {
    constexpr std::array<std::string_view, 12> majors{"DMISMN", "FILNAM", "ENDFIL", "SNSLCT", "MODE",   "SNSET",
                                                      "DECPL",  "GOTO",   "PTMEAS", "ENDMES", "OUTPUT", "PRCOMP"};
    return std::ranges::find(majors, major) != majors.end();
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// The number that the last digits of a label spell; nullopt without digits, or with more than 32 bits can hold.
std::optional<u32> number_in(std::string_view label) {
    const auto last = std::find_if(label.rbegin(), label.rend(), is_digit);
    const auto first = std::find_if_not(last, label.rend(), is_digit);
    const std::string_view digits(first.base(), last.base());
    u32 number = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (digits.empty() || error != std::errc()) return std::nullopt;
    return number;
}

class ResultsReader {
public:
    ResultsReader(std::string_view text, const ReadOptions& options) : statements_(text), options_(options) {}

    LoadedFile read() {
        while (statements_.next()) {
            require_complete();
            take(statements_.current());
        }
        require_complete();
        if (positions_.empty()) {
            Error error("holds no measured points: no statement FA(label)=FEAT/POINT,CART");
            error.set_hint(nominals_.empty() ? "export the results of the machine as DMIS"
                                             : "it is a program; read the output of the machine that has run it");
            throw error;
        }
        require_features();
        require_countable(positions_.size(), "points");
        report();
        TriangleMesh vertices;
        vertices.vertex_columns.add(Column("touch", 1, Buffer(std::move(touches_))));
        vertices.vertex_columns.add(Column("approach", 3, Buffer(std::move(approaches_))));
        // UNITS is a declaration like those in comments, and the one that counts.
        std::vector<std::string> comments = statements_.comments().texts();
        std::erase_if(comments, [](const std::string& one) { return !declaration_in(one, "unit").empty(); });
        comments.push_back(fmt::format("unit {}", symbol(*unit_)));
        LoadedFile loaded =
            loaded_file("DMIS", "ascii", std::move(comments), std::move(positions_), std::move(vertices), options_);
        loaded.comments = statements_.comments().texts();
        return loaded;
    }

private:
    void require_complete() const {
        if (statements_.is_cut())
            throw Error("line {}: the file ends within a statement", statements_.line())
                .hint("the file is truncated: fetch it again; a complete one ends with ENDFIL");
    }

    void take(const Statement& one) {
        if (one.major == "DMISMN" || one.major == "FILNAM") is_open_ = true;
        if (one.major == "ENDFIL") is_open_ = false;
        if (one.is("FA", "FEAT") && one.field(0) == "POINT" && one.field(1) == "CART") return take_point(one);
        if (one.is("F", "FEAT")) {
            nominals_.emplace(one.label);
        } else if (one.is("", "UNITS")) {
            take_units(one);
        } else if (one.is("", "MEAS")) {
            take_measurement(one);
        } else if (one.is("S", "SNSDEF")) {
            require_probe(one);
        } else if (one.is("", "PRCOMP") && one.field(0) == "OFF") {
            is_uncompensated_ = true;
        } else if (!one.type.empty() || !is_of_programs(one.major)) {
            pass_over(one);
        }
    }

    void take_point(const Statement& one) {
        if (!unit_)
            throw Error("line {}: {} is measured before any UNITS statement", one.line, name_of_point(one))
                .hint("export the results with their head, or add UNITS/MM,ANGDEC above");
        constexpr std::size_t words = 2, numbers = 6;
        if (one.fields.size() != words + numbers)
            throw Error("line {}: {} has {}; x, y, z, i, j, k are needed", one.line, name_of_point(one),
                        count_text(one.fields.size() - words, "number", "numbers"))
                .hint("the statement is truncated, or its machine reports points otherwise");
        std::array<double, numbers> values;
        for (std::size_t i = 0; i < numbers; ++i) {
            const std::string_view text = one.fields[words + i];
            if (!parse_number(text, values[i]) || !std::isfinite(values[i]))
                throw Error("line {}: {} has {} where a finite number is needed", one.line, name_of_point(one),
                            quote(text))
                    .hint("remove the point, if the machine could not measure it");
        }
        const std::optional<u32> touch = number_in(one.label);
        if (!touch)
            throw Error("line {}: {} has no number in its label, or one that is too large", one.line,
                        name_of_point(one))
                .hint("a label ends with the number of its touch, as P000012 does");
        const Vec3 approach(values[3], values[4], values[5]);
        if (!(std::abs(approach.norm() - 1) <= direction_tolerance))
            throw Error("line {}: the direction of {} has the length {:.4g}, not 1", one.line, name_of_point(one),
                        approach.norm())
                .hint("i, j, k point from the part to the probe");
        references_.push_back({std::string(one.label), one.line, "FA"});
        positions_.push_back({values[0], values[1], values[2]});
        touches_.push_back(*touch);
        const Vec3 direction = approach.normalized();
        approaches_.insert(approaches_.end(), direction.begin(), direction.end());
    }

    static std::string name_of_point(const Statement& one) { return "FA(" + printable(one.label) + ")"; }

    /// The beginning of the text with '?' for characters that do not belong into a message.
    static std::string printable(std::string_view text) {
        constexpr std::size_t most = 24;
        std::string shown(text.substr(0, most));
        for (char& c : shown)
            if (c < ' ' || c > '~') c = '?';
        return shown;
    }

    void take_units(const Statement& one) {
        const std::optional<LengthUnit> unit = unit_named(one.field(0));
        if (!unit)
            throw Error("line {}: the unit {} is unknown; DMIS has {}", one.line, quote(one.field(0)), unit_names())
                .hint("correct UNITS");
        if (unit_ && *unit_ != *unit)
            throw Error("line {}: the unit changes from {} to {}", one.line, unit_name(*unit_), unit_name(*unit))
                .hint("write the points of each unit into a file of its own");
        unit_ = unit;
    }

    void take_measurement(const Statement& one) {
        const std::string_view feature = one.field(1);
        if (feature.starts_with("F(") && feature.ends_with(')'))
            references_.push_back({std::string(trimmed(feature.substr(2, feature.size() - 3))), one.line, "MEAS"});
        else
            throw Error("line {}: MEAS names no feature", one.line).hint("MEAS/POINT,F(P000012),1 is complete");
    }

    static void require_probe(const Statement& one) {
        if (one.field(0) != "PROBE")
            throw Error("line {}: the sensor {} is {}, which is not a touch probe", one.line, printable(one.label),
                        quote(one.field(0)))
                .hint("measure the touches with a PROBE");
    }

    void pass_over(const Statement& one) {
        std::string name = one.type.empty() ? "" : printable(one.type) + "=";
        name += printable(one.major);
        if (one.major == "FEAT") name += "/" + printable(one.field(0));
        if (one.field(0) == "POINT") name += "," + printable(one.field(1));  // polar coordinates
        ++passed_over_[name];
    }

    void require_features() const {
        if (nominals_.empty()) return;  // results alone
        for (const Reference& one : references_)
            if (!nominals_.contains(one.label))
                throw Error("line {}: {} of {}, but the file has no F({})", one.line, one.statement,
                            printable(one.label), printable(one.label))
                    .hint("the file has the features of other touches; it is incomplete or edited");
    }

    void report() const {
        constexpr std::size_t most_names = 10;
        std::vector<std::string> parts, names;
        u64 statements = 0;
        for (const auto& [name, count] : passed_over_) {
            statements += count;
            if (names.size() < most_names) names.push_back(fmt::format("{} {}", count, name));
        }
        if (passed_over_.size() > most_names)
            names.push_back(fmt::format("and {} more", passed_over_.size() - most_names));
        if (statements > 0)
            parts.push_back(
                fmt::format("{} ({})", count_text(statements, "statement", "statements"), fmt::join(names, ", ")));
        if (const u64 bytes = statements_.foreign_bytes(); bytes > 0)
            parts.push_back(count_text(bytes, "byte that is not ASCII", "bytes that are not ASCII"));
        if (!parts.empty()) warn(options_.on_warning, "passed over {}", fmt::join(parts, " and "));
        if (const u64 lines = statements_.long_lines(); lines > 0)
            warn(options_.on_warning, "{} longer than {} characters, the limit of DMIS; {} read nevertheless",
                 count_text(lines, "line is", "lines are"), longest_line, by_count(lines, "it was", "they were"));
        if (is_open_) warn(options_.on_warning, "the file does not end with ENDFIL: it may be incomplete");
        if (is_uncompensated_)
            warn(options_.on_warning, "PRCOMP/OFF: the points are centres of the ball, not contacts");
    }

    struct Reference {
        std::string label;
        std::size_t line;
        std::string_view statement;
    };

    Statements statements_;
    const ReadOptions& options_;
    std::optional<LengthUnit> unit_;
    bool is_open_ = false;  ///< whether a program or output has begun and not ended
    bool is_uncompensated_ = false;
    Array<Vec3> positions_;
    Array<u32> touches_;
    Array<double> approaches_;
    std::set<std::string, std::less<>> nominals_;  ///< labels of features
    std::vector<Reference> references_;
    std::map<std::string, u64> passed_over_;
};

}  // namespace

Recognition recognise(std::string_view head, u64) {
    Statements statements(without_byte_order_mark(head));
    if (!statements.next()) return Recognition::no;
    const Statement& first = statements.current();
    return first.is("", "DMISMN") || first.is("", "FILNAM") ? Recognition::certain : Recognition::no;
}

LoadedFile read_results(const FileBytes& file, const ReadOptions& options) {
    return ResultsReader(without_byte_order_mark(file.bytes), options).read();
}

}  // namespace dmis

Format dmis_format() {
    return {"DMIS", {"dmi"}, dmis::recognise, dmis::read_results, {{kind_of<ProbePlan>(), dmis::write_program}}};
}

}  // namespace scanmill
