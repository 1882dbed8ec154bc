// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The SHA-256 of bytes that come piece by piece; the hash that users can check with sha256sum.

#include <memory>
#include <string>
#include <string_view>

struct sha256_ctx;

namespace scanmill {

class Sha256 {
public:
    Sha256();
    ~Sha256();

    void add(std::string_view bytes);
    /// 64 hexadecimal digits. Once, after everything was added.
    std::string text();

private:
    std::unique_ptr<sha256_ctx> context_;
};

}  // namespace scanmill
