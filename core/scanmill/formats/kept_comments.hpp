// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The comments of a text, as many as anybody wants to read, and of all the others what they declare.

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace scanmill {

/// A file may hold a comment in every other line: memory is bounded.
class KeptComments {
public:
    static constexpr std::size_t most = 1000;

    void add(std::string_view comment);
    /// Those of the text that follows, where two parts were read by themselves: as if all had been added here.
    void append(const KeptComments& following);

    /// The first `most`; behind them the last of the others that declares a unit, before it the last that declares
    /// another one, the last that seems to declare one which is unknown, and the last that declares a frame (see
    /// declared_frame()).
    const std::vector<std::string>& texts() const { return texts_; }
    /// How many are not among texts().
    std::size_t others() const { return added_ - texts_.size(); }

private:
    /// The unit that was the last is no longer.
    void keep_other_unit();

    std::vector<std::string> texts_;
    std::size_t added_ = 0;
    /// Where in texts_ the last of each kind of declaration is; 0: there is none.
    std::array<std::size_t, 3> places_{};
    std::size_t other_unit_ = 0;
};

}  // namespace scanmill
