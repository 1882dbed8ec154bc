// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The rows of an OBJ file that give neither a vertex nor a face: which they are, how many, and the sentences for them.

#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "scanmill/formats/common/text_cursor.hpp"

namespace scanmill {

/// What a row of OBJ is about, by the keyword that it begins with.
enum class ObjSubject { shape, object, group, material, smoothing, library, line, point, free_form, display, unknown };

/// `shape` is what is read: v, vn, vt, f, fo.
ObjSubject obj_subject(std::string_view keyword);

class ObjLeftOut {
public:
    /// Counts the row whose keyword was just read, and reads its names. The text must outlive this.
    void add_row(std::string_view keyword, TextCursor& text);

    /// One sentence for each subject of which something is lost. Objects, groups, materials and smoothing groups only
    /// divide the mesh: nothing is lost while there is one of a sort.
    void tell(const std::function<void(std::string)>& on_warning) const;

    /// "; line 1 begins with 'solid', which OBJ does not know" when there was such a row, for a file without vertices.
    std::string first_unknown() const;

private:
    struct Rows {
        std::size_t count = 0;
        std::size_t first_line = 0;
        std::vector<std::string_view> keywords;  // different ones, the first few
        std::unordered_set<std::string_view> names;  // different ones, of what has names
        std::string_view first_name;
    };
    const Rows& of(ObjSubject subject) const { return rows_[static_cast<std::size_t>(subject)]; }

    std::array<Rows, static_cast<std::size_t>(ObjSubject::unknown) + 1> rows_;
};

}  // namespace scanmill
