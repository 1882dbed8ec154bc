// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/key.hpp"

#include <fmt/format.h>
#include <xxhash.h>

namespace scanmill {

KeyBuilder& KeyBuilder::field(std::string_view name, std::string_view value) {
    for (std::string_view part : {name, value}) {
        bytes_ += std::to_string(part.size());
        bytes_ += ':';
        bytes_ += part;
    }
    return *this;
}

std::string KeyBuilder::key() const {
    const XXH128_hash_t hash = XXH3_128bits(bytes_.data(), bytes_.size());
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace scanmill
