// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Helpers for all writers: world coordinates and their precision, warnings about data that a format cannot carry,
/// names of columns, and numbers as text.

#include <set>
#include <span>
#include <string_view>

#include "scanmill/formats/common/reading.hpp"
#include "scanmill/io/output_buffer.hpp"

namespace scanmill {

/// frame.origin + position, rounded once to double.
inline Vec3 world(const Frame& frame, const Vec3& position) { return frame.origin + position; }

/// Whether floats hold every world coordinate exactly. NaN and infinities count as exact.
bool all_floats(const Frame& frame, std::span<const Vec3> positions);

/// Warns if writing world coordinates as float or double moves a coordinate by more than a millionth of the diagonal.
/// Throws Error if a finite coordinate would become infinite.
void warn_lost_precision(const Frame& frame, std::span<const Vec3> positions, bool as_float, std::string_view format,
                         const WriteOptions& options);

/// Warns that the columns of `element` ("vertices") are left out, with their names, except those in `kept` and
/// WriteOptions::added_columns.
void warn_left_out(const ColumnTable& columns, std::string_view element, std::string_view format,
                   const WriteOptions& options, std::span<const std::string_view> kept = {});

/// Warns about everything in a mesh that a format for plain triangles leaves out: the columns except those kept, edges
/// with columns, and sharp edges.
void warn_bare_triangles(const TriangleMesh& mesh, std::string_view format, const WriteOptions& options,
                         std::span<const std::string_view> kept_of_vertices = {},
                         std::span<const std::string_view> kept_of_faces = {});

/// The mesh without vertices that no triangle uses, with a warning that counts them.
TriangleMesh with_used_vertices(const TriangleMesh& mesh, std::string_view format, const WriteOptions& options);

/// A frame's name as one line of a comment, in the form that a reader returns. Control characters become blanks; blanks
/// around the name are removed.
std::string one_line(std::string_view name);

/// "length-exponent 1 bin-size", which declared_exponents() reads; empty for a column whose exponent is 0.
std::string exponent_comment(const Column& column);

/// The lines "# unit mm" and "# frame NAME", without a line for an unknown unit or an empty name. `prefix` begins each
/// line.
std::string comment_lines(const Frame& frame, std::string_view prefix = "# ");

/// The text as valid UTF-8 without control characters, as JSON and XML need it. Every other byte becomes '_'.
std::string valid_text(std::string_view text);
/// The text with XML's entities for &, <, > and ".
std::string xml_escaped(std::string_view text);

/// Chooses distinct names of columns for a format that does not allow every name. Warns about changed names.
class WrittenNames {
public:
    /// `taken` are names that mean something else in the format. The options must outlive this object.
    WrittenNames(std::string_view format, const WriteOptions& options, std::set<std::string> taken = {});

    /// Returns `wanted`, with "_2" appended until the name is new. Warns if the result differs from `expected`, the
    /// name that the format's page documents.
    std::string add(std::string_view column, std::string wanted, std::string_view expected);
    std::string add(std::string_view column, std::string wanted) { return add(column, std::move(wanted), column); }

private:
    std::string format_;
    const WriteOptions* options_;
    std::set<std::string> taken_;
};

/// The columns that text formats write after the coordinates; nullptr for a column that is absent or has another form.
struct TextColumns {
    explicit TextColumns(const ColumnTable& columns);

    const Column* normal;  ///< 3 × float32 or float64
    const Column* colour;  ///< 3 or 4 × uint8
    const Column* texture;  ///< 2 × float32 or float64

    /// The names of the columns that are present, for warn_left_out().
    std::vector<std::string_view> names() const;
};

/// Whether the column has `components` × float32 or float64.
bool has_floats(const Column& column, u32 components);

/// "x y z" in world coordinates.
void put_position(const Frame& frame, const Vec3& position, OutputBuffer& out);

/// A blank and a number for each component of a row, as the shortest decimals that read back equal in the column's
/// type. Pre: the column has uint8, float32 or float64.
void put_row_text(const Column& column, std::size_t row, OutputBuffer& out);

}  // namespace scanmill
