// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Messages over a socket between two processes: four bytes of length, then the bytes.

#include <optional>
#include <string>
#include <string_view>

namespace scanmill {

/// Sends the whole message; false when nobody is there to receive it.
bool send_message(int socket, std::string_view message);

/// What arrives, cut into messages.
class MessageReader {
public:
    explicit MessageReader(int socket) : socket_(socket) {}

    enum class Arrival { something, nothing, end };
    /// Takes what has arrived; with `waits`, until something has. `end`: nobody will send any longer.
    Arrival receive(bool waits);
    /// The next whole message. Throws Error for a length that no message has.
    std::optional<std::string> next();

private:
    int socket_;
    std::string bytes_;
    std::size_t taken_ = 0;
};

}  // namespace scanmill
