// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Decodes the rows of one PLY element into memory that the caller prepared: where each property's numbers go is said
/// by a PlySlot, how they are spelled is settled here.

#include <map>
#include <span>
#include <string_view>

#include "scanmill/data/points.hpp"
#include "scanmill/formats/common/text_cursor.hpp"
#include "scanmill/formats/ply/detail/ply_header.hpp"

namespace scanmill {

/// One list per row: row r is values[offsets[r]] … values[offsets[r + 1] - 1].
struct PlyLists {
    Array<u64> offsets;
    Array<std::byte> values;
};

/// Where the numbers of one property go. Without a place and without lists they are passed over.
struct PlySlot {
    const PlyProperty* property = nullptr;
    /// Of a scalar: the number of row r is stored at place + r × stride,
    std::byte* place = nullptr;
    std::size_t stride = 0;
    /// as a double instead of in its own type.
    bool widened = false;
    /// Of a list.
    PlyLists* lists = nullptr;
};

/// Decodes `element.count` rows from the front of `body`; returns the bytes taken. Throws Error, before anything is
/// stored, when the body is too short, with the row and byte (counted from `body_offset`) at which it ends.
/// Pre: require_room() passed; slots in the order of the element's properties.
std::size_t decode_ply_binary(std::string_view body, std::size_t body_offset, const PlyElement& element,
                              bool big_endian, std::span<const PlySlot> slots);

/// Rows of text that go on behind their last property; what follows there was passed over.
struct OverlongRows {
    u64 count = 0;
    std::size_t first_line = 0;
};

/// The same for text, one row per line. Throws Error with the line number: too few values, a value that is no number of
/// the property's type, a list longer than its line.
OverlongRows decode_ply_ascii(TextCursor& text, const PlyElement& element, std::span<const PlySlot> slots);

// The columns of one PLY element: which properties form one, and their memory while the rows are decoded.
//
// nx, ny, nz of one floating-point type become `normal` (3), uchar red, green, blue and perhaps alpha become `colour`
// (3 or 4); a header comment "components N NAME" gathers NAME_0 … NAME_N-1 of one type. Every other property is its
// own column, with its own name and type; lists become list columns. See ply_component_names() for the way back.

/// The property names of a column with several components: "nx ny nz", "red green blue (alpha)", "NAME_0 NAME_1 …".
std::vector<std::string> ply_component_names(const Column& column);

class PlyTable {
public:
    /// Takes memory for every property but those in `elsewhere`. Pre: require_room() passed; `element` outlives this.
    PlyTable(const PlyElement& element, const std::vector<std::string>& comments,
             std::span<const std::string_view> elsewhere = {});
    PlyTable(const PlyTable&) = delete;
    PlyTable& operator=(const PlyTable&) = delete;

    /// One for each property, in order; those of `elsewhere` have no place yet.
    std::span<PlySlot> slots() { return slots_; }
    /// Removes the column of this name, when there is one. Call after decoding.
    std::optional<Column> take(std::string_view name);
    /// What was not taken.
    ColumnTable columns();

private:
    struct Pending {
        std::string name;
        ScalarType type;
        u32 components;  // 0: lists
        Array<std::byte> data;
        PlyLists lists;
    };
    struct Group {
        std::string name;
        std::vector<std::string> properties;
    };
    static std::vector<Group> groups_in(const PlyElement& element, const std::vector<std::string>& comments);
    Column finished(Pending pending) const;

    std::vector<Pending> pending_;
    std::map<std::string, int, std::less<>> exponents_;
    std::vector<PlySlot> slots_;
};

}  // namespace scanmill
