// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// For all readers: warnings, the file's name in messages, declarations in comments, and the finished LoadedFile.

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

/// The result of the action. An Error that it throws gets the file's name before its sentence.
template <class Action>
auto with_file_name(const std::filesystem::path& path, Action&& action) {
    try {
        return action();
    } catch (const Error& error) {
        throw error.reworded(fmt::format("'{}': {}", path.string(), error.sentence()));
    }
}

/// Passes warnings on with the file's name before each. Empty when `on_warning` is, which must outlive the result.
std::function<void(std::string)> warnings_with_file_name(const std::filesystem::path& path,
                                                         const std::function<void(std::string)>& on_warning);

/// Removes the byte-order mark that text editors of Windows write.
std::string_view without_byte_order_mark(std::string_view text);

/// Removes blanks, tabs and carriage returns at both ends.
std::string_view trimmed(std::string_view text);

/// The text after `keyword` and a blank in a comment, without blanks around it; empty when the comment does not begin
/// with them. For "unit", empty also for several words: a sentence that happens to begin with "unit".
std::string_view declaration_in(std::string_view comment, std::string_view keyword);

/// The options' unit if known, else `declared`. Warns when they differ.
LengthUnit chosen_unit(LengthUnit declared, const ReadOptions& options);

/// Unit and name as declared by lines "unit mm" and "frame NAME" among the comments; the options' unit has precedence.
/// Warns of unknown units.
Frame declared_frame(const std::vector<std::string>& comments, const ReadOptions& options);

/// Length exponents of columns by name, as declared by comments "length-exponent N NAME".
std::map<std::string, int, std::less<>> declared_exponents(const std::vector<std::string>& comments);
/// The columns with their declared exponents.
ColumnTable with_exponents(const ColumnTable& columns, const std::vector<std::string>& comments);

/// Throws Error unless `count` elements can be numbered with 32 bits.
void require_countable(u64 count, std::string_view elements);

/// Chooses frame.origin for the world positions of points (see distant_origin()) and makes them relative to it. `box`
/// bounds them; it is computed when absent.
void move_near_origin(Array<Vec3>& positions, Frame& frame, std::optional<BoundingBox> box = {});

/// A reader's result with the frame that the comments declare: `mesh`, or a point cloud when it has no triangles, at
/// these world positions. `box` bounds them; it is computed when absent.
LoadedFile loaded_file(std::string format, std::string encoding, std::vector<std::string> comments,
                       Array<Vec3> positions, TriangleMesh mesh, const ReadOptions& options,
                       std::optional<BoundingBox> box = {});

}  // namespace scanmill
