// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/work/sha256.hpp"

#include <fmt/format.h>
#include <nettle/sha2.h>

#include <array>

namespace scanmill {

// Nettle is as fast as OpenSSL here, and loads in a tenth of the time, which every process would pay.

Sha256::Sha256() : context_(std::make_unique<sha256_ctx>()) { ::sha256_init(context_.get()); }

Sha256::~Sha256() = default;

void Sha256::add(std::string_view bytes) {
    ::sha256_update(context_.get(), bytes.size(), reinterpret_cast<const std::uint8_t*>(bytes.data()));
}

std::string Sha256::text() {
    std::array<std::uint8_t, SHA256_DIGEST_SIZE> digest;
    ::sha256_digest(context_.get(), digest.size(), digest.data());
    std::string text;
    for (const std::uint8_t byte : digest) text += fmt::format("{:02x}", byte);
    return text;
}

}  // namespace scanmill
