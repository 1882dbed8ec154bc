// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/work/sha256.hpp"

#include <fmt/format.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>

#include <array>

#include "scanmill/filter/error.hpp"

namespace scanmill {

namespace {
void require(int success) {
    if (success != 1) throw Error("OpenSSL cannot compute a SHA-256");
}
}  // namespace

Sha256::Sha256() : context_(nullptr, ::EVP_MD_CTX_free) {
    ::OPENSSL_init_crypto(OPENSSL_INIT_NO_LOAD_CONFIG, nullptr);  // nobody's settings change what a SHA-256 is
    context_.reset(::EVP_MD_CTX_new());
    require(context_ && ::EVP_DigestInit_ex(context_.get(), ::EVP_sha256(), nullptr) == 1);
}

void Sha256::add(std::string_view bytes) { require(::EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size())); }

std::string Sha256::text() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest;
    unsigned length = 0;
    require(::EVP_DigestFinal_ex(context_.get(), digest.data(), &length));
    std::string text;
    for (unsigned i = 0; i < length; ++i) text += fmt::format("{:02x}", digest[i]);
    return text;
}

}  // namespace scanmill
