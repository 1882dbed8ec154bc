// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Helpers for all readers: warnings, the file's name in messages, declarations in comments, and the finished
/// LoadedFile.

#include <fmt/core.h>

#include <map>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/formats/common/format.hpp"

namespace scanmill {

template <class... Arguments>
void warn(const std::function<void(std::string)>& on_warning, fmt::format_string<Arguments...> sentence,
          Arguments&&... arguments) {
    if (on_warning) on_warning(fmt::format(sentence, std::forward<Arguments>(arguments)...));
}

constexpr const char* truncated_hint = "the file is truncated or its header is wrong: fetch or export it again";

/// Returns the result of `action`. If `action` throws an Error, the file's name is put before its sentence.
template <class Action>
auto with_file_name(const std::filesystem::path& path, Action&& action) {
    try {
        return action();
    } catch (const Error& error) {
        throw error.reworded(fmt::format("'{}': {}", path.string(), error.sentence()));
    }
}

/// Returns a function that puts the file's name before a warning and passes it to `on_warning`. The function is empty
/// if `on_warning` is empty. Pre: `on_warning` outlives the result.
std::function<void(std::string)> warnings_with_file_name(const std::filesystem::path& path,
                                                         const std::function<void(std::string)>& on_warning);

/// Removes the byte-order mark that text editors of Windows write.
std::string_view without_byte_order_mark(std::string_view text);

/// Removes blanks, tabs and carriage returns at both ends.
std::string_view trimmed(std::string_view text);

/// The text after `keyword` and a blank in a comment, without blanks around it. Empty if the comment does not begin
/// with the keyword and a blank. Also empty for "unit" followed by several words, which is a sentence that happens to
/// begin with "unit".
std::string_view declaration_in(std::string_view comment, std::string_view keyword);

/// The unit in the options if known, else `declared`. Warns if the two are known and differ.
LengthUnit chosen_unit(LengthUnit declared, const ReadOptions& options);

/// Unit and frame name as declared by lines "unit mm" and "frame NAME" among the comments; the unit in the options has
/// precedence. Warns about unknown units.
Frame declared_frame(const std::vector<std::string>& comments, const ReadOptions& options);

/// Length exponents of columns by name, as declared by comments "length-exponent N NAME".
std::map<std::string, int, std::less<>> declared_exponents(const std::vector<std::string>& comments);
/// The columns with the length exponents that the comments declare.
ColumnTable with_exponents(const ColumnTable& columns, const std::vector<std::string>& comments);

/// Throws Error if 32 bits cannot number `count` elements.
void require_countable(u64 count, std::string_view elements);

/// Chooses frame.origin for the world positions of points (see distant_origin()) and makes the positions relative to
/// it. `box` is the bounding box of the positions; it is computed if absent.
void move_near_origin(Array<Vec3>& positions, Frame& frame, std::optional<BoundingBox> box = {});

/// The result of a reader: `mesh` with these world positions, or a point cloud if `mesh` has no triangles. The comments
/// declare the frame. `box` is the bounding box of the positions; it is computed if absent.
LoadedFile loaded_file(std::string format, std::string encoding, std::vector<std::string> comments,
                       Array<Vec3> positions, TriangleMesh mesh, const ReadOptions& options,
                       std::optional<BoundingBox> box = {});

}  // namespace scanmill
