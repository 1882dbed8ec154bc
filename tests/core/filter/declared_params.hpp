// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A filter with a parameter of every type, as a declaration.

#include "scanmill/filter/declare.hpp"

namespace scanmill::test {

enum class Rule { nearest, random, densest };

/// One member of every type that a parameter can have.
struct AllParams {
    bool flag = true;
    int count = 3;
    u32 seeds = 8;
    std::int64_t big = std::int64_t(1) << 40;
    double weight = 0.25;
    std::string label = "part";
    std::filesystem::path file = "a/b.txt";
    Length size = Length::percent_of_diagonal(0.1);
    Angle bend = Angle::degrees(40);
    Ratio share = Ratio::percent(5);
    Rule rule = Rule::random;
    std::vector<double> axis{0, 0, 1};
    std::vector<Length> sizes{Length(1), Length::spacings(2)};
    std::vector<std::string> names;
    std::vector<bool> flags{true, false};
    std::vector<std::filesystem::path> files{"x"};
    std::optional<Length> alpha;
    std::optional<double> fairing = 0.5;
    std::optional<std::filesystem::path> log;
    std::optional<std::vector<int>> picks;
    Length max_error;
};

inline const char* const help = "A parameter for tests.";

inline Declare<AllParams> declaration() {
    using P = AllParams;
    return Declare<P>("all-sorts", 7)
        .summary("Has a parameter of every type.")
        .source("Hand-made")
        .ties("There are none.")
        .not_finite(help)
        .in<PointCloud>("points", help)
        .in<TriangleMesh>("mesh", help, optional)
        .in<PointCloud>("others", help, list)
        .in<TetMesh>("tets", help, list, optional)
        .in<TriangleMesh, PointCloud>("truth", help)
        .out<TriangleMesh>("mesh", help)
        .out<Metrics>("numbers", help)
        .param("flag", &P::flag, help)
        .param("count", &P::count, help, at_least(1), at_most(9))
        .param("seeds", &P::seeds, help)
        .param("big", &P::big, help)
        .param("weight", &P::weight, help, above(0), below(1))
        .param("label", &P::label, help)
        .param("file", &P::file, help)
        .param("size", &P::size, help, above(0))
        .param("bend", &P::bend, help, at_most(180))
        .param("share", &P::share, help)
        .choice("rule", &P::rule,
                {{"nearest", Rule::nearest, "The nearest."},
                 {"random", Rule::random, "Any of them."},
                 {"densest", Rule::densest, "The densest."}},
                help)
        .param("axis", &P::axis, help, size(3))
        .param("sizes", &P::sizes, help)
        .param("names", &P::names, help)
        .param("flags", &P::flags, help)
        .param("files", &P::files, help)
        .param("alpha", &P::alpha, help, above(0), word("auto"))
        .param("fairing", &P::fairing, help)
        .param("log", &P::log, help)
        .param("picks", &P::picks, help)
        .param("max-error", &P::max_error, help, above(0), required)
        .metric("kept", Unit::count, help, headline, numbered)
        .metric("error", Unit::length, help);
}

inline const ParameterSpec& parameter(const FilterDeclaration& declared, std::string_view name) {
    return *declared.spec.parameter(name);
}

inline ParameterValue one(ParameterScalar value) { return value; }

/// The params that a run gets from these values.
inline AllParams params_from(std::vector<std::pair<std::string, ParameterValue>> values) {
    AllParams seen;
    const FilterDeclaration declared =
        declaration().run([&](const Inputs&, const AllParams& params, Context&) { return seen = params, Outputs(); });
    Context context;
    declared.run({}, {std::move(values)}, context);
    return seen;
}

}  // namespace scanmill::test
