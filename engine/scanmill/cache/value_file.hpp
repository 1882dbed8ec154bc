// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Files of the cache: small checked files, and value files. A value file holds raw arrays, which readers map into
/// memory without parsing.
///
/// Layout of a value file, little-endian:
/// - a preamble of 64 bytes: magic, length of the header, 128-bit XXH3 hashes of header and arrays, length of the file;
/// - the header in CBOR: kind, frame, and the name and shape of every array;
/// - zeros up to a multiple of 64 bytes, then the arrays, each beginning at a multiple of 64 bytes.
///
/// Every array has its own hash, so arrays can be hashed independently. The preamble holds the hash of these hashes.
/// Equal values give equal bytes. Numbers keep their bits.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/base/error.hpp"
#include "scanmill/data/point_stream.hpp"
#include "scanmill/kinds/value.hpp"

struct XXH3_state_s;

namespace scanmill {

/// Thrown if a file was read, but its bytes are not those that were written.
class __attribute__((visibility("default"))) DamagedFile : public Error {
public:
    using Error::Error;
    explicit DamagedFile(Error error) : Error(std::move(error)) {}
};

/// Writes a line with the kind, the file's name and the hash of the content, then the content. The file appears whole
/// or not at all. It is not synced to the disk. Throws Error if it cannot be written.
void write_checked(const std::filesystem::path& file, std::string_view kind, std::string_view content);

/// The content that write_checked() wrote; empty if the file does not exist. Throws DamagedFile if the file has another
/// kind, was written under another name, or has changed bytes, and Error if it cannot be read.
std::optional<std::string> read_checked(const std::filesystem::path& file, std::string_view kind);

/// Computes the hash of an array that arrives in parts. The array is padded with zeros as in a value file.
class ArrayHash {
public:
    ArrayHash();
    void add(std::span<const std::byte> part);
    /// The 128-bit XXH3 hash of everything added, most significant byte first. Pre: called once, after the last add().
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
    u64 bytes = 0;  ///< size of the value file
};

/// A value ready to be written. It shares the value's arrays and does not copy them.
class EncodedValue {
public:
    /// Cost: one pass over every byte of the value, to hash it.
    explicit EncodedValue(Value value);

    const Value& value() const { return value_; }
    const std::string& content() const { return name_.content; }
    /// Size of the value file in bytes.
    u64 size() const { return name_.bytes; }
    /// Writes the value file, which appears whole or not at all. The file is not synced to the disk: after a power cut,
    /// the hashes reveal damage. Throws Error for an unwritable folder or a full disk.
    void write(const std::filesystem::path& file) const;

private:
    Value value_;
    std::string head_;  ///< preamble, header and zeros
    std::vector<Buffer<std::byte>> arrays_;
    ValueName name_;
};

/// Reads the value in the file, and every byte once to check the hashes. The arrays stay mapped while they are in use.
/// Meanwhile the file may be removed, but not shortened; on a network file system, only this machine may remove it.
/// Throws DamagedFile if the file is not a value file, is truncated or has changed bytes, or if `content` is given and
/// the value has another content. Throws Error if it cannot be read.
Value read_value(const std::filesystem::path& file, std::string_view content = {});

/// Computes the name that EncodedValue gives to the point cloud in a file, without loading the cloud.
class StreamedContent {
public:
    /// Adds the positions of one chunk that open_point_stream() reports. They save a second pass over the positions if
    /// the scan is near zero.
    void add_world(std::span<const Vec3> positions) { positions_.add(std::as_bytes(positions)); }
    /// The name of the stream's cloud. `on_piece` is called for every piece, from this thread; its exceptions end the
    /// pass. Pre: add_world() got all positions of this stream; of() is called once.
    /// Cost: one pass over the file if the cloud has columns or is far from zero, with up to four pieces per thread in
    /// memory.
    ValueName of(const PointStream& stream, unsigned threads, const std::function<void()>& on_piece = {});

private:
    ArrayHash positions_;
};

}  // namespace scanmill
