// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What a file format is to us: its names, how to recognise it, how to read it, how to write each kind.
///
/// The formats are rows of one table (formats.cpp); nothing else knows them by name. A format from a loadable module is
/// one more row of the same type.

#include <span>
#include <utility>
#include <vector>

#include "scanmill/formats/files.hpp"

namespace scanmill {

class OutputBuffer;

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

/// Every format, in the order in which they are asked and listed: the built-in ones, then those of modules.
std::span<const Format> formats();

/// "PLY" → "ply", ".Stl" → "stl": the form in which Format lists extensions.
std::string plain_extension(std::string_view extension);

/// The format of a file: the first that is certain of its content, else that of its extension, else the first that
/// finds the content plausible. Throws Error with what the file begins with.
const Format& format_of(const FileBytes& file);

}  // namespace scanmill
