// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/base/hash.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <array>
#include <fstream>
#include <memory>

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {

std::string text_of(const XXH128_hash_t& hash) { return fmt::format("{:016x}{:016x}", hash.high64, hash.low64); }

}  // namespace

KeyBuilder& KeyBuilder::field(std::string_view name, std::string_view value) {
    for (std::string_view part : {name, value}) {
        bytes_ += std::to_string(part.size());
        bytes_ += ':';
        bytes_ += part;
    }
    return *this;
}

std::string KeyBuilder::key() const { return text_of(XXH3_128bits(bytes_.data(), bytes_.size())); }

std::string content_hash(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw Error("'{}' cannot be read", file.string());
    const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), XXH3_freeState);
    XXH3_128bits_reset(state.get());
    std::array<char, 1 << 16> block;
    while (stream.read(block.data(), static_cast<std::streamsize>(block.size())), stream.gcount() > 0)
        XXH3_128bits_update(state.get(), block.data(), static_cast<std::size_t>(stream.gcount()));
    if (stream.bad()) throw Error("'{}' cannot be read to its end", file.string());
    return text_of(XXH3_128bits_digest(state.get()));
}

}  // namespace scanmill
