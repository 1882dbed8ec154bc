// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The formats that the core library reads and writes without modules: what each keeps of a file, and what it writes.
///
/// Readers and writers warn about everything that they leave out or change; the warning contains the number of such
/// elements. In formats with comments, the comments "unit mm" and "frame NAME" declare the frame. Writers write these
/// comments. Faces with more than three corners are cut into fans of triangles. A mesh file without triangles is a
/// point cloud.

#include "scanmill/formats/common/format.hpp"

namespace scanmill {

/// PLY, the Stanford polygon format.
///
/// Read: ascii and both binary byte orders, with any elements and properties. These elements are kept: `vertex` with x,
/// y, z (of any type, kept as double) and columns (see ply_elements.hpp); `face` with a list vertex_indices or
/// vertex_index; `tristrips`; `edge` with vertex1, vertex2 and columns; `sharp_edge` with vertex1, vertex2, which only
/// scanmill writes. `range_grid` contains the cells of a range image, with a comment `num_cols N`. The vertices then
/// get a column `approach` (3 × float32), the direction to the scanner (see range_grid.hpp), with a warning. Other
/// elements are left out. Coordinates in text keep all their digits, regardless of the type in the header.
/// Written: binary little-endian. Coordinates are float if floats hold all of them exactly, else double. 64-bit
/// integers become double, because PLY has none. Everything else in a written file is read back unchanged.
/// Streamed: binary files whose first element is `vertex` without lists. All other elements must be empty, and only
/// line ends may follow.
/// Source: G. Turk, The PLY polygon file format, 1994.
Format ply_format();

/// STL: triangles without connectivity, in single precision.
///
/// Read: binary and ascii. If a file has several solids, a face column `solid` numbers them from 0. A file is binary if
/// its size is exactly what its triangle count requires, even if it begins with "solid". Corners with equal bits become
/// one vertex; -0 is equal to +0. Stored normals are not kept. Attribute bytes become the face column `attribute`
/// (uint16) if any is not zero. Degenerate facets are kept and counted in a warning. A file with only degenerate facets
/// is an Error.
/// Written: binary. Facet normals are unit vectors, computed in double from the positions; the normals of degenerate
/// triangles are zero. If floats cannot hold a mesh far from zero, the mesh is written relative to a shift (see
/// shift_for_floats()). The reader does not add this shift, and warns. Triangles that collapse in spite of the shift
/// are left out, with a warning. The 80 bytes of the header contain unit, shift and frame name and never begin with
/// "solid".
/// Source: StereoLithography Interface Specification, 3D Systems, 1989.
Format stl_format();

/// OFF, the object file format of Geomview, as text.
///
/// Read: the keyword OFF (optional if the extension is .off) with the prefixes ST, C and N in any combination; the
/// counts on the same line or the next; one vertex and one face per line; `#` comments; blank lines. Prefixed vertices
/// give the columns `normal` (float64), colours and `texture` (2, float64). Further numbers after the coordinates of a
/// vertex without prefix are its colour; numbers after a face's indices are the face's colour (see RowColours). The
/// number of edges is not used. 4OFF, nOFF and OFF BINARY are refused.
/// Written: double precision, with the vertices' columns `normal` (3 floats), `colour` (3 or 4 × uint8) and `texture`
/// (2 floats) under the prefixes N, C and ST, and with the faces' `colour`.
/// Source: Geomview manual, section 4.1 (OFF files).
Format off_format();

/// OBJ, the object file format of Wavefront, as text.
///
/// Read: `v` x y z, followed by a weight or by a colour of three or four numbers (see RowColours; some programs write
/// fractions of 1, others whole numbers up to 255). `f` and `fo` with v, v/vt, v//vn or v/vt/vn for each corner.
/// Numbers count from 1, negative numbers backwards from the latest. Vertices may follow the faces that refer to them;
/// a vertex that is missing or numbered 0 is an Error. `vn` becomes the vertex column `normal` (3, float64), and `vt`
/// the column `texture` (2, float64), if all corners at a vertex refer to equal values. They also become columns if no
/// face refers to them and there is one for each vertex (see CornerValues). A backslash at a line's end continues the
/// line, `#` begins a comment.
/// Left out: weights other than 1, faces of fewer than three corners, lines, points, free-form curves and surfaces,
/// material libraries and rows with an unknown keyword. Groups, objects, materials and smoothing groups are left out if
/// there is more than one.
/// Written: triangles with double precision, the columns `normal` (3 floats), `texture` (2 floats) and `colour` (3 ×
/// uint8, as fractions of 1).
/// Source: Wavefront Advanced Visualizer manual, appendix B1, object files.
Format obj_format();

/// XYZ and similar texts (.xyz, .txt; .csv, .pts, .pwn, .asc are read only): one point per line, numbers in columns.
///
/// Read: columns separated by blanks, tabs, commas, semicolons or bars, with one kind of separator in a row. `#` and
/// `//` begin comments. If a row has commas between digits beside another separator, as in "1,5;2,5;3,5", the commas of
/// the text are decimal; decimal points in the same text are then an Error. A line of names (X,Y,Z,Intensity; also in a
/// comment) names the columns, in any order. Without names, the first three columns are x, y, z. text_columns()
/// describes how the other columns are kept. Every line must have as many numbers as the first.
///
/// A first line with a single whole number is the number of points. A further such line is an Error. Rows of normals
/// after the points are an Error, too.
///
/// In Hoppe's text of points, rows begin with a letter: "p 0.1 0.2 0.3" is a point. Rows with other letters, such as d,
/// s and g for its colours, are left out.
///
/// Written: x y z, and the normals if there are any, as the shortest decimals that read back equal.
/// Streamed: three columns, in lines that end with LF.
std::vector<Format> text_formats();

/// CSV of a probe plan, one row per touch in the plan's order, for spreadsheets and other programs; not read.
///
/// Written: comments with unit and frame, a line of names that begins with touch,feature,x,y,z,i,j,k, and the rows.
/// x y z is the reference point T and i j k the approach direction u, from the part to the probe; all points are
/// world coordinates, all angles degrees. Undefined values are empty, for example the direction of a touch that is not
/// made.
Format probes_csv_format();

/// PTX: scans by Leica's programs. Each scan is a grid of cells in the scanner's coordinates, with a matrix that maps
/// them to the world.
///
/// Read: for each scan the numbers of columns and rows, the scanner's position and axes, four rows of four numbers that
/// map a row vector (x y z 1) to the world, and one line per cell: x y z intensity, optionally red green blue. The
/// result is one cloud of the mapped points with these columns. `intensity` is float64. `colour` is present if every
/// scan has colours (see text_columns()). `approach` (3 × float32) is the unit vector from a point to its scanner, or
/// (0, 0, 0) for a point without a finite position. With several scans, `scan` (uint32) is the scan of a point, from 0.
/// Each scan is a view (see Format::count_views).
/// Cells at 0 0 0 are not points: they are left out and counted. The grid itself is not kept. A matrix that scales,
/// shears or mirrors is applied with a warning. A matrix that is singular, not finite or not affine is an Error.
Format ptx_format();

/// LAS, the exchange format of airborne and terrestrial lidar: versions 1.0 to 1.4, point formats 0 to 10.
///
/// Positions are the stored integers times the file's scale plus its offset. The sum is computed near frame.origin,
/// which keeps steps that are too small for a double of the full coordinate. Columns: `intensity` (uint16),
/// `return_number`, `number_of_returns`, `classification`, `user_data` (uint8), `scan_angle` (float32, degrees),
/// `point_source_id` (uint16). Some point formats also have `gps_time` (float64), `nir` (uint16) and colours. Colours
/// become `colour` (3, uint8) if all are bytes, stored as they are or times 256 or 257, else `colour16` (3, uint16).
/// Flags (`synthetic`, `key_point`, `withheld`, `overlap`, `scan_direction`, `edge_of_flight_line`) and
/// `scanner_channel` are columns (uint8) if they are set in any point. Described extra bytes become columns with the
/// described names and types, or float64 if they have a scale or an offset. The unit is metre or foot if the GeoTIFF
/// keys declare it.
///
/// Left out: variable length records, wave packets, undescribed extra bytes, bytes after the last point.
/// Streamed: every file whose coordinates are finite. The module LAZ reads the compressed forms, LAZ and COPC, to the
/// same columns.
/// Source: ASPRS, LAS specification 1.4 revision 15; its earlier versions 1.0 to 1.3.
Format las_format();
/// LAZ and COPC where the module LAZ is not built: recognised and refused, with a hint how to convert them.
Format refused_laz_format();

/// DMIS, the language of coordinate measuring machines (ISO 22093), the part of version 5.2 that touches need. A plan
/// is written as a program; the results of a machine are read as points. The syntax is known from public programs, not
/// from the standard's text.
///
/// Written (probes): DMISMN, FILNAM, the header (see dmis/header.hpp), and for each touch that is made, in their order:
/// GOTO for the points of its clearance move, F(label)=FEAT/POINT,CART with the reference point T and the approach u,
/// MEAS, PTMEAS, ENDMES, OUTPUT/FA(label) and GOTO back to the start. Then ENDFIL. GOTO has positions of the ball's
/// centre. A label is P and the number of the touch, with six digits at least; two directions of one reference point
/// end with A and B. Coordinates have the plan's number of decimals, or as many as keep 1e-4 of the ball's radius, four
/// at least; directions have four at least. Lines have at most 80 ASCII characters. A comment counts the touches that
/// are not made; they are left out with a warning. A plan in micrometres is written in millimetres, with a warning. A
/// plan without a unit, without touches that are made, or without a clearance move to each of them is an Error.
///
/// Read (points): FA(label)=FEAT/POINT,CART,x,y,z,i,j,k, in any case, with the unit of UNITS, which must come first.
/// Columns: `touch` (uint32), the number that the label's last digits spell, and `approach` (3 × float64), (i, j, k)
/// scaled to length 1. Other statements and bytes that are not ASCII are passed over; one warning counts and names
/// them. Statements of programs are passed over silently. A file that does not end with ENDFIL gives a warning. An
/// Error: no such point; no UNITS, or two that differ; a measurement or a result without its feature in a file with
/// features; a sensor other than PROBE; numbers that are missing or not finite; a direction whose length is not 1
/// within 1 %; a file that ends within a statement.
Format dmis_format();

/// JSON: values of every kind that has a JSON form (see kinds/kind.hpp). A file is recognised by the JSON member of its
/// kind.
Format json_format();

}  // namespace scanmill
