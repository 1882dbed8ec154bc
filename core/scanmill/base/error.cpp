// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/base/error.hpp"

#include <cerrno>

namespace scanmill {

Error::Error(std::string sentence) : sentence_(std::move(sentence)), text_(sentence_) {}
Error::~Error() = default;

Error& Error::add_frame(std::string frame) {
    frames_.push_back(std::move(frame));
    compose();
    return *this;
}

Error& Error::set_hint(std::string hint) {
    hint_ = std::move(hint);
    compose();
    return *this;
}

Error&& Error::hint(std::string text) && {
    set_hint(std::move(text));
    return std::move(*this);
}

Error&& Error::remedy(Remedy remedy) && {
    remedy_ = remedy;
    return std::move(*this);
}

Error Error::of_writing(std::string sentence, int number) {
    const bool is_of_disk = number == ENOSPC || number == EDQUOT || number == EIO || number == EROFS;
    return Error(std::move(sentence)).remedy(is_of_disk ? Remedy::use_other_disk : Remedy::none);
}

Error&& Error::expected(std::string_view forms) && {
    finding_ = sentence_;
    sentence_.append("; expected ").append(forms);
    compose();
    return std::move(*this);
}

Error Error::reworded(std::string sentence) const {
    Error other = *this;
    other.sentence_ = std::move(sentence);
    other.finding_.clear();
    other.compose();
    return other;
}

void Error::compose() {
    text_ = sentence_;
    for (const std::string& frame : frames_) text_ += "\n  " + frame;
    if (!hint_.empty()) text_ += "\nhint: " + hint_;
}

}  // namespace scanmill
