// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The SHA-256 of bytes that come piece by piece; the hash that users can check with sha256sum.

#include <memory>
#include <string>
#include <string_view>

struct evp_md_ctx_st;

namespace scanmill {

class Sha256 {
public:
    /// Throws Error when the system's OpenSSL has no SHA-256.
    Sha256();

    void add(std::string_view bytes);
    /// 64 hexadecimal digits. Once, after everything was added.
    std::string text();

private:
    std::unique_ptr<evp_md_ctx_st, void (*)(evp_md_ctx_st*)> context_;
};

}  // namespace scanmill
