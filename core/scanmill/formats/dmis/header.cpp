// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/dmis/header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>

#include "scanmill/formats/common/writing.hpp"
#include "scanmill/formats/dmis/statements.hpp"

namespace scanmill::dmis {

namespace {

const std::vector<std::string>& placeholders() {
    static const std::vector<std::string> names{"radius",  "diameter", "unit",     "approach",
                                                "retract", "search",   "clearance"};
    return names;
}

bool is_printable(char c) { return (c >= ' ' && c <= '~') || c == '\t'; }

/// Calls action(line, number) for every line of the text, without line ends.
void for_each_line(std::string_view text, const std::function<void(std::string_view, std::size_t)>& action) {
    for (std::size_t number = 1; !text.empty(); ++number) {
        const std::size_t size = std::min(text.find_first_of("\r\n"), text.size());
        action(text.substr(0, size), number);
        text.remove_prefix(size);
        if (text.starts_with("\r\n")) text.remove_prefix(1);
        if (!text.empty()) text.remove_prefix(1);
    }
}

/// The line with its placeholders replaced by the results of `value`. Throws Error for an unknown placeholder.
std::string filled(std::string_view line, std::size_t number,
                   const std::function<std::string(std::string_view)>& value) {
    std::string text;
    while (!line.empty()) {
        const std::size_t open = std::min(line.find('{'), line.size());
        text.append(line.substr(0, open));
        line.remove_prefix(open);
        const std::size_t close = line.find('}');
        if (close == std::string_view::npos) return text.append(line);
        const std::string name(line.substr(1, close - 1));
        if (std::ranges::find(placeholders(), name) == placeholders().end())
            throw Error("line {} of the DMIS header has the unknown placeholder {}{}", number, quote("{" + name + "}"),
                        did_you_mean(name, placeholders()))
                .hint(fmt::format("placeholders are {{{}}}", fmt::join(placeholders(), "}, {")));
        text.append(value(name));
        line.remove_prefix(close + 1);
    }
    return text;
}

void require_printable(std::string_view line, std::size_t number) {
    const auto odd = std::ranges::find_if_not(line, is_printable);
    if (odd != line.end())
        throw Error("line {} of the DMIS header has the byte {:#04x}, which is not printable ASCII", number,
                    static_cast<unsigned char>(*odd))
            .hint("write umlauts and accents without them; DMIS programs are ASCII");
}

void require_statement(const Statement& statement, std::string_view unit) {
    for (const std::string_view own : {"DMISMN", "FILNAM", "ENDFIL"})
        if (statement.major == own)
            throw Error("line {} of the DMIS header has {}, which is added to every program", statement.line, own)
                .hint("remove the line");
    if (statement.major != "UNITS") return;
    if (!unit_named(statement.field(0)))
        throw Error("line {} of the DMIS header has the unit {}; DMIS has {}", statement.line,
                    quote(statement.field(0)), unit_names())
            .hint("UNITS/{unit},ANGDEC is right for every plan");
    if (!unit.empty() && statement.field(0) != unit)
        throw Error("line {} of the DMIS header has UNITS/{}, but the plan needs UNITS/{}", statement.line,
                    statement.field(0), unit)
            .hint("UNITS/{unit},ANGDEC is right for every plan");
}

LengthUnit written_unit(LengthUnit unit) { return unit == LengthUnit::micrometre ? LengthUnit::millimetre : unit; }

std::string default_header(const ProbePlan& plan, double approach, u32 decimals) {
    std::string text;
    const auto add = [&](std::string_view statement) { text += lines_of(statement); };
    const auto length = [&](double number) { return fixed_text(number, decimals); };
    add(fmt::format("UNITS/{},ANGDEC", unit_name(plan.frame.unit)));
    add(fmt::format("DECPL/ALL,{}", decimals));
    if (const std::string name = comment_name(plan.frame.name); !name.empty()) add("$$ frame " + name);
    // All digits, so that a reader of the program knows the plan exactly.
    add("$$ radius " + number_text(plan.radius));
    add("$$ scanner-error " + number_text(plan.scanner_error));
    add("$$ stylus-length " + number_text(plan.stylus_length));
    // The ball relative to the machine's mount, along the stylus; the stylus points down the axis. Both follow from the
    // written direction, so that the program determines them.
    std::string direction, offset;
    for (const double component : plan.machine_axis) {
        const std::string written = fixed_text(-component, std::max(decimals, u32(4)));
        double number = 0;
        parse_number(written, number);
        direction += "," + written;
        offset += "," + length(plan.stylus_length * number);
    }
    add("S(TIP1)=SNSDEF/PROBE,FIXED,CART" + offset + direction + "," + length(2 * plan.radius));
    add("SNSLCT/S(TIP1)");
    add("PRCOMP/ON");
    add("MODE/PROG,MAN");
    add("SNSET/APPRCH," + length(approach));
    add("SNSET/RETRCT," + length(approach));
    add("SNSET/SEARCH," + length(plan.radius + 2 * plan.scanner_error));
    add("SNSET/CLRSRF," + length(plan.clearance));
    return text;
}

}  // namespace

void require_header(std::string_view header, LengthUnit unit) {
    const std::string_view name = unit_name(written_unit(unit));
    const auto example = [&](std::string_view placeholder) {
        if (placeholder != "unit") return std::string("1");
        return std::string(name.empty() ? "MM" : name);
    };
    std::string text;
    for_each_line(header, [&](std::string_view line, std::size_t number) {
        require_printable(line, number);
        text += filled(line, number, example) + "\n";
    });
    Statements statements(text);
    bool has_units = false;
    while (statements.next()) {
        require_statement(statements.current(), name);
        has_units = has_units || statements.current().major == "UNITS";
    }
    if (statements.is_cut())
        throw Error("the DMIS header ends with $: its last statement is not complete").hint("remove the sign");
    if (!has_units) throw Error("the DMIS header has no UNITS statement").hint("add a line UNITS/{unit},ANGDEC");
}

std::string header_lines(const ProbePlan& plan, double approach, u32 decimals) {
    if (plan.dmis.header.empty()) return default_header(plan, approach, decimals);
    require_header(plan.dmis.header, plan.frame.unit);
    const auto value = [&](std::string_view name) {
        if (name == "unit") return std::string(unit_name(plan.frame.unit));
        const double number = name == "radius"      ? plan.radius
                              : name == "diameter"  ? 2 * plan.radius
                              : name == "search"    ? plan.radius + 2 * plan.scanner_error
                              : name == "clearance" ? plan.clearance
                                                    : approach;
        return fixed_text(number, decimals);
    };
    std::string text;
    for_each_line(plan.dmis.header, [&](std::string_view line, std::size_t number) {
        std::string complete = filled(line, number, value);
        std::ranges::replace(complete, '\t', ' ');
        if (complete.size() > longest_line && complete.find("$$") != std::string::npos)
            throw Error("line {} of the DMIS header has a comment and {} characters; DMIS has at most {}", number,
                        complete.size(), longest_line)
                .hint("shorten the comment, or write it in several lines that begin with $$");
        text += lines_of(complete);
    });
    return text;
}

std::string comment_name(std::string_view name) {
    constexpr std::size_t room = longest_line - std::string_view("$$ frame ").size();
    std::string text = one_line(name);
    for (char& c : text)
        if (!is_printable(c) || c == '$') c = '_';
    if (text.size() > room) text.resize(room);
    return one_line(text);
}

}  // namespace scanmill::dmis
