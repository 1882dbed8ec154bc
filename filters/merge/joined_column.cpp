// SPDX-License-Identifier: GPL-3.0-or-later
#include "merge/joined_column.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace scanmill::merging {

namespace {

Buffer<std::byte> bytes_end_to_end(std::span<const Column> parts) {
    std::size_t size = 0;
    for (const Column& part : parts) size += part.bytes().size();
    Array<std::byte> bytes(size);
    std::size_t at = 0;
    for (const Column& part : parts) {
        if (!part.bytes().empty()) std::memcpy(bytes.data() + at, part.bytes().data(), part.bytes().size());
        at += part.bytes().size();
    }
    return bytes;
}

Buffer<u64> offsets_end_to_end(std::span<const Column> parts) {
    Array<u64> offsets{0};
    for (const Column& part : parts) {
        const u64 before = offsets.back();
        for (std::size_t row = 1; row <= part.rows(); ++row) offsets.push_back(before + part.offsets()[row]);
    }
    return offsets;
}

Column as_doubles(std::span<const Column> parts) {
    Array<double> values;
    for (const Column& part : parts)
        visit_scalar(part.type(), [&](auto zero) {
            for (const auto value : part.values<decltype(zero)>()) values.push_back(static_cast<double>(value));
        });
    return {parts.front().name(), parts.front().components(), Buffer<double>(std::move(values))};
}

}  // namespace

Column joined(std::span<const Column> parts) {
    const Column& first = parts.front();
    if (!std::ranges::all_of(parts, [&](const Column& part) { return part.type() == first.type(); })) {
        assert(!first.is_list());
        return as_doubles(parts);
    }
    return {first.name(), first.type(), first.components(), bytes_end_to_end(parts),
            first.is_list() ? offsets_end_to_end(parts) : Buffer<u64>()};
}

}  // namespace scanmill::merging
