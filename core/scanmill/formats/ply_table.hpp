// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The columns of one PLY element: which properties form one, and their memory while the rows are decoded.
///
/// nx, ny, nz of one floating-point type become `normal` (3), uchar red, green, blue and perhaps alpha become `colour`
/// (3 or 4); a header comment "components N NAME" gathers NAME_0 … NAME_N-1 of one type. Every other property is its
/// own column, with its own name and type; lists become list columns. See ply_component_names() for the way back.

#include "scanmill/formats/ply_body.hpp"

namespace scanmill {

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
    static Column finished(Pending pending);

    std::vector<Pending> pending_;
    std::vector<PlySlot> slots_;
};

}  // namespace scanmill
