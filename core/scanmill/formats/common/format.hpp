// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A file format: names, recognition, reader, writers. All formats are rows of one table, formats(); no other code
/// refers to a format by name. A loadable module adds a row of the same type.

#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scanmill/data/point_stream.hpp"
#include "scanmill/io/mapped_file.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill {

class OutputBuffer;

struct ReadOptions {
    /// Called with one sentence for everything that is left out, changed or doubtful. May be empty.
    std::function<void(std::string)> on_warning;
    /// The unit of the coordinates. Unless unknown, it overrides the unit that the file declares.
    LengthUnit unit = LengthUnit::unknown;
    bool names_file = true;  ///< whether warnings begin with the file's name
    /// The view to read from a file that holds several (see Format::count_views), from 1. 0: all views, as one value.
    u32 view = 0;
};

struct LoadedFile {
    /// The value that the file holds; never null. A PointCloud or a TriangleMesh has points.
    Value value;
    std::string format;  ///< "PLY"
    std::string encoding;  ///< "binary little-endian", "ascii"
    /// The file's comments, in order: comment and obj_info lines, `#` lines, the text of an STL header.
    std::vector<std::string> comments;
    /// Whether a row with NaN means a ray without a return, as in formats of organised scans.
    bool nan_is_no_return = false;
};

struct WriteOptions {
    /// Called with one sentence for everything that the format cannot carry. May be empty.
    std::function<void(std::string)> on_warning;
    /// Called with all bytes of the file, piece by piece, in order. May be empty.
    std::function<void(std::string_view)> on_bytes = {};
    /// Called if the coordinates in the file need `shift` added to become world coordinates. May be empty.
    std::function<void(const Vec3& shift)> on_shift = {};
    /// Called with one sentence if the mesh is closed and the written mesh is not. If this function is empty, the
    /// sentence becomes a warning.
    std::function<void(std::string sentence)> on_opened = {};
    /// Names of columns that filters added. Such columns are left out without a warning.
    std::set<std::string, std::less<>> added_columns = {};
};

/// The whole content of a file.
struct FileBytes {
    std::filesystem::path path;
    std::string_view bytes;
};

/// How certain a format is that a file has this format. `certain` has precedence over the file's extension; the
/// extension has precedence over `plausible`.
enum class Recognition { no, plausible, certain };

/// The number of first bytes of a file that recognises() may read.
constexpr std::size_t head_size = 4096;

struct Format {
    using Recognise = std::function<Recognition(std::string_view head, u64 file_size)>;
    using Read = std::function<LoadedFile(const FileBytes& file, const ReadOptions& options)>;
    /// Pre: the value is of the kind that the writer is listed for, and has points; features may have none.
    using Write = std::function<void(const Value& value, OutputBuffer& out, const WriteOptions& options)>;
    using MayStream = std::function<bool(std::string_view file)>;
    using OpenStream =
        std::function<std::unique_ptr<PointStream>(std::unique_ptr<MappedFile> file, const ReadOptions& options,
                                                   unsigned threads, const OnWorldPositions& on_positions)>;

    std::string name;
    /// Lower case, without the dot. The first extension is proposed to users.
    std::vector<std::string> extensions;
    Recognise recognises;
    Read read;
    std::vector<std::pair<Kind, Write>> writers;
    /// Whether `read` always throws. Such a format is only written, or it is listed so that its refusal names an
    /// alternative.
    bool is_refused = false;
    /// The reason why its module cannot be used, as a part of a sentence; `read` throws it.
    std::string unusable = {};
    /// Whether open_stream() may succeed; reads only the beginning and the end of the file. Both functions are empty
    /// for formats that cannot be streamed. They may throw Error for a file that `read` refuses as well.
    MayStream may_stream = {};
    /// Returns null for a file that cannot be streamed.
    OpenStream open_stream = {};
    /// The number of views in a file: scans that were measured from different stations. Runs in the planning process,
    /// so it must not call libraries that `read` isolates in workers. Empty for formats with one view per file. May
    /// throw Error for a file that `read` refuses.
    std::function<u32(std::string_view file)> count_views = {};
    /// The approximate memory, in bytes per byte of the file, for reading and for a tree over the points or the
    /// topology of the triangles. Measured with `info`: a point takes 120 bytes and its columns, a triangle of a closed
    /// mesh 90.
    double memory_per_byte = 4;

    bool has_extension(std::string_view extension) const;
    /// Empty when the format cannot carry the kind.
    Write writer(Kind kind) const;
};

/// "PLY" → "ply", ".Stl" → "stl": the form in which Format lists extensions.
std::string plain_extension(std::string_view extension);

/// A file, or one view of a file that holds several.
struct FileView {
    std::filesystem::path file;
    u32 view = 0;  ///< from 1; 0: the whole file
};
/// Splits the name of a view: "a.e57#2" is view 2 of a.e57, if there is no file of that name and a.e57 is a file. Any
/// other name is that of a file.
FileView file_view(const std::filesystem::path& name);
/// The name that file_view() splits: "a.e57#2". The file itself for view 0.
std::filesystem::path view_name(const std::filesystem::path& file, u32 view);

/// The extension that readers see, in the form of plain_extension(): "xyz" for scan.xyz, for scan.xyz.gz and for
/// scan.xyz#2.
std::string extension_of(const std::filesystem::path& path);
/// The file's name without the extension and without a `.gz` after it: "scan". "scan-2" for a view, scan.e57#2.
std::string stem_of(const std::filesystem::path& path);

/// Every format, in the order of trials and lists: built-in formats, then the formats of modules.
std::span<const Format> formats();

/// The formats of loadable modules. Defined in plugin/format_modules.cpp, which loads them.
std::vector<Format> module_formats();

/// The format of a file: the first format that is certain of the content, else the format of the extension, else the
/// first format that finds the content plausible. Throws Error with the file's first bytes if no format matches.
const Format& format_of(const FileBytes& file);

}  // namespace scanmill
