// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Small files that are whole or refused: a line with the kind of thing, the file's name and the hash of the rest, then
/// the rest.

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/kinds/value.hpp"

struct XXH3_state_s;

namespace scanmill {

/// Appears whole or not at all, without being synced to the disk. Throws Error.
void write_checked(const std::filesystem::path& file, std::string_view kind, std::string_view content);

/// Nothing when there is no such file. Throws Error when it is of another kind, was written under another name, or
/// its bytes are not those that were written.
std::optional<std::string> read_checked(const std::filesystem::path& file, std::string_view kind);

// The hash of a value's arrays as they lie in its file: one after the other, each followed by zeros up to a multiple
// of value_alignment. An array may come in one part or in many, so that it never need be in memory as a whole.

class ArraysHash {
public:
    ArraysHash();
    ArraysHash(ArraysHash&&) = default;
    ArraysHash& operator=(ArraysHash&&) = default;
    ~ArraysHash();

    /// The next bytes of the array that was begun last; the first call begins one.
    void add(std::span<const std::byte> part);
    /// What is added from now on belongs to the next array.
    void end_array();
    /// 128-bit XXH3 of all arrays that were ended, most significant byte first.
    std::array<std::byte, 16> digest() const;

private:
    struct Free {
        void operator()(XXH3_state_s* state) const;
    };
    std::unique_ptr<XXH3_state_s, Free> state_;
    std::size_t array_bytes_ = 0;
};

// Values as files of raw arrays, which are mapped and not parsed: how a value passes from one process, or one run, to
// another.
//
// Layout, little-endian: 64 bytes of preamble (magic, length of the header, 128-bit XXH3 hashes of header and arrays,
// length of the file), the header (CBOR: kind, frame, the name, shape and place of every array), zeros up to a
// multiple of 64, then the arrays, each on a multiple of 64. Equal values give equal bytes. Every number comes back
// with its bits.

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
