// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/cache/arrays_hash.hpp"

#include <xxhash.h>

#include <bit>

#include "scanmill/cache/value_fields.hpp"

namespace scanmill {

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

}  // namespace scanmill
