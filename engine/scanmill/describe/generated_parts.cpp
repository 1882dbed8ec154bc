// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/describe/generated_parts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/describe/filter_page.hpp"

namespace scanmill {

namespace {

constexpr std::string_view begin_mark = "<!-- generated: ", mark_end = " -->", end_mark = "<!-- end -->";

const FilterSpec& filter_named(std::string_view name, const FilterLibrary& library) {
    if (const FilterSpec* spec = library.find(name)) return *spec;
    throw Error("there is no filter '{}'{}", name, did_you_mean(name, library.names()));
}

std::string part_of(std::string_view what, const FilterLibrary& library) {
    const std::size_t blank = what.find(' ');
    const std::string_view kind = what.substr(0, blank);
    const std::string_view argument = blank == std::string_view::npos ? "" : what.substr(blank + 1);
    if (argument.empty() || (kind != "filter" && kind != "filters" && kind != "doubts"))
        throw Error("'{}' cannot be generated; expected 'filter NAME', 'filters LINK' or 'doubts LINK'", what);
    if (kind == "filter") return filter_reference(filter_named(argument, library));
    std::vector<FilterSpec> specs;
    for (const std::string& name : library.names()) specs.push_back(*library.find(name));
    return kind == "filters" ? filter_table(specs, argument) : doubt_table(specs, argument);
}

}  // namespace

std::string with_generated_parts(std::string_view page, const FilterLibrary& library) {
    std::string result;
    bool is_inside = false;
    std::size_t number = 0, begun = 0;
    for (std::size_t begin = 0; begin < page.size();) {
        const std::size_t found = page.find('\n', begin);
        const std::size_t end = found == std::string_view::npos ? page.size() : found + 1;
        std::string_view line = page.substr(begin, end - begin);
        line = line.substr(0, line.find_last_not_of("\r\n") + 1);
        ++number;
        if (line.starts_with(begin_mark) && line.ends_with(mark_end)) {
            if (is_inside) break;
            const std::string_view what =
                line.substr(begin_mark.size(), line.size() - begin_mark.size() - mark_end.size());
            try {
                result += fmt::format("{}\n{}{}\n", line, part_of(what, library), end_mark);
            } catch (const Error& error) {
                throw error.reworded(fmt::format("line {}: {}", number, error.sentence()));
            }
            is_inside = true;
            begun = number;
        } else if (is_inside && line == end_mark) {
            is_inside = false;
        } else if (!is_inside) {
            result += page.substr(begin, end - begin);
        }
        begin = end;
    }
    if (is_inside) throw Error("line {}: the generated part has no end; write '{}' after it", begun, end_mark);
    if (begun == 0) throw Error("has no line '{}WHAT{}'", begin_mark, mark_end);
    return result;
}

}  // namespace scanmill
