// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/work/message_channel.hpp"

#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include "scanmill/filter/error.hpp"

namespace scanmill {

namespace {
using Length = std::uint32_t;
constexpr Length longest = 64u << 20;
}  // namespace

bool send_message(int socket, std::string_view message) {
    std::string bytes(sizeof(Length), '\0');
    const Length length = static_cast<Length>(message.size());
    std::memcpy(bytes.data(), &length, sizeof length);
    bytes += message;
    for (std::size_t sent = 0; sent < bytes.size();) {
        const ssize_t now = ::send(socket, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
        if (now < 0 && errno == EINTR) continue;
        if (now <= 0) return false;
        sent += static_cast<std::size_t>(now);
    }
    return true;
}

MessageReader::Arrival MessageReader::receive(bool waits) {
    std::array<char, 1 << 16> block;
    const ssize_t length = ::recv(socket_, block.data(), block.size(), waits ? 0 : MSG_DONTWAIT);
    if (length > 0) {
        bytes_.append(block.data(), static_cast<std::size_t>(length));
        return Arrival::something;
    }
    if (length < 0 && (errno == EINTR || errno == EAGAIN || errno == EWOULDBLOCK)) return Arrival::nothing;
    return Arrival::end;
}

std::optional<std::string> MessageReader::next() {
    Length length;
    if (bytes_.size() - taken_ < sizeof length) return std::nullopt;
    std::memcpy(&length, bytes_.data() + taken_, sizeof length);
    if (length > longest) throw Error("a message between runner and worker has {} bytes", length);
    if (bytes_.size() - taken_ - sizeof length < length) return std::nullopt;
    std::string message = bytes_.substr(taken_ + sizeof length, length);
    taken_ += sizeof length + length;
    if (taken_ == bytes_.size()) {
        bytes_.clear();
        taken_ = 0;
    }
    return message;
}

}  // namespace scanmill
