// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The parts of a PLY file: its header, the rows of an element, and the columns that they become.

#include <map>
#include <optional>
#include <span>

#include "scanmill/formats/common/text_cursor.hpp"

namespace scanmill {

/// PLY's older names of the types, indexed by ScalarType. name_of() returns the newer names: int8 … float64.
constexpr std::array<std::string_view, 10> ply_type_names{"char", "uchar", "short",  "ushort", "int",
                                                          "uint", "int64", "uint64", "float",  "double"};
constexpr std::array<std::string_view, 3> ply_axes{"x", "y", "z"};

inline bool is_floating(ScalarType type) { return type >= ScalarType::float32; }

struct PlyProperty {
    std::string name;
    ScalarType type;
    /// The type of a list's length, an integer type; nullopt if the property is not a list.
    std::optional<ScalarType> count_type;

    bool is_list() const { return count_type.has_value(); }
};

struct PlyElement {
    std::string name;
    u64 count = 0;
    std::vector<PlyProperty> properties;

    /// The property of this name; nullptr if there is none.
    const PlyProperty* find(std::string_view property) const;
    bool has_lists() const;
    /// The size of a binary row in bytes. Pre: no property is a list.
    std::size_t row_size() const;
};

enum class PlyEncoding { ascii, binary_little_endian, binary_big_endian };

struct PlyHeader {
    PlyEncoding encoding = PlyEncoding::ascii;
    std::vector<PlyElement> elements;
    /// The text of comment and obj_info lines, in order.
    std::vector<std::string> comments;
    std::size_t size = 0;   ///< bytes before the body
    std::size_t lines = 0;  ///< number of lines of the header
};

/// Parses the header. Lines may end with LF, CRLF or CR; the end of the first line decides. All names of the types are
/// accepted, also those of 64-bit integers. Declared counts are not checked: see require_room(). Throws Error with the
/// line number.
PlyHeader parse_ply_header(std::string_view file);

/// Throws Error if `left` bytes cannot hold the element's rows, even if every row is as short as possible. Call it
/// before allocating memory for the element.
void require_room(const PlyElement& element, PlyEncoding encoding, std::size_t left);

/// One list per row: row r is values[offsets[r]] … values[offsets[r + 1] - 1].
struct PlyLists {
    Array<u64> offsets;
    Array<std::byte> values;
};

/// The destination of one property's numbers. The numbers are skipped if `destination` and `lists` are nullptr.
struct PlySlot {
    const PlyProperty* property = nullptr;
    /// Scalars only: the number of row r is stored at destination + r × stride.
    std::byte* destination = nullptr;
    std::size_t stride = 0;
    /// Scalars only: whether the numbers are stored as double instead of in their own type.
    bool widened = false;
    /// Lists only: the destination of the lists.
    PlyLists* lists = nullptr;
};

/// Makes the slots of x, y and z store doubles from `positions` on.
void place_axes(std::span<PlySlot> slots, Vec3* positions);

/// Decodes `element.count` rows from the front of `body`; returns their size in bytes. Throws Error if the body is too
/// short; the message contains the row and the byte (counted from `body_offset`) at which it ends.
/// Pre: require_room() passed; `slots` are in the order of the element's properties.
std::size_t decode_ply_binary(std::string_view body, std::size_t body_offset, const PlyElement& element,
                              bool big_endian, std::span<const PlySlot> slots);

/// Rows of text that continue after their last property.
struct OverlongRows {
    u64 count = 0;
    std::size_t first_line = 0;
};

/// Decodes an element in text, one row per line, and skips the rest of overlong rows. Throws Error with the line number
/// for too few values, a value that is not a number of the property's type, and a list longer than its line.
OverlongRows decode_ply_ascii(TextCursor& text, const PlyElement& element, std::span<const PlySlot> slots);

/// Decodes the positions of the most common binary files at the speed of memory. Such a file has rows of fixed size in
/// which x, y and z are adjacent floats or doubles in the machine's byte order. Fills `positions`, one per row, from
/// the rows at the front of `body`. Returns the bounds of the finite positions and whether all are finite. Returns
/// nullopt, without changes, for other elements. Pre: `body` has positions.size() rows; the element has scalars x, y
/// and z.
std::optional<FiniteBounds> widen_packed_positions(std::string_view body, const PlyElement& vertex,
                                                   PlyEncoding encoding, Array<Vec3>& positions);

/// The property names of a column with several components: "nx ny nz", "red green blue (alpha)", "NAME_0 NAME_1 …".
std::vector<std::string> ply_component_names(const Column& column);

/// The columns of one PLY element, and their memory while its rows are decoded.
///
/// nx, ny, nz of one floating-point type become `normal` (3). red, green, blue and optionally alpha of type uchar
/// become `colour` (3 or 4). A header comment "components N NAME" unites NAME_0 … NAME_N-1 of one type. Every other
/// property becomes a column with its own name and type; lists become list columns. ply_component_names() is the
/// inverse.
class PlyTable {
public:
    /// Allocates memory for every property except those in `elsewhere`. Pre: require_room() passed; `element` outlives
    /// this object.
    PlyTable(const PlyElement& element, const std::vector<std::string>& comments,
             std::span<const std::string_view> elsewhere = {});
    PlyTable(const PlyTable&) = delete;
    PlyTable& operator=(const PlyTable&) = delete;

    /// One slot for each property, in order. The slots of the properties in `elsewhere` have no destination yet.
    std::span<PlySlot> slots() { return slots_; }
    /// Removes and returns the column of this name, if there is one. Call after decoding.
    std::optional<Column> take(std::string_view name);
    /// The columns that were not taken.
    ColumnTable columns();

private:
    struct Pending {
        std::string name;
        ScalarType type;
        u32 components;  // 0: lists
        Array<std::byte> data;
        PlyLists lists;
    };
    Column finished(Pending pending) const;

    std::vector<Pending> pending_;
    std::map<std::string, int, std::less<>> exponents_;
    std::vector<PlySlot> slots_;
};

// The members of ply_format() that are not in ply_reader.cpp.

bool may_be_ply_stream(std::string_view file);
std::unique_ptr<PointStream> open_ply_stream(std::unique_ptr<MappedFile> file, const ReadOptions& options,
                                             unsigned threads, const OnWorldPositions& on_positions);
void write_ply_points(const Value& value, OutputBuffer& out, const WriteOptions& options);
void write_ply_mesh(const Value& value, OutputBuffer& out, const WriteOptions& options);

}  // namespace scanmill
