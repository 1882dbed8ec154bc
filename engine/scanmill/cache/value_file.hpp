// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Values as files of raw arrays, which are mapped and not parsed: how a value passes from one process, or one run, to
/// another.
///
/// Layout, little-endian: 64 bytes of preamble (magic, length of the header, 128-bit XXH3 hashes of header and arrays,
/// length of the file), the header (CBOR: kind, frame, the name, shape and place of every array), zeros up to a
/// multiple of 64, then the arrays, each on a multiple of 64. Equal values give equal bytes. Every number comes back
/// with its bits.

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/data/value.hpp"

namespace scanmill {

class ArraysHash;
struct ValueFields;

/// What a value is known by.
struct ValueName {
    /// 32 hexadecimal digits, of everything that the value holds: equal for equal values.
    std::string content;
    u64 bytes = 0;  ///< of its file
};

/// Of a value that was taken apart and whose arrays went through `hash`; of fields.arrays only the sizes are asked.
ValueName name_of_value(const ValueFields& fields, const ArraysHash& hash);

/// A value ready to be written; shares its arrays.
class EncodedValue {
public:
    /// Cost: one pass over every byte of the value, to hash it.
    explicit EncodedValue(Value value);

    const std::string& content() const { return name_.content; }
    /// Bytes of the file.
    u64 size() const { return name_.bytes; }
    /// The file appears whole or not at all. It is not synced to the disk: what a power cut tears is found by its hash.
    /// Throws Error for a folder that cannot be written to and a full disk.
    void write(const std::filesystem::path& file) const;

private:
    Value value_;
    std::string head_;  ///< preamble, header and zeros
    std::vector<std::span<const std::byte>> arrays_;  ///< of value_
    ValueName name_;
};

/// The value in the file, its arrays mapped as long as anybody holds them. Reads every byte once to check the hashes.
/// Throws Error: no such file, not a value file, of another version, cut short, or with bytes that were changed. Nobody
/// may shorten the file afterwards; removing it does no harm. With `content` given, also for a value of another
/// content.
Value read_value(const std::filesystem::path& file, std::string_view content = {});

}  // namespace scanmill
