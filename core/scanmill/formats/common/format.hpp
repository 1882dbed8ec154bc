// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What a file format is to us: its names, how to recognise it, how to read it, how to write each kind.
///
/// The formats are rows of one table (formats.cpp); nothing else knows them by name. A format from a loadable module is
/// one more row of the same type.

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scanmill/kinds/value.hpp"

namespace scanmill {

class OutputBuffer;

struct ReadOptions {
    /// Called with one sentence for everything that was left out, changed or looked doubtful. May be empty.
    std::function<void(std::string)> on_warning;
    /// When known, the unit of the coordinates, whatever the file says of itself.
    LengthUnit unit = LengthUnit::unknown;
};

struct LoadedFile {
    /// A PointCloud or a TriangleMesh, whichever the file holds; never null, never without points.
    Value value;
    std::string format;  ///< "PLY"
    std::string encoding;  ///< "binary little-endian", "ascii"
    /// The file's own remarks, in order: comment and obj_info lines, `#` lines, the text of an STL header.
    std::vector<std::string> comments;
};

struct WriteOptions {
    /// Called with one sentence for everything that the format cannot carry. May be empty.
    std::function<void(std::string)> on_warning;
    /// Called with all that goes into the file, piece by piece, in order. May be empty.
    std::function<void(std::string_view)> on_bytes = {};
};

/// A file's content, whole, while it is read.
struct FileBytes {
    std::filesystem::path path;
    std::string_view bytes;
};

/// How sure a format is that a file is its own. Certain beats the extension, the extension beats plausible.
enum class Recognition { no, plausible, certain };

/// The first bytes of a file that recognises() may look at.
constexpr std::size_t head_size = 4096;

struct Format {
    using Recognise = std::function<Recognition(std::string_view head, u64 file_size)>;
    using Read = std::function<LoadedFile(const FileBytes& file, const ReadOptions& options)>;
    /// Pre: the value is of the kind that the writer is listed for, and has points; features may have none.
    using Write = std::function<void(const Value& value, OutputBuffer& out, const WriteOptions& options)>;

    std::string name;
    /// Lower case, without the dot; the first is the one to propose.
    std::vector<std::string> extensions;
    Recognise recognises;
    Read read;
    std::vector<std::pair<Kind, Write>> writers;
    /// `read` always throws: the format is only written, or listed so that it can say what to do instead.
    bool is_refused = false;
    /// Why its module cannot be used, as a part of a sentence; `read` throws with it.
    std::string unusable = {};

    bool has_extension(std::string_view extension) const;
    /// Empty when the format cannot carry the kind.
    Write writer(Kind kind) const;
};

/// "PLY" → "ply", ".Stl" → "stl": the form in which Format lists extensions.
std::string plain_extension(std::string_view extension);

}  // namespace scanmill
