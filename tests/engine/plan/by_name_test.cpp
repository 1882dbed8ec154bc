// SPDX-License-Identifier: GPL-3.0-or-later
// Ports that only `in` connects.

#include <gmock/gmock.h>

#include "engine/batch/batch_support.hpp"
#include "engine/run/run_fixture.hpp"
#include "scanmill/filter/declare.hpp"
#include "scanmill/plan/plan.hpp"

namespace scanmill {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct NoParams {};

/// names: points, a mesh by name alone, features by name alone → numbers, the points by name alone.
class NamedPorts : public test::Batches {
protected:
    NamedPorts() {
        filters_.add(Declare<NoParams>("names", 1)
                         .summary("Takes values by name.")
                         .source("Hand-made for tests")
                         .ties("There are none.")
                         .not_finite("Nothing is asked.")
                         .in<PointCloud>("points", "As its name says.")
                         .in<TriangleMesh>("nominal", "As its name says.", by_name)
                         .in<FeatureGraph>("lines", "As its name says.", optional, by_name)
                         .out<Metrics>("numbers", "As its name says.")
                         .out_like("moved", "points", "As its name says.", by_name)
                         .
                         operator FilterDeclaration()
                         .spec);
        library_ = filters_.library();
    }
    std::vector<std::string> check_steps(const std::string& steps) {
        Diagnostics diagnostics("f/w");
        plan_ = make_plan(
            parse_workflow("scanmill: 1\ninputs: {scan: points, mesh: mesh, edges: features}\nsteps:\n" + steps,
                           diagnostics),
            library_, {}, diagnostics);
        std::vector<std::string> texts;
        for (const Diagnostic& diagnostic : diagnostics.sorted()) texts.push_back(text(diagnostic, "w"));
        return texts;
    }

    Plan plan_;
};

TEST_F(NamedPorts, RequiredInput_MustBeNamed) {
    EXPECT_THAT(check_steps("  - names:\n"),
                ElementsAre(HasSubstr("'nominal' of names takes mesh and must be named in `in`")));
}

TEST_F(NamedPorts, OptionalInput_TakesNoEarlierValueByItself) {
    EXPECT_THAT(check_steps("  - names:\n    in: {nominal: mesh}\n"), IsEmpty());
    EXPECT_EQ(plan_.steps[0].inputs.size(), 2u);
    EXPECT_THAT(check_steps("  - names:\n    in: {nominal: mesh, lines: edges}\n"), IsEmpty());
    EXPECT_EQ(plan_.steps[0].inputs.size(), 3u);
}

TEST_F(NamedPorts, OutputLikeAnInput_IsNotTakenByItself) {
    EXPECT_THAT(check_steps("  - names:\n    in: {nominal: mesh}\n  - thin:\n"), IsEmpty());
    EXPECT_FALSE(plan_.steps[1].inputs[0].sources.front().step) << "the scan";
    EXPECT_THAT(check_steps("  - names:\n    in: {nominal: mesh}\n  - thin:\n    in: names.moved\n"), IsEmpty());
    EXPECT_EQ(plan_.steps[1].inputs[0].sources.front().step, std::optional<std::size_t>(0));
}

}  // namespace
}  // namespace scanmill
