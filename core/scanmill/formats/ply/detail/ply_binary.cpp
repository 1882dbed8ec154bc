// SPDX-License-Identifier: GPL-3.0-or-later
#include <bit>
#include <cstring>

#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/ply/detail/ply_table.hpp"
#include "scanmill/io/output_buffer.hpp"

namespace scanmill {

namespace {

template <class T, bool swapped>
T load(const char* source) {
    T number;
    std::memcpy(&number, source, sizeof(T));
    if constexpr (swapped) number = byte_swapped(number);
    return number;
}

template <class Action>
void with_order(bool swapped, Action&& action) {
    if (swapped)
        action(std::true_type{});
    else
        action(std::false_type{});
}

/// One property over many rows of fixed size: the type is settled once, outside the loop.
void copy_scalars(const char* source, std::size_t row_size, std::size_t rows, bool swapped, const PlySlot& slot,
                  std::size_t first_row) {
    visit_scalar(slot.property->type, [&](auto zero) {
        using T = decltype(zero);
        with_order(swapped, [&](auto swap) {
            std::byte* place = slot.place + first_row * slot.stride;
            for (std::size_t row = 0; row < rows; ++row, source += row_size, place += slot.stride) {
                const T number = load<T, swap.value>(source);
                if (slot.widened) {
                    const double wide = static_cast<double>(number);
                    std::memcpy(place, &wide, sizeof wide);
                } else {
                    std::memcpy(place, &number, sizeof number);
                }
            }
        });
    });
}

std::size_t decode_fixed_rows(std::string_view body, const PlyElement& element, bool swapped,
                              std::span<const PlySlot> slots) {
    std::size_t row_size = 0;
    for (const PlySlot& slot : slots) row_size += size_of(slot.property->type);
    // Blocks that stay in the cache while property after property is picked out of them.
    constexpr std::size_t block = 2048;
    for (std::size_t first = 0; first < element.count; first += block) {
        const std::size_t rows = std::min<std::size_t>(block, element.count - first);
        std::size_t offset = 0;
        for (const PlySlot& slot : slots) {
            if (slot.place) copy_scalars(body.data() + first * row_size + offset, row_size, rows, swapped, slot, first);
            offset += size_of(slot.property->type);
        }
    }
    return element.count * row_size;
}

/// The length of a list, of any integer type. Pre: the bytes are there.
u64 list_length(const char* source, ScalarType type, bool swapped, u64 row, std::string_view name) {
    return visit_scalar(type, [&](auto zero) -> u64 {
        using T = decltype(zero);
        const T length = swapped ? load<T, true>(source) : load<T, false>(source);
        if (length < T(0))
            throw Error("the list {} of row {} has the negative length {}", quote(name), row,
                        static_cast<long long>(length));
        return static_cast<u64>(length);
    });
}

/// Walks over rows with lists, noting where each list begins; nothing is stored but the offsets. Returns the bytes of
/// all rows.
std::size_t measure_rows(std::string_view body, std::size_t body_offset, const PlyElement& element, bool swapped,
                         std::span<const PlySlot> slots) {
    for (const PlySlot& slot : slots)
        if (slot.lists) {
            slot.lists->offsets.resize(element.count + 1);
            slot.lists->offsets[0] = 0;
        }
    std::size_t at = 0;
    const auto require = [&](u64 count, std::size_t width, u64 row) {
        if (count > (body.size() - at) / width)
            throw Error("the file ends at byte {} inside row {} of {} of element {}", body_offset + body.size(), row,
                        element.count, quote(element.name))
                .hint("the file is truncated or its header is wrong: fetch or export it again");
    };
    for (u64 row = 0; row < element.count; ++row)
        for (const PlySlot& slot : slots) {
            const std::size_t width = size_of(slot.property->type);
            if (!slot.property->is_list()) {
                require(1, width, row);
                at += width;
                continue;
            }
            const ScalarType count_type = *slot.property->count_type;
            require(1, size_of(count_type), row);
            const u64 length = list_length(body.data() + at, count_type, swapped, row, slot.property->name);
            at += size_of(count_type);
            require(length, width, row);
            at += length * width;
            if (slot.lists) slot.lists->offsets[row + 1] = slot.lists->offsets[row] + length;
        }
    return at;
}

void copy_list(const char* source, u64 length, ScalarType type, bool swapped, std::byte* place) {
    const std::size_t width = size_of(type);
    if (!swapped || width == 1) {
        if (length > 0) std::memcpy(place, source, length * width);
        return;
    }
    visit_scalar(type, [&](auto zero) {
        using T = decltype(zero);
        for (u64 i = 0; i < length; ++i) {
            const T number = load<T, true>(source + i * sizeof(T));
            std::memcpy(place + i * sizeof(T), &number, sizeof(T));
        }
    });
}

std::size_t decode_rows_with_lists(std::string_view body, std::size_t body_offset, const PlyElement& element,
                                   bool swapped, std::span<const PlySlot> slots) {
    const std::size_t size = measure_rows(body, body_offset, element, swapped, slots);
    for (const PlySlot& slot : slots)
        if (slot.lists) slot.lists->values.resize(slot.lists->offsets.back() * size_of(slot.property->type));

    const char* source = body.data();
    for (u64 row = 0; row < element.count; ++row)
        for (const PlySlot& slot : slots) {
            const PlyProperty& property = *slot.property;
            const std::size_t width = size_of(property.type);
            if (!property.is_list()) {
                if (slot.place) copy_scalars(source, 0, 1, swapped, slot, row);
                source += width;
                continue;
            }
            const u64 length = list_length(source, *property.count_type, swapped, row, property.name);
            source += size_of(*property.count_type);
            if (slot.lists)
                copy_list(source, length, property.type, swapped,
                          slot.lists->values.data() + slot.lists->offsets[row] * width);
            source += length * width;
        }
    return size;
}

}  // namespace

std::size_t decode_ply_binary(std::string_view body, std::size_t body_offset, const PlyElement& element,
                              bool big_endian, std::span<const PlySlot> slots) {
    const bool swapped = big_endian != (std::endian::native == std::endian::big);
    if (slots.empty()) return 0;
    return element.has_lists() ? decode_rows_with_lists(body, body_offset, element, swapped, slots)
                               : decode_fixed_rows(body, element, swapped, slots);
}

}  // namespace scanmill
