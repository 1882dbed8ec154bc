// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/obj/detail/obj_left_out.hpp"

#include <algorithm>

#include "scanmill/formats/common/reading.hpp"

namespace scanmill {

namespace {

struct Keyword {
    std::string_view word;
    ObjSubject subject;
};

/// The manual's, and those that it says older versions wrote.
constexpr auto keywords = std::to_array<Keyword>({
    {"v", ObjSubject::shape},           {"vn", ObjSubject::shape},         {"vt", ObjSubject::shape},
    {"f", ObjSubject::shape},           {"fo", ObjSubject::shape},         {"o", ObjSubject::object},
    {"g", ObjSubject::group},           {"usemtl", ObjSubject::material},  {"s", ObjSubject::smoothing},
    {"mtllib", ObjSubject::library},    {"l", ObjSubject::line},           {"p", ObjSubject::point},
    {"vp", ObjSubject::free_form},      {"cstype", ObjSubject::free_form}, {"deg", ObjSubject::free_form},
    {"bmat", ObjSubject::free_form},    {"step", ObjSubject::free_form},   {"curv", ObjSubject::free_form},
    {"curv2", ObjSubject::free_form},   {"surf", ObjSubject::free_form},   {"parm", ObjSubject::free_form},
    {"trim", ObjSubject::free_form},    {"hole", ObjSubject::free_form},   {"scrv", ObjSubject::free_form},
    {"sp", ObjSubject::free_form},      {"end", ObjSubject::free_form},    {"con", ObjSubject::free_form},
    {"mg", ObjSubject::free_form},      {"bsp", ObjSubject::free_form},    {"bzp", ObjSubject::free_form},
    {"cdc", ObjSubject::free_form},     {"cdp", ObjSubject::free_form},    {"res", ObjSubject::free_form},
    {"ctech", ObjSubject::free_form},   {"stech", ObjSubject::free_form},  {"bevel", ObjSubject::display},
    {"c_interp", ObjSubject::display},  {"d_interp", ObjSubject::display}, {"lod", ObjSubject::display},
    {"maplib", ObjSubject::display},    {"usemap", ObjSubject::display},   {"shadow_obj", ObjSubject::display},
    {"trace_obj", ObjSubject::display}, {"call", ObjSubject::display},     {"csh", ObjSubject::display},
});

bool has_name(ObjSubject subject) { return subject >= ObjSubject::object && subject <= ObjSubject::library; }

/// What is left of the row; also a name of several words, or none.
std::string_view rest_of_row(TextCursor& text) {
    if (!text.more()) return {};
    const std::string_view first = text.token();
    std::string_view last = first;
    while (text.more()) last = text.token();
    return {first.data(), last.data() + last.size()};
}

}  // namespace

ObjSubject obj_subject(std::string_view keyword) {
    const auto* found = std::ranges::find(keywords, keyword, &Keyword::word);
    return found == keywords.end() ? ObjSubject::unknown : found->subject;
}

void ObjLeftOut::add_row(std::string_view keyword, TextCursor& text) {
    constexpr std::size_t most_keywords = 4;
    const ObjSubject subject = obj_subject(keyword);
    Rows& rows = rows_[static_cast<std::size_t>(subject)];
    if (rows.count++ == 0) rows.first_line = text.line();
    if (has_name(subject)) {
        const std::string_view name = rest_of_row(text);
        if (rows.names.insert(name).second && rows.names.size() == 1) rows.first_name = name;
    } else if (rows.keywords.size() < most_keywords &&
               std::ranges::find(rows.keywords, keyword) == rows.keywords.end()) {
        rows.keywords.push_back(keyword);
    }
}

void ObjLeftOut::tell(const std::function<void(std::string)>& on_warning) const {
    std::string divisions;
    const auto divide = [&](ObjSubject subject, std::string_view what) {
        if (const std::size_t count = of(subject).names.size(); count > 1)
            divisions.append(divisions.empty() ? "" : ", ").append(fmt::format("{} {}", count, what));
    };
    divide(ObjSubject::object, "objects (o)");
    divide(ObjSubject::group, "groups (g)");
    divide(ObjSubject::material, "materials (usemtl)");
    divide(ObjSubject::smoothing, "smoothing groups (s)");
    if (!divisions.empty()) warn(on_warning, "{} were made one; which faces belong to which was left out", divisions);
    if (const Rows& rows = of(ObjSubject::library); rows.count > 0)
        warn(on_warning, "{} not read: materials and their images were left out, the first of {}",
             count_text(rows.names.size(), "material library (mtllib) was", "material libraries (mtllib) were"),
             quote(rows.first_name));
    if (const Rows& rows = of(ObjSubject::line); rows.count > 0)
        warn(on_warning, "{} left out, first in line {}", count_text(rows.count, "line (l) was", "lines (l) were"),
             rows.first_line);
    if (const Rows& rows = of(ObjSubject::point); rows.count > 0)
        warn(on_warning, "{} left out, first in line {}; their vertices are kept as all are",
             count_text(rows.count, "row of points (p) was", "rows of points (p) were"), rows.first_line);

    const auto warn_rows = [&](ObjSubject subject, std::string_view meaning) {
        const Rows& rows = of(subject);
        if (rows.count == 0) return;
        std::string words;
        for (std::string_view keyword : rows.keywords) words.append(words.empty() ? "" : ", ").append(quote(keyword));
        warn(on_warning, "{} left out, first in line {}: {} ({})", count_text(rows.count, "row was", "rows were"),
             rows.first_line, meaning, words);
    };
    warn_rows(ObjSubject::free_form, "free-form curves and surfaces are not read");
    warn_rows(ObjSubject::display, "they concern the display only");
    warn_rows(ObjSubject::unknown, "OBJ does not know what they begin with");
}

std::string ObjLeftOut::first_unknown() const {
    const Rows& rows = of(ObjSubject::unknown);
    if (rows.count == 0) return {};
    return fmt::format("; line {} begins with {}, which OBJ does not know", rows.first_line,
                       quote(rows.keywords.front()));
}

}  // namespace scanmill
