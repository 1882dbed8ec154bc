// SPDX-License-Identifier: GPL-3.0-or-later
// A filter's params may extend those of its algorithm: members of the base are declared like any other.

#include <gtest/gtest.h>

#include "scanmill/filter/declare.hpp"

namespace scanmill::test {
namespace {

enum class InheritedRule { nearest, random };

struct AlgorithmParams {
    int count = 3;
    InheritedRule rule = InheritedRule::nearest;
};

struct FilterParams : AlgorithmParams {
    std::string file = "a";
};

TEST(DeclareInherited, Members_HaveTheirDefaultsAndTakeValues) {
    using P = FilterParams;
    P seen;
    const FilterDeclaration declared =
        Declare<P>("inheriting", 1)
            .param("count", &P::count, "help")
            .choice("rule", &P::rule,
                    {{"nearest", InheritedRule::nearest, "help"}, {"random", InheritedRule::random, "help"}}, "help")
            .param("file", &P::file, "help")
            .run([&](const Inputs&, const P& params, Context&) { return seen = params, Outputs(); });
    EXPECT_EQ(declared.spec.parameter("count")->default_value, ParameterValue(ParameterScalar(std::int64_t(3))));
    EXPECT_EQ(declared.spec.parameter("rule")->default_value, ParameterValue(ParameterScalar(std::string("nearest"))));
    Context context;
    declared.run({},
                 {{{"count", ParameterScalar(std::int64_t(8))},
                   {"rule", ParameterScalar(std::string("random"))},
                   {"file", ParameterScalar(std::string("b"))}}},
                 context);
    EXPECT_EQ(seen.count, 8);
    EXPECT_EQ(seen.rule, InheritedRule::random);
    EXPECT_EQ(seen.file, "b");
}

}  // namespace
}  // namespace scanmill::test
