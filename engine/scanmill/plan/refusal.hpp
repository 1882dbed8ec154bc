// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "scanmill/base/error.hpp"
#include "scanmill/record/fields.hpp"

namespace scanmill {

/// The reason why a scan must not be read, and what the user can do. Without a sentence, it may be read.
struct Refusal {
    std::string sentence, hint;

    bool empty() const { return sentence.empty(); }
    /// Both in one line, for warnings.
    std::string text() const { return hint.empty() ? sentence : sentence + "; " + hint; }
    Error error() const { return Error(sentence).hint(hint); }
};
constexpr auto fields(const Refusal*) {
    using R = Refusal;
    return std::tuple{field("sentence", &R::sentence), field("hint", &R::hint)};
}

}  // namespace scanmill
