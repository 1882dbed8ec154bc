// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Reads scans from files and writes results to files, for the engine and the command line.
///
/// The content of a file decides its format; the extension only decides for content without a signature, such as a
/// table of numbers without a header. gzip data and text in UTF-16 are unwrapped as a whole, then read like their
/// content. Every column is kept with its type; coordinates are double. Everything that is left out or changed is
/// reported through on_warning, in one sentence with numbers. NaN and infinite coordinates are read as they are.
/// Positions far from zero are stored relative to frame.origin, so that frame.origin + position is exactly the file's
/// coordinate (a point with a NaN or infinite coordinate may lose the last bit of its other two).
///
/// Every refusal is an Error that begins with the file's path. Refused are files that are missing, a folder,
/// unreadable, empty, of unknown format, truncated, contradictory or without points. Memory for a declared count is
/// allocated only if the file's size allows this count. The file must not shrink while it is read: it is mapped, not
/// copied.

#include "scanmill/formats/common/format.hpp"

namespace scanmill {

/// Reads the whole file, or one of its views: `path` may be the name of a view, as may the paths of all functions
/// below that read (see file_view()); ReadOptions::view is then that view. Throws Error for a view that the file does
/// not have. A mesh file without a single face is a point cloud.
LoadedFile read_file(const std::filesystem::path& path, const ReadOptions& options = {});

/// The number of views in the file, at least 1. It is 1 for a file that read_file() refuses. Runs no library of other
/// programs on the file's content, unless the file is compressed.
u32 count_views(const std::filesystem::path& file);

/// The same from memory. `name` replaces the path in messages, and its extension is used as the file's.
LoadedFile read_bytes(std::string_view bytes, const std::filesystem::path& name, const ReadOptions& options = {});

/// An upper estimate of the memory, in bytes, that read_file() and the computations of `info` need for this file. Uses
/// the size and the format of the file, without reading it. For gzip data it uses the compressed size, so the estimate
/// is too low. 0 for a file that read_file() refuses at once.
u64 memory_to_read(const std::filesystem::path& path);

/// Throws Error with the two numbers if memory_to_read() exceeds `available`, the available memory in bytes.
void require_memory_to_read(const std::filesystem::path& path, u64 available);

/// Points of a point file, or vertices of a mesh file, with a warning that counts the faces left out.
std::shared_ptr<const PointCloud> read_points(const std::filesystem::path& path, const ReadOptions& options = {});

/// The points of a loaded file, with only valid rows (see accepted()), as a scan enters a workflow. Warns about dropped
/// points and, like read_points(), about faces left out. Throws Error with the file's path.
Cleaned<PointCloud> accepted_points(const LoadedFile& loaded, const std::filesystem::path& path,
                                    const ReadOptions& options, InvalidRows rule);

/// The mesh of a mesh file. Throws Error if the file has no faces.
std::shared_ptr<const TriangleMesh> read_mesh(const std::filesystem::path& path, const ReadOptions& options = {});

/// Opens a scan file as a point stream (see Format::open_stream). Reads the whole file once, on up to `threads`
/// threads, to find bounds and origin. Then reads the pieces that robust_box() needs, up to twice. `on_positions`,
/// unless empty, receives every piece of the first pass, in order and on this thread, even if the result is null.
///
/// Returns null if the format cannot be streamed, if a coordinate is not finite, or if read_points() would refuse the
/// file or give warnings about the content that the stream cannot give. The caller then uses read_points(). Other
/// warnings go to options.on_warning. The file must not change while the stream exists; read() throws if it detects a
/// change. Cost: the time to read a binary file; for a text, also the time to parse its numbers. Memory: per thread,
/// the positions of four pieces (at most 1.5 MB each) and the bytes of one piece; 8 bytes per piece (24 more in texts).
/// LAZ files take a temporary file of the uncompressed size and up to 32 MB per thread while they are decompressed.
std::unique_ptr<PointStream> open_point_stream(const std::filesystem::path& path, const ReadOptions& options,
                                               unsigned threads, const OnWorldPositions& on_positions = {});

/// Whether open_point_stream() may succeed. Reads only the file's beginning and end; the content between them may still
/// prevent streaming.
bool may_be_point_stream(const std::filesystem::path& path);

/// Writes in the format of the extension. The file appears whole or not at all; an exception leaves no file. An
/// existing file is replaced. World coordinates are written (frame.origin is added back); unit and frame name are
/// written as comments.
///
/// Throws Error for an extension without a writer for this kind, a value without points, a mesh without triangles in a
/// format that has only triangles, a target that is not a regular file, and a full disk.
void write_file(const std::filesystem::path& path, const Value& value, const WriteOptions& options = {});

/// The bytes that write_file() would write. `name` replaces the path in messages, and its extension decides the format.
std::string write_bytes(const std::filesystem::path& name, const Value& value, const WriteOptions& options = {});

/// Whether files with this extension ("ply" or ".PLY") can be written from values of this kind.
bool can_write(std::string_view extension, Kind kind);

/// The reason why the module for this extension cannot be used; empty if it can be used, or if no module has this
/// extension.
std::string why_unusable(std::string_view extension);

/// Names of the kinds that a workflow's input can have: points, mesh, and the kinds with a JSON form.
std::vector<std::string> readable_kinds();
/// The extensions that can_write(), for messages: "ply, stl, off, obj". Empty for kinds that no format carries.
std::string writable_extensions(Kind kind);

}  // namespace scanmill
