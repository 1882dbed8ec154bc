// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/base/error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>

#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(Error, SentenceAlone_IsTheWholeText) {
    const Error error("the cloud has no points");
    EXPECT_STREQ(error.what(), "the cloud has no points");
    EXPECT_EQ(error.sentence(), "the cloud has no points");
    EXPECT_THAT(error.frames(), IsEmpty());
    EXPECT_EQ(error.hint(), "");
}

TEST(Error, Numbers_AreFormattedIntoTheSentence) {
    EXPECT_EQ(Error("needs {} points; the cloud has {}", 4, 3u).sentence(), "needs 4 points; the cloud has 3");
}

TEST(Error, SentenceWithBraces_IsTakenAsItStands) {
    const std::string user_text = "{stem}: {} and }";
    EXPECT_EQ(Error(user_text).sentence(), user_text);
}

TEST(Error, FramesAndHint_FollowTheSentenceInOrder) {
    Error error = Error("it broke").hint("mend it");
    error.add_frame("in step 'delaunay' (a.yaml:14:5)").add_frame("on scan 'plate.ply'");
    EXPECT_STREQ(error.what(), "it broke\n  in step 'delaunay' (a.yaml:14:5)\n  on scan 'plate.ply'\nhint: mend it");
    EXPECT_THAT(error.frames(), ElementsAre("in step 'delaunay' (a.yaml:14:5)", "on scan 'plate.ply'"));
    EXPECT_EQ(error.sentence(), "it broke");
    EXPECT_EQ(error.hint(), "mend it");
}

TEST(Error, SecondHint_ReplacesTheFirst) {
    Error error = Error("it broke").hint("mend it");
    error.set_hint("buy another");
    EXPECT_STREQ(error.what(), "it broke\nhint: buy another");
    error.set_hint("");
    EXPECT_STREQ(error.what(), "it broke");
}

TEST(Error, Expectation_EndsTheSentenceAfterTheFinding) {
    const Error error = Error("'x' is not a length").expected("0.1 mm");
    EXPECT_EQ(error.sentence(), "'x' is not a length; expected 0.1 mm");
    EXPECT_EQ(error.finding(), "'x' is not a length");
    EXPECT_EQ(error.reworded("it broke").finding(), "it broke");
}

TEST(Error, ThrownWithAHint_IsCaughtAsAStandardException) {
    try {
        throw Error("needs {}", 1).hint("give one");
    } catch (const std::exception& error) {
        EXPECT_STREQ(error.what(), "needs 1\nhint: give one");
    }
}

TEST(Error, OfWriting_AsksForAnotherDiskIfThisOneIsFullOrBroken) {
    for (const int number : {ENOSPC, EDQUOT, EIO, EROFS})
        EXPECT_EQ(Error::of_writing("x", number).remedy(), Remedy::use_other_disk) << number;
    for (const int number : {EACCES, EFBIG, ENOENT})
        EXPECT_EQ(Error::of_writing("x", number).remedy(), Remedy::none) << number;
    EXPECT_EQ(Error::of_writing("x", ENOSPC).reworded("y").remedy(), Remedy::use_other_disk);
}

TEST(Error, LayerThatRethrows_AddsItsFrameToTheSameError) {
    const Error error = error_of([] {
        try {
            throw Error("it broke");
        } catch (Error& passing) {
            passing.add_frame("in step 'x'");
            throw;
        }
    });
    EXPECT_STREQ(error.what(), "it broke\n  in step 'x'");
}

}  // namespace
}  // namespace scanmill::test
