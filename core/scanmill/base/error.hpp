// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What the world does to us: one sentence that a user can act on, a way out, and where it happened.
///
/// Whoever throws writes the sentence (what was found, what is needed, with numbers). Each layer that lets the error
/// pass adds the one thing it knows, innermost first: "in step 'delaunay' (object.yaml:14:5)", "on scan 'plate.ply'".
/// Our own invariants are asserts, never Errors.

#include <fmt/format.h>

#include <exception>
#include <string>
#include <utility>
#include <vector>

namespace scanmill {

class __attribute__((visibility("default"))) Error : public std::exception {
public:
    explicit Error(std::string sentence);
    template <class... Arguments>
        requires(sizeof...(Arguments) > 0)
    explicit Error(fmt::format_string<Arguments...> sentence, Arguments&&... arguments)
        : Error(fmt::format(sentence, std::forward<Arguments>(arguments)...)) {}
    ~Error() override;

    Error& add_frame(std::string frame);
    Error& set_hint(std::string hint);
    /// For `throw Error(...).hint(...)`.
    Error&& hint(std::string text) &&;

    const std::string& sentence() const { return sentence_; }
    const std::vector<std::string>& frames() const { return frames_; }
    const std::string& hint() const { return hint_; }
    /// Sentence, frames (each on its line, indented by two) and hint, without a trailing newline.
    const char* what() const noexcept override { return text_.c_str(); }

private:
    void compose();
    std::string sentence_;
    std::vector<std::string> frames_;
    std::string hint_;
    std::string text_;
};

}  // namespace scanmill
