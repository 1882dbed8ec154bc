// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What every writer needs: world coordinates, what they lose, and the sentences for what a format cannot carry.

#include <span>
#include <string_view>

#include "scanmill/data/mesh.hpp"
#include "scanmill/formats/common/format.hpp"

namespace scanmill {

/// frame.origin + position, rounded once to double.
inline Vec3 world(const Frame& frame, const Vec3& position) { return frame.origin + position; }

/// Whether every world coordinate is exactly a float. NaN and infinities are.
bool all_floats(const Frame& frame, std::span<const Vec3> positions);

/// Tells when writing world coordinates, as float or as double, moves some by more than a millionth of the diagonal.
/// Throws Error when a finite coordinate would become infinite.
void warn_lost_precision(const Frame& frame, std::span<const Vec3> positions, bool as_float, std::string_view format,
                         const WriteOptions& options);

/// Tells that the columns of `element` ("vertices") are left out, by name, but those in `kept`.
void warn_left_out(const ColumnTable& columns, std::string_view element, std::string_view format,
                   const WriteOptions& options, std::span<const std::string_view> kept = {});

/// Tells all of a mesh that a format of little more than triangles leaves out: the columns but those kept, described
/// and sharp edges.
void warn_bare_triangles(const TriangleMesh& mesh, std::string_view format, const WriteOptions& options,
                         std::span<const std::string_view> kept_of_vertices = {},
                         std::span<const std::string_view> kept_of_faces = {});

/// The mesh over the vertices that triangles use, after telling how many the format leaves out: where they lie is
/// nothing to a surface.
TriangleMesh with_used_vertices(const TriangleMesh& mesh, std::string_view format, const WriteOptions& options);

/// A frame's name fit for a comment, and as a reader finds it there: control characters, line ends above all, become
/// blanks, and those around it go.
std::string one_line(std::string_view name);

/// "length-exponent 1 bin-size", which declared_exponents() reads; empty for a column whose exponent is 0.
std::string exponent_comment(const Column& column);

/// "# unit mm" and "# frame NAME", each on its line, as far as known.
std::string comment_lines(const Frame& frame);

}  // namespace scanmill
