// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Text for stderr. Nobody may be listening there, or the disk that it goes to be full: that is no reason to end.

#include <fmt/format.h>

#include <cstdio>

namespace scanmill::runner {

template <class... Arguments>
void tell(fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    const std::string told = fmt::format(text, std::forward<Arguments>(arguments)...);
    [[maybe_unused]] const std::size_t ignored = std::fwrite(told.data(), 1, told.size(), stderr);
}

}  // namespace scanmill::runner
