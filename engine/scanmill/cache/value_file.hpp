// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Files of the cache: small checked files, and values as files of raw arrays, which readers map and do not parse.
///
/// Layout of a value file, little-endian: 64 bytes of preamble (magic, length of the header, 128-bit XXH3 hashes of
/// header and arrays, length of the file), the header (CBOR: kind, frame, the name and shape of every array), zeros up
/// to a multiple of 64, then the arrays, each on a multiple of 64. The hash of the arrays is the hash of one hash per
/// array, so that arrays can be hashed side by side. Equal values give equal bytes. Numbers keep their bits.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/data/point_stream.hpp"
#include "scanmill/kinds/value.hpp"

struct XXH3_state_s;

namespace scanmill {

/// Writes a line with the kind, the file's name and the hash of the content, then the content. The file appears whole
/// or not at all, without being synced to the disk. Throws Error.
void write_checked(const std::filesystem::path& file, std::string_view kind, std::string_view content);

/// Empty if the file does not exist. Throws Error if it has another kind, was written under another name, or its bytes
/// changed.
std::optional<std::string> read_checked(const std::filesystem::path& file, std::string_view kind);

/// The hash of an array that arrives in parts, padded with zeros as in a value file.
class ArrayHash {
public:
    ArrayHash();
    void add(std::span<const std::byte> part);
    /// 128-bit XXH3 of everything added, most significant byte first. Once.
    std::string digest();

private:
    struct Free {
        void operator()(XXH3_state_s* state) const;
    };
    std::unique_ptr<XXH3_state_s, Free> state_;
    std::size_t bytes_ = 0;
};

/// The identity of a value in the cache.
struct ValueName {
    std::string content;  ///< 32 hexadecimal digits, equal for equal values
    u64 bytes = 0;        ///< of its file
};

/// A value ready to be written; shares its arrays.
class EncodedValue {
public:
    /// Cost: one pass over every byte of the value, to hash it.
    explicit EncodedValue(Value value);

    const Value& value() const { return value_; }
    const std::string& content() const { return name_.content; }
    /// Bytes of the file.
    u64 size() const { return name_.bytes; }
    /// The file appears whole or not at all. It is not synced to the disk; the hashes reveal what a power cut damages.
    /// Throws Error for an unwritable folder or a full disk.
    void write(const std::filesystem::path& file) const;

private:
    Value value_;
    std::string head_;  ///< preamble, header and zeros
    std::vector<Buffer<std::byte>> arrays_;
    ValueName name_;
};

/// The value in the file. Its arrays are mapped as long as they are in use; the file may be removed meanwhile, but not
/// shortened. Reads every byte once to check the hashes. Throws Error: no such file, not a value file, truncated, or
/// changed bytes; with `content` given, also for a value of another content.
Value read_value(const std::filesystem::path& file, std::string_view content = {});

/// Computes the name that EncodedValue gives to the point cloud in a file, without loading the cloud.
class StreamedContent {
public:
    /// To be called with every chunk that open_point_stream() reports: a scan near zero needs no second pass over them.
    void add_world(std::span<const Vec3> positions) { positions_.add(std::as_bytes(positions)); }
    /// Pre: add_world() got all positions of this stream; called once. Cost: one pass over the file if the cloud has
    /// columns or is far from zero; up to four pieces per thread are in memory. `on_piece` is called for every piece,
    /// from this thread; its exceptions end the pass.
    ValueName of(const PointStream& stream, unsigned threads, const std::function<void()>& on_piece = {});

private:
    ArrayHash positions_;
};

}  // namespace scanmill
