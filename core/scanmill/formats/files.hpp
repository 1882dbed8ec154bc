// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Scans from files and results into files: what the engine and the command line call.
///
/// Which format a file has is decided by its content; its extension only settles what content cannot (a table of
/// numbers without a header). Every column is kept with its type, coordinates are double, and what a format cannot
/// carry is told through on_warning, one sentence with numbers each. NaN and infinite coordinates are read as they are.
/// Positions far from zero are stored relative to frame.origin, so that frame.origin + position is exactly the file's
/// coordinate (a point with a NaN or infinite coordinate may lose the last bit of its other two).
///
/// Every refusal is an Error that begins with the file's path: missing, a folder, unreadable, empty, of unknown format,
/// truncated, contradictory, or without a single point. No count is believed, nor memory taken for it, before the
/// file's size allows it. The file must not shrink while it is read: it is mapped, not copied.

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/formats/common/format.hpp"

namespace scanmill {

/// Reads what the file holds. A mesh file without a single face is a point cloud.
LoadedFile read_file(const std::filesystem::path& path, const ReadOptions& options = {});

/// The same from memory; `name` stands for the path in messages, and its extension counts as the file's.
LoadedFile read_bytes(std::string_view bytes, const std::filesystem::path& name, const ReadOptions& options = {});

/// Points: those of a point file, or the vertices of a mesh file; the faces left out are told with their number.
std::shared_ptr<const PointCloud> read_points(const std::filesystem::path& path, const ReadOptions& options = {});

/// Throws Error when the file holds points only.
std::shared_ptr<const TriangleMesh> read_mesh(const std::filesystem::path& path, const ReadOptions& options = {});

/// Writes in the format that the extension names. The file appears whole or not at all, and on an exception nothing is
/// left beside it; an existing file is replaced. World coordinates are written (frame.origin added back), unit and
/// frame name travel as comments. Throws Error: an extension without a writer for this kind, a value without points, a
/// mesh without triangles where the format has nothing but triangles, a target that is no regular file, a full disk.
void write_file(const std::filesystem::path& path, const Value& value, const WriteOptions& options = {});

/// The bytes that write_file() would write; `name` stands for the path in messages, and its extension counts.
std::string write_bytes(const std::filesystem::path& name, const Value& value, const WriteOptions& options = {});

/// Whether files with this extension ("ply" or ".PLY") can be written from values of this kind.
bool can_write(std::string_view extension, Kind kind);

/// Why files with this extension cannot be written although there is a format for them: its module cannot be used.
/// Empty otherwise.
std::string why_unusable(std::string_view extension);

/// The extensions that can_write(), for messages: "ply, stl, off, obj". Empty for kinds that no format carries.
std::string writable_extensions(Kind kind);

}  // namespace scanmill
