// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/base/text.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace scanmill::test {
namespace {

/// The candidate that did_you_mean() names.
std::string closest_of(std::string_view word, std::vector<std::string> candidates) {
    const std::string text = did_you_mean(word, candidates);
    const std::size_t begin = text.find('\'') + 1;
    return text.empty() ? "" : text.substr(begin, text.rfind('\'') - begin);
}

TEST(Closest, EachKindOfTypingError_IsOneEdit) {
    // A three-letter word is allowed one edit, so each of these must count as one.
    EXPECT_EQ(closest_of("ato", {"auto"}), "auto") << "a letter left out";
    EXPECT_EQ(closest_of("abc", {"ab"}), "ab") << "a letter too many";
    EXPECT_EQ(closest_of("abx", {"abc"}), "abc") << "another letter";
    EXPECT_EQ(closest_of("acb", {"abc"}), "abc") << "two neighbours swapped";
}

TEST(Closest, ShortWord_IsAllowedOneEdit) {
    EXPECT_EQ(closest_of("axy", {"abc"}), "");
    EXPECT_EQ(closest_of("ab", {"abc"}), "abc");
    EXPECT_EQ(closest_of("ab", {"abcd"}), "");
}

TEST(Closest, FromFourLettersOn_TwoEditsAreAllowed) {
    EXPECT_EQ(closest_of("mode", {"modexy"}), "modexy");
    EXPECT_EQ(closest_of("mode", {"modexyz"}), "");
}

TEST(Closest, LongWord_IsAllowedAThirdOfItsLetters) {
    EXPECT_EQ(closest_of("triangula", {"triangulation"}), "") << "four edits for nine letters";
    EXPECT_EQ(closest_of("triangulati", {"triangulxxxi"}), "triangulxxxi") << "three edits for eleven letters";
    EXPECT_EQ(closest_of("tight-cocoon", {"tight-cocone"}), "tight-cocone");
}

TEST(Closest, FewestEdits_Win) {
    EXPECT_EQ(closest_of("decimat", {"decimates", "decimate"}), "decimate");
    EXPECT_EQ(closest_of("decimat", {"decimate", "decimates"}), "decimate");
}

TEST(Closest, Ties_GoToTheEarlierCandidate) {
    EXPECT_EQ(closest_of("scan-c", {"scan-b", "scan-a"}), "scan-b");
    EXPECT_EQ(closest_of("scan-c", {"scan-a", "scan-b"}), "scan-a");
    EXPECT_EQ(closest_of("mode", {"modes1", "models"}), "modes1") << "also at the largest allowed number";
}

TEST(Closest, NothingInCommon_IsNoSuggestion) {
    EXPECT_EQ(closest_of("a", {"b"}), "");
    EXPECT_EQ(closest_of("x", {"ab", "c"}), "");
    EXPECT_EQ(closest_of("", {"a"}), "");
    EXPECT_EQ(closest_of("mode", {}), "");
}

TEST(Closest, HostileLength_IsNobodysTypingError) {
    EXPECT_EQ(closest_of(std::string(100'000, 'a'), {std::string(100'000, 'a') + "b"}), "");
}

TEST(DidYouMean, Candidate_IsAppendedAsAClause) {
    const std::vector<std::string> names{"minimum", "quantile"};
    EXPECT_EQ(did_you_mean("minimun", names), "; did you mean 'minimum'?");
    EXPECT_EQ(did_you_mean("zzz", names), "");
}

TEST(Enumerated, Names_AreJoinedAsInASentence) {
    EXPECT_EQ(enumerated(std::vector<std::string>{}), "");
    EXPECT_EQ(enumerated(std::vector<std::string>{"a"}), "a");
    EXPECT_EQ(enumerated(std::vector<std::string>{"a", "b"}), "a and b");
    EXPECT_EQ(enumerated(std::vector<std::string>{"a", "b", "c"}), "a, b and c");
}

}  // namespace
}  // namespace scanmill::test
