// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What a refusal says: `EXPECT_EQ(sentence_of([] { Ratio::parse("x"); }), "'x' is not a ratio; …")`.

#include <gtest/gtest.h>

#include <string>

#include "scanmill/base/error.hpp"

namespace scanmill::test {

/// The Error that `action` throws; without one the test fails and the Error is empty.
template <class Action>
Error error_of(Action&& action) {
    try {
        action();
    } catch (const Error& error) {
        return error;
    }
    ADD_FAILURE() << "no Error was thrown";
    return Error(std::string());
}

template <class Action>
std::string sentence_of(Action&& action) {
    return error_of(action).sentence();
}

}  // namespace scanmill::test
