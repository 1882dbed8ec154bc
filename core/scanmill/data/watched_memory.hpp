// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Whether this build watches memory with AddressSanitizer. It sees blocks of the heap alone, so what otherwise takes
/// memory by other ways takes it from there then.

namespace scanmill {

#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool watched_memory = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
inline constexpr bool watched_memory = true;
#else
inline constexpr bool watched_memory = false;
#endif
#else
inline constexpr bool watched_memory = false;
#endif

}  // namespace scanmill
