// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/tagged_points.hpp"

#include <set>

#include "scanmill/filter/error.hpp"
#include "scanmill/formats/reading.hpp"
#include "scanmill/formats/text_layout.hpp"

namespace scanmill {

namespace {

constexpr TextRules rules{.comment = '#'};
constexpr std::string_view usual_tags = "pdsg";

bool is_tag(std::string_view word) {
    return word.size() == 1 && ((word[0] >= 'a' && word[0] <= 'z') || (word[0] >= 'A' && word[0] <= 'Z'));
}

Vec3 point_in_row(TextCursor& text) {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) {
        if (!text.more()) throw Error("line {}: a point has three numbers, here are {}", text.line(), axis);
        if (!text.number(p[axis]))
            throw Error("line {}: {} is no number for a point", text.line(), quote(text.last_token()));
    }
    if (text.more())
        throw Error("line {}: a point has three numbers, here are {}", text.line(), 3 + text.count_tokens());
    return p;
}

}  // namespace

bool are_tagged_points(std::string_view text) {
    TextCursor cursor(text, rules);
    if (!cursor.next_row()) return false;
    const std::string_view tag = cursor.token();
    return is_tag(tag) && usual_tags.find(tag) != std::string_view::npos && cursor.count_tokens() == 3 &&
           is_row_of_numbers(cursor);
}

LoadedFile read_tagged_points(std::string_view text, const ReadOptions& options) {
    TextCursor cursor(text, rules);
    Array<Vec3> positions;
    u64 others = 0;
    std::set<char> tags;
    while (cursor.next_row()) {
        const std::string_view tag = cursor.token();
        if (!is_tag(tag))
            throw Error("line {}: {} is no letter that says what the row holds, such as p for a point", cursor.line(),
                        quote(tag));
        if (tag == "p") {
            positions.push_back(point_in_row(cursor));
        } else {
            ++others;
            tags.insert(tag[0]);
        }
    }
    if (positions.empty()) throw Error("holds no points: no row begins with p");
    require_countable(positions.size(), "points");
    if (others > 0)
        warn(options.on_warning, "{} not of points ({}) and left out", counted(others, "row is", "rows are"),
             fmt::join(tags, ", "));

    LoadedFile loaded;
    loaded.format = "XYZ";
    loaded.encoding = "ascii";
    loaded.comments = cursor.comments().texts();
    PointCloud cloud;
    cloud.frame = declared_frame(loaded.comments, options);
    move_near_origin(positions, bounding_box(positions), cloud.frame);
    cloud.positions = std::move(positions);
    loaded.value = std::make_shared<const PointCloud>(std::move(cloud));
    return loaded;
}

}  // namespace scanmill
