// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>
#include <cstring>

#include "scanmill/formats/ply/detail/ply_elements.hpp"
#include "scanmill/io/output_buffer.hpp"

namespace scanmill {

namespace {

template <class T>
T load(const char* source, bool swapped) {
    T number;
    std::memcpy(&number, source, sizeof(T));
    return swapped ? byte_swapped(number) : number;
}

/// Copies one property of many rows of fixed size. Type and byte order are decided once, outside the loop.
void copy_scalars(const char* source, std::size_t row_size, std::size_t rows, bool swapped, const PlySlot& slot,
                  std::size_t first_row) {
    visit_scalar(slot.property->type, [&](auto zero) {
        const auto copy = [&](auto swap) {
            std::byte* destination = slot.destination + first_row * slot.stride;
            for (std::size_t row = 0; row < rows; ++row, source += row_size, destination += slot.stride) {
                const auto number = load<decltype(zero)>(source, swap());
                if (slot.widened) {
                    const double wide = static_cast<double>(number);
                    std::memcpy(destination, &wide, sizeof wide);
                } else {
                    std::memcpy(destination, &number, sizeof number);
                }
            }
        };
        if (swapped)
            copy(std::true_type());
        else
            copy(std::false_type());
    });
}

std::size_t decode_fixed_rows(std::string_view body, const PlyElement& element, bool swapped,
                              std::span<const PlySlot> slots) {
    const std::size_t row_size = element.row_size();
    // Blocks stay in the cache while one property after the other is read from them.
    constexpr std::size_t block = 2048;
    for (std::size_t first = 0; first < element.count; first += block) {
        const std::size_t rows = std::min<std::size_t>(block, element.count - first);
        const char* source = body.data() + first * row_size;
        for (const PlySlot& slot : slots) {
            if (slot.destination) copy_scalars(source, row_size, rows, swapped, slot, first);
            source += size_of(slot.property->type);
        }
    }
    return element.count * row_size;
}

/// The length of a list. The length may have any integer type.
u64 list_length(const char* source, const PlyProperty& list, bool swapped, u64 row) {
    return visit_scalar(*list.count_type, [&](auto zero) -> u64 {
        const auto length = load<decltype(zero)>(source, swapped);
        if (length < decltype(zero)(0))
            throw Error("the list {} of row {} has the negative length {}", quote(list.name), row,
                        static_cast<long long>(length));
        return static_cast<u64>(length);
    });
}

void begin_lists(std::span<const PlySlot> slots, u64 rows, std::size_t most_bytes) {
    constexpr std::size_t usual_length = 3;
    for (const PlySlot& slot : slots) {
        if (!slot.lists) continue;
        slot.lists->offsets.reserve(rows + 1);
        slot.lists->offsets.assign(1, 0);
        slot.lists->values.reserve(std::min(rows * usual_length * size_of(slot.property->type), most_bytes));
    }
}

/// Appends the next row's list; returns the memory for its values, `bytes` in all.
std::byte* append_list(PlyLists& lists, u64 length, std::size_t bytes) {
    lists.offsets.push_back(lists.offsets.back() + length);
    lists.values.resize(lists.values.size() + bytes);
    return lists.values.data() + lists.values.size() - bytes;
}

std::size_t decode_rows_with_lists(std::string_view body, std::size_t body_offset, const PlyElement& element,
                                   bool swapped, std::span<const PlySlot> slots) {
    begin_lists(slots, element.count, body.size());
    std::size_t at = 0;
    u64 row = 0;
    const auto next = [&](u64 count, std::size_t width) {
        if (count > (body.size() - at) / width)
            throw Error("the file ends at byte {} inside row {} of {} of element {}", body_offset + body.size(), row,
                        element.count, quote(element.name))
                .hint(truncated_hint);
        return body.data() + std::exchange(at, at + count * width);
    };
    for (; row < element.count; ++row)
        for (const PlySlot& slot : slots) {
            const PlyProperty& property = *slot.property;
            const std::size_t width = size_of(property.type);
            if (!property.is_list()) {
                const char* const source = next(1, width);
                if (slot.destination) copy_scalars(source, 0, 1, swapped, slot, row);
                continue;
            }
            const u64 length = list_length(next(1, size_of(*property.count_type)), property, swapped, row);
            const char* const source = next(length, width);
            if (!slot.lists) continue;
            std::byte* const destination = append_list(*slot.lists, length, length * width);
            if (!swapped && length > 0)
                std::memcpy(destination, source, length * width);
            else if (length > 0)
                copy_scalars(source, width, length, true,
                             {.property = &property, .destination = destination, .stride = width}, 0);
        }
    return at;
}

/// The offset of x in a row, if x, y and z are adjacent and of one floating-point type in the machine's byte order.
std::optional<std::size_t> packed_offset(const PlyElement& vertex, PlyEncoding encoding) {
    const bool native = encoding == (std::endian::native == std::endian::little ? PlyEncoding::binary_little_endian
                                                                                : PlyEncoding::binary_big_endian);
    const auto x = std::ranges::find(vertex.properties, "x", &PlyProperty::name);
    if (!native || vertex.has_lists() || vertex.properties.end() - x < 3 || !is_floating(x->type)) return {};
    for (std::ptrdiff_t axis = 0; axis < 3; ++axis)
        if (x[axis].name != ply_axes[static_cast<std::size_t>(axis)] || x[axis].type != x->type) return {};
    std::size_t offset = 0;
    for (auto property = vertex.properties.begin(); property != x; ++property) offset += size_of(property->type);
    return offset;
}

/// Stores positions as doubles and computes their bounds, in one pass. `source` points to x of the first row; rows are
/// `stride` bytes apart.
template <class Scalar>
FiniteBounds widen_positions(const char* source, std::size_t stride, Array<Vec3>& positions) {
    FiniteBounds all;
    constexpr std::size_t block = 1024;
    for (std::size_t first = 0; first < positions.size(); first += block) {
        const std::size_t rows = std::min(block, positions.size() - first);
        Scalar low[3], high[3], poison[3] = {0, 0, 0};
        std::memcpy(low, source, sizeof low);
        std::memcpy(high, source, sizeof high);
        for (std::size_t row = 0; row < rows; ++row, source += stride) {
            Scalar p[3];
            std::memcpy(p, source, sizeof p);
            for (int axis = 0; axis < 3; ++axis) {
                low[axis] = p[axis] < low[axis] ? p[axis] : low[axis];
                high[axis] = p[axis] > high[axis] ? p[axis] : high[axis];
                poison[axis] += p[axis] * 0;  // stays 0 for finite coordinates, else becomes NaN
                positions[first + row][axis] = static_cast<double>(p[axis]);
            }
        }
        FiniteBounds bounds{{Vec3(low[0], low[1], low[2]), Vec3(high[0], high[1], high[2])},
                            poison[0] + poison[1] + poison[2] == 0};
        if (!bounds.finite) bounds.box = bounding_box({positions.data() + first, rows});
        all.add(bounds);
    }
    return all;
}

}  // namespace

void place_axes(std::span<PlySlot> slots, Vec3* positions) {
    for (PlySlot& slot : slots) {
        const auto axis = std::ranges::find(ply_axes, slot.property->name);
        if (axis == ply_axes.end()) continue;
        slot.widened = true;
        slot.stride = sizeof(Vec3);
        slot.destination = reinterpret_cast<std::byte*>(positions) + (axis - ply_axes.begin()) * sizeof(double);
    }
}

std::size_t decode_ply_binary(std::string_view body, std::size_t body_offset, const PlyElement& element,
                              bool big_endian, std::span<const PlySlot> slots) {
    const bool swapped = big_endian != (std::endian::native == std::endian::big);
    if (slots.empty()) return 0;
    return element.has_lists() ? decode_rows_with_lists(body, body_offset, element, swapped, slots)
                               : decode_fixed_rows(body, element, swapped, slots);
}

OverlongRows decode_ply_ascii(TextCursor& text, const PlyElement& element, std::span<const PlySlot> slots) {
    OverlongRows overlong;
    if (slots.empty()) return overlong;
    begin_lists(slots, element.count, ~std::size_t(0));
    const std::string element_name = quote(element.name), rows = "rows of element " + element_name;
    std::vector<std::string> names;
    for (const PlySlot& slot : slots) names.push_back(quote(slot.property->name));
    for (u64 row = 0; row < element.count; ++row) {
        require_row(text, row, element.count, rows);
        for (std::size_t i = 0; i < slots.size(); ++i) {
            const PlySlot& slot = slots[i];
            const auto read = [&]<class Number>(Number) {
                return next_number<Number>(text, "the property {} in row {} of element {}", names[i], row,
                                           element_name);
            };
            const auto read_and_store = [&](auto zero) {
                const auto number = read(zero);
                if (slot.destination) std::memcpy(slot.destination + row * slot.stride, &number, sizeof number);
            };
            if (slot.property->is_list()) {
                const u64 length = read(u64());
                visit_scalar(slot.property->type, [&](auto zero) {
                    if (slot.lists) append_list(*slot.lists, length, 0);
                    for (u64 j = 0; j < length; ++j) {
                        const auto number = read(zero);
                        if (!slot.lists) continue;
                        Array<std::byte>& values = slot.lists->values;
                        values.resize(values.size() + sizeof number);
                        std::memcpy(values.data() + values.size() - sizeof number, &number, sizeof number);
                    }
                });
            } else if (slot.widened) {
                read_and_store(double());  // the text may have more digits than the declared type holds
            } else {
                visit_scalar(slot.property->type, read_and_store);
            }
        }
        if (text.more() && overlong.count++ == 0) overlong.first_line = text.line();
    }
    return overlong;
}

std::optional<FiniteBounds> widen_packed_positions(std::string_view body, const PlyElement& vertex,
                                                   PlyEncoding encoding, Array<Vec3>& positions) {
    const auto offset = packed_offset(vertex, encoding);
    if (!offset) return std::nullopt;
    const char* source = body.data() + *offset;
    return vertex.find("x")->type == ScalarType::float32
               ? widen_positions<float>(source, vertex.row_size(), positions)
               : widen_positions<double>(source, vertex.row_size(), positions);
}

}  // namespace scanmill
