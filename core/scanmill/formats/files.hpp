// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Reads scans from files and writes results to files, for the engine and the command line.
///
/// The content of a file decides its format; the extension only decides for content without a signature, such as a
/// table of numbers without a header. gzip data and text in UTF-16 are read like their content, whole. Every column is
/// kept with its type, coordinates are double, and everything that a format cannot carry is reported through
/// on_warning, one sentence with numbers each. NaN and infinite coordinates are read as they are. Positions far from
/// zero are stored relative to frame.origin, so that frame.origin + position is exactly the file's coordinate (a point
/// with a NaN or infinite coordinate may lose the last bit of its other two).
///
/// Every refusal is an Error that begins with the file's path: missing, a folder, unreadable, empty, of unknown format,
/// truncated, contradictory, or without a single point. No memory is taken for a declared count before the file's size
/// allows it. The file must not shrink while it is read: it is mapped, not copied.

#include "scanmill/formats/common/format.hpp"

namespace scanmill {

/// Reads the whole file. A mesh file without a single face is a point cloud.
LoadedFile read_file(const std::filesystem::path& path, const ReadOptions& options = {});

/// The same from memory; `name` replaces the path in messages, and its extension counts as the file's.
LoadedFile read_bytes(std::string_view bytes, const std::filesystem::path& name, const ReadOptions& options = {});

/// About the most memory, in bytes, that read_file() takes for this file and `info` for what it computes of it. From
/// the file's size and format, without reading it; of gzip data, from the compressed size, so the estimate is too low.
/// 0 for a file that read_file() refuses at once.
u64 memory_to_read(const std::filesystem::path& path);

/// Throws Error if memory_to_read() exceeds the memory that is available, with both numbers.
void require_memory_to_read(const std::filesystem::path& path, u64 available);

/// Points of a point file, or vertices of a mesh file, with a warning that counts the faces left out.
std::shared_ptr<const PointCloud> read_points(const std::filesystem::path& path, const ReadOptions& options = {});

/// The points of a file that was read, as a scan that enters a workflow: only valid rows (see accepted()). Warns of
/// dropped points, and as read_points(). Throws Error with the file's path.
Cleaned<PointCloud> accepted_points(const LoadedFile& loaded, const std::filesystem::path& path,
                                    const ReadOptions& options, InvalidRows rule);

/// Throws Error when the file holds points only.
std::shared_ptr<const TriangleMesh> read_mesh(const std::filesystem::path& path, const ReadOptions& options = {});

/// Opens a scan file as a point stream (see Format::open_stream), after reading the whole file once, on up to `threads`
/// threads, for bounds and origin, and the pieces that robust_box() needs, up to twice. `on_positions`, unless empty,
/// receives every piece meanwhile, in order and on this thread, even if the result is null.
///
/// Null when the format cannot be streamed, a coordinate is not finite, or read_points() would warn about the content
/// or refuse the file; the caller then uses read_points(). Warnings about units and frames go to options.on_warning.
/// The file must not change while the stream exists; read() throws when it detects a change.
/// Cost: binary, as fast as the file is read; text, its numbers are parsed. Memory: per thread, the positions of four
/// pieces (at most 1.5 MB each) and the bytes of one piece; 8 bytes per piece (24 more in texts).
std::unique_ptr<PointStream> open_point_stream(const std::filesystem::path& path, const ReadOptions& options,
                                               unsigned threads, const OnWorldPositions& on_positions = {});

/// Whether open_point_stream() may succeed. Reads only the file's beginning and end, so the content between them may
/// still prevent it.
bool may_be_point_stream(const std::filesystem::path& path);

/// Writes in the format of the extension. The file appears whole or not at all, and an exception leaves no file; an
/// existing file is replaced. World coordinates are written (frame.origin added back), unit and frame name are written
/// as comments. Throws Error: an extension without a writer for this kind, a value without points, a mesh without
/// triangles where the format has nothing but triangles, a target that is not a regular file, a full disk.
void write_file(const std::filesystem::path& path, const Value& value, const WriteOptions& options = {});

/// The bytes that write_file() would write; `name` replaces the path in messages, and its extension counts.
std::string write_bytes(const std::filesystem::path& name, const Value& value, const WriteOptions& options = {});

/// Whether files with this extension ("ply" or ".PLY") can be written from values of this kind.
bool can_write(std::string_view extension, Kind kind);

/// The reason why the module for this extension cannot be used; empty if it can, and for other extensions.
std::string why_unusable(std::string_view extension);

/// Names of the kinds that read_file() returns: points, mesh, and those with a JSON form.
std::vector<std::string> readable_kinds();
/// The extensions that can_write(), for messages: "ply, stl, off, obj". Empty for kinds that no format carries.
std::string writable_extensions(Kind kind);

}  // namespace scanmill
