// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/cache/value_file.hpp"

#include <fmt/format.h>
#include <xxhash.h>
#include <bit>
#include <cstring>
#include <fstream>
#include <memory>
#include <sstream>

#include "scanmill/base/error.hpp"
#include "scanmill/cache/value_fields.hpp"
#include "scanmill/io/atomic_file.hpp"
#include "scanmill/io/mapped_file.hpp"

namespace scanmill {

namespace {

std::string head_of(const std::filesystem::path& file, std::string_view kind, std::string_view content) {
    const XXH128_hash_t hash = XXH3_128bits(content.data(), content.size());
    return fmt::format("scanmill {} {} {:016x}{:016x}\n", kind, file.filename().string(), hash.high64, hash.low64);
}

}  // namespace

void write_checked(const std::filesystem::path& file, std::string_view kind, std::string_view content) {
    AtomicFile target(file);
    target.write(head_of(file, kind, content));
    target.write(content);
    target.commit(AtomicFile::Sync::no);
}

std::optional<std::string> read_checked(const std::filesystem::path& file, std::string_view kind) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) return std::nullopt;
    std::ostringstream text;
    text << stream.rdbuf();
    const std::string bytes = std::move(text).str();
    const std::size_t end = bytes.find('\n');
    const std::string content = end == std::string::npos ? std::string() : bytes.substr(end + 1);
    if (!stream || bytes.substr(0, end + 1) != head_of(file, kind, content))
        throw Error("'{}' is damaged: its bytes are not those that were written under this name", file.string());
    return content;
}

ArraysHash::ArraysHash() : state_(XXH3_createState()) { XXH3_128bits_reset(state_.get()); }
ArraysHash::~ArraysHash() = default;

void ArraysHash::Free::operator()(XXH3_state_s* state) const { XXH3_freeState(state); }

void ArraysHash::add(std::span<const std::byte> part) {
    XXH3_128bits_update(state_.get(), part.data(), part.size());
    array_bytes_ += part.size();
}

void ArraysHash::end_array() {
    constexpr std::array<std::byte, value_alignment> zeros{};
    XXH3_128bits_update(state_.get(), zeros.data(), aligned(array_bytes_) - array_bytes_);
    array_bytes_ = 0;
}

std::array<std::byte, 16> ArraysHash::digest() const {
    XXH128_canonical_t bytes;
    XXH128_canonicalFromHash(&bytes, XXH3_128bits_digest(state_.get()));
    return std::bit_cast<std::array<std::byte, 16>>(bytes);
}

namespace {

constexpr std::string_view magic = "SMVALUE1";

struct Preamble {
    char magic[8];
    u64 header_bytes;
    XXH128_canonical_t header_hash, arrays_hash;
    u64 file_bytes;
    u64 reserved;
};
static_assert(sizeof(Preamble) == value_alignment);

constexpr std::array<std::byte, value_alignment> zeros{};

std::span<const std::byte> padding(std::size_t bytes) { return std::span(zeros).first(aligned(bytes) - bytes); }

XXH128_canonical_t canonical(XXH128_hash_t hash) {
    XXH128_canonical_t bytes;
    XXH128_canonicalFromHash(&bytes, hash);
    return bytes;
}

bool equal(const XXH128_canonical_t& a, const XXH128_canonical_t& b) {
    return std::memcmp(a.digest, b.digest, sizeof a.digest) == 0;
}

std::string_view text_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The preamble knows every byte through its two hashes.
std::string content_text(const Preamble& preamble) {
    const XXH128_hash_t whole = XXH3_128bits(&preamble, sizeof preamble);
    return fmt::format("{:016x}{:016x}", whole.high64, whole.low64);
}

Preamble preamble_of(const ValueFields& fields, const ArraysHash& hash) {
    Preamble preamble{};
    std::memcpy(preamble.magic, magic.data(), magic.size());
    preamble.header_bytes = fields.header.size();
    preamble.header_hash = canonical(XXH3_128bits(fields.header.data(), fields.header.size()));
    preamble.arrays_hash = std::bit_cast<XXH128_canonical_t>(hash.digest());
    preamble.file_bytes = sizeof preamble + aligned(fields.header.size());
    for (const std::span<const std::byte>& array : fields.arrays) preamble.file_bytes += aligned(array.size());
    return preamble;
}

}  // namespace

ValueName name_of_value(const ValueFields& fields, const ArraysHash& hash) {
    const Preamble preamble = preamble_of(fields, hash);
    return {content_text(preamble), preamble.file_bytes};
}

EncodedValue::EncodedValue(Value value) : value_(std::move(value)) {
    ValueFields fields = fields_of(value_);
    ArraysHash hash;
    for (const std::span<const std::byte>& array : fields.arrays) {
        hash.add(array);
        hash.end_array();
    }
    const Preamble preamble = preamble_of(fields, hash);
    name_ = {content_text(preamble), preamble.file_bytes};
    head_.append(reinterpret_cast<const char*>(&preamble), sizeof preamble);
    head_ += fields.header;
    head_ += text_of(padding(fields.header.size()));
    arrays_ = std::move(fields.arrays);
}

void EncodedValue::write(const std::filesystem::path& file) const {
    AtomicFile target(file);
    target.write(head_);
    for (const std::span<const std::byte>& array : arrays_) {
        target.write(text_of(array));
        target.write(text_of(padding(array.size())));
    }
    target.commit(AtomicFile::Sync::no);
}

Value read_value(const std::filesystem::path& file, std::string_view content) {
    const auto map = std::make_shared<const MappedFile>(file);
    const std::string_view bytes = map->bytes();
    Preamble preamble;
    if (bytes.size() < sizeof preamble || !bytes.starts_with(magic))
        throw Error("'{}' is no value file", file.string());
    std::memcpy(&preamble, bytes.data(), sizeof preamble);
    if (preamble.file_bytes != bytes.size() || preamble.header_bytes > bytes.size() - sizeof preamble)
        throw Error("'{}' has {} bytes and promises {}", file.string(), bytes.size(), preamble.file_bytes);
    const std::string_view header = bytes.substr(sizeof preamble, preamble.header_bytes);
    const std::string_view arrays = bytes.substr(std::min(bytes.size(), sizeof preamble + aligned(header.size())));
    if (!equal(preamble.header_hash, canonical(XXH3_128bits(header.data(), header.size()))) ||
        !equal(preamble.arrays_hash, canonical(XXH3_128bits(arrays.data(), arrays.size()))))
        throw Error("'{}' is damaged: its bytes are not those that were written", file.string());
    if (const std::string found = content_text(preamble); !content.empty() && found != content)
        throw Error("'{}' is damaged: it holds the value {}", file.string(), found);
    return value_of(header, arrays, map);
}

}  // namespace scanmill
