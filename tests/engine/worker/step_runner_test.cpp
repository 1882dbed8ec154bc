// SPDX-License-Identifier: GPL-3.0-or-later
// One step by itself: what becomes of lengths that the scan has no measure for.

#include "scanmill/worker/step_runner.hpp"

#include <gmock/gmock.h>

#include "scanmill/filter/declare.hpp"
#include "support/thrown.hpp"

namespace scanmill {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Reads only the lengths that `reads` names.
struct ReaderParams {
    std::string reads = "size";
    Length size = 2;
    Length tolerance = Length::percent_of_diagonal(10);
    std::vector<Length> thresholds{Length(1), Length::spacings(2)};
};

FilterDeclaration reader() {
    using P = ReaderParams;
    return Declare<P>("reader", 1)
        .in<PointCloud>("points", "A cloud.")
        .in<PointCloud>("near", "Another.", optional)
        .out<PointCloud>("points", "The same.")
        .param("reads", &P::reads, "The lengths that are read.")
        .param("size", &P::size, "A length.")
        .param("tolerance", &P::tolerance, "A length.", above(0))
        .param("thresholds", &P::thresholds, "Lengths.")
        .metric("sum", Unit::length, "Of what was read.")
        .run([](const Inputs& inputs, const P& params, Context& context) {
            double sum = 0;
            if (params.reads.find("size") != std::string::npos) sum += params.size.value();
            if (params.reads.find("tolerance") != std::string::npos) sum += params.tolerance.value();
            if (params.reads.find("thresholds") != std::string::npos)
                for (const Length& threshold : params.thresholds) sum += threshold.value();
            if (params.reads == "nothing") throw Error("nothing to read").hint("read something");
            context.metric("sum", sum, Unit::length);
            if (params.reads == "doubt") context.doubt("far too small");
            return Outputs().set("points", inputs.get<PointCloud>("points"));
        });
}

class ReaderStep : public testing::Test {
protected:
    ReaderStep() {
        step_.spec = filter_.spec;
        for (const ParameterSpec& spec : filter_.spec.parameters)
            step_.parameters.values.emplace_back(spec.name, spec.default_value);
    }
    ParameterSpec& spec(const std::string& name) {
        return *std::ranges::find(step_.spec.parameters, name, &ParameterSpec::name);
    }
    void set(const std::string& name, ParameterScalar value) {
        for (auto& [key, known] : step_.parameters.values)
            if (key == name) known = std::move(value);
    }
    double sum_over(const std::vector<Vec3>& positions) {
        PointCloud cloud;
        cloud.positions = Array<Vec3>(positions.begin(), positions.end());
        const Value value = std::make_shared<const PointCloud>(std::move(cloud));
        return sum_of({{"points", value}});
    }
    double sum_of(const std::vector<StepInput>& inputs) {
        report_ = {};
        run_step(
            step_, [&]() -> const FilterDeclaration& { return filter_; }, inputs, {},
            [](const ParameterSet&, NodeReport&) { return std::nullopt; }, report_);
        return report_.metrics.find("sum")->value;
    }
    Error refusal(const std::vector<Vec3>& positions) {
        return test::error_of([&] { sum_over(positions); });
    }

    const std::vector<Vec3> one_place_{Vec3(1, 2, 3), Vec3(1, 2, 3)};
    FilterDeclaration filter_ = reader();
    PlannedStep step_;
    NodeReport report_;
};

TEST_F(ReaderStep, ADoubtOfAFilterThatDeclaresNone_IsAFault) {
    set("reads", std::string("doubt"));
    try {
        sum_over(one_place_);
        ADD_FAILURE() << "nothing was thrown";
    } catch (const std::exception& fault) {
        EXPECT_THAT(fault.what(),
                    HasSubstr("the filter reader doubts its result (far too small), but declares no doubts"));
    }
    step_.spec.doubts = {"the result is too small"};
    sum_over(one_place_);
    EXPECT_EQ(report_.doubts.front().text, "far too small");
}

TEST_F(ReaderStep, Lengths_AreResolved) {
    set("reads", std::string("size tolerance thresholds"));
    EXPECT_DOUBLE_EQ(sum_over({Vec3(0, 0, 0), Vec3(3, 4, 0)}), 2 + 0.5 + 1 + 10);
}

TEST_F(ReaderStep, DefaultWithoutAMeasure_IsNotMissedWhereItIsNotRead) {
    EXPECT_EQ(sum_over(one_place_), 2);
    EXPECT_EQ(sum_over({Vec3(1, 2, 3)}), 2);
    EXPECT_EQ(text(*report_.resolved.find("tolerance")), "10 %diag") << "as it is declared";
    EXPECT_EQ(text(*report_.resolved.find("size")), "2 u");
}

TEST_F(ReaderStep, DefaultWithoutAMeasure_IsRefusedWhereItIsReadForItsOwnReason) {
    set("reads", std::string("tolerance"));
    const Error tolerance = refusal(one_place_);
    EXPECT_THAT(tolerance.sentence(), HasSubstr("the diagonal is 0, because all 2 points are at one position"));
    EXPECT_THAT(tolerance.frames(), ElementsAre("in the parameter 'tolerance'"));
    set("reads", std::string("thresholds"));
    const Error thresholds = refusal(one_place_);
    EXPECT_EQ(thresholds.sentence(), "2 spacing cannot be resolved: the scan's point spacing is 0");
    EXPECT_THAT(thresholds.frames(), ElementsAre("in the parameter 'thresholds'"));
    EXPECT_THAT(thresholds.hint(), HasSubstr("in the scan's unit"));
}

TEST_F(ReaderStep, DefaultThatIsNotUsed_IsNotResolved) {
    const std::vector<Vec3> points{Vec3(0, 0, 0), Vec3(3, 4, 0)};
    spec("tolerance").unless_given = "size";
    sum_over(points);
    EXPECT_EQ(text(*report_.resolved.find("tolerance")), "10 %diag") << "as it is declared";
    set("tolerance", Length::percent_of_diagonal(5));
    sum_over(points);
    EXPECT_EQ(text(*report_.resolved.find("tolerance")), "0.25 u");
}

TEST_F(ReaderStep, Spacings_ReachAFilterThatTakesThem) {
    const std::vector<Vec3> points{Vec3(0, 0, 0), Vec3(3, 4, 0)};
    spec("tolerance").takes_spacings = true;
    set("tolerance", Length::spacings(3));
    sum_over(points);
    EXPECT_EQ(text(*report_.resolved.find("tolerance")), "3 spacing");
    set("tolerance", Length::percent_of_diagonal(5));
    sum_over(points);
    EXPECT_EQ(text(*report_.resolved.find("tolerance")), "0.25 u");
}

TEST_F(ReaderStep, OtherRefusals_AreNotTakenForOnesOfADefault) {
    set("reads", std::string("nothing"));
    const Error error = refusal(one_place_);
    EXPECT_EQ(error.sentence(), "nothing to read");
    EXPECT_EQ(error.hint(), "read something");
}

TEST_F(ReaderStep, ChosenLengthWithoutAMeasure_IsRefusedThoughItIsNotRead) {
    set("tolerance", Length::percent_of_diagonal(5));
    EXPECT_THAT(refusal(one_place_).frames(), ElementsAre("in the parameter 'tolerance'"));
    set("tolerance", Length(1, Length::In::millimetre));
    EXPECT_THAT(refusal(one_place_).sentence(), HasSubstr("needs a scan of known unit"));
}

TEST_F(ReaderStep, RelativeLengths_ReferToTheFirstInputWithPositions) {
    const auto cloud = [](Array<Vec3> positions) {
        PointCloud points;
        points.positions = std::move(positions);
        return Value(std::make_shared<const PointCloud>(std::move(points)));
    };
    set("reads", std::string("tolerance"));
    const Value empty = cloud({}), large = cloud({Vec3(0, 0, 0), Vec3(3, 4, 0)}),
                small = cloud({Vec3(), Vec3(1, 0, 0)});
    EXPECT_DOUBLE_EQ(sum_of({{"near", empty}, {"points", large}}), 0.5);
    EXPECT_DOUBLE_EQ(sum_of({{"points", small}, {"near", large}}), 0.1);
    EXPECT_THAT(test::error_of([&] {
                    sum_of({{"near", empty}, {"points", empty}});
                }).sentence(),
                HasSubstr("10 %diag cannot be resolved"));
}

TEST_F(ReaderStep, Lengths_HaveTheUnitOfTheOnlyInputThatDeclaresOne) {
    PointCloud cloud;
    cloud.positions = Array<Vec3>(one_place_.begin(), one_place_.end());
    const Value without_unit = std::make_shared<const PointCloud>(cloud);
    cloud.frame.unit = LengthUnit::millimetre;
    const Value with_unit = std::make_shared<const PointCloud>(cloud);
    set("size", Length(3, Length::In::centimetre));
    EXPECT_EQ(sum_of({{"points", with_unit}, {"near", without_unit}}), 30);
    EXPECT_EQ(sum_of({{"points", without_unit}, {"near", with_unit}}), 30);
}

TEST_F(ReaderStep, Metrics_HaveTheUnitOfTheInputs) {
    PointCloud cloud;
    cloud.positions = Array<Vec3>(one_place_.begin(), one_place_.end());
    const Value without_unit = std::make_shared<const PointCloud>(cloud);
    sum_of({{"points", without_unit}});
    EXPECT_EQ(report_.metrics.unit, LengthUnit::unknown);
    cloud.frame.unit = LengthUnit::millimetre;
    const Value with_unit = std::make_shared<const PointCloud>(cloud);
    sum_of({{"points", with_unit}});
    EXPECT_EQ(report_.metrics.unit, LengthUnit::millimetre);
    set("reads", std::string("nothing"));
    EXPECT_THROW(sum_of({{"points", with_unit}}), Error);
    EXPECT_EQ(report_.metrics.unit, LengthUnit::millimetre) << "of a step that fails";
    report_ = {};
    const std::vector<StepInput> inputs{{"points", with_unit}};
    run_step(
        step_, [&]() -> const FilterDeclaration& { return filter_; }, inputs, {},
        [&](const ParameterSet&, NodeReport& report) {
            report.metrics = {{{"sum", 2, Unit::length}}};
            return Outputs().set("points", with_unit);
        },
        report_);
    EXPECT_EQ(report_.metrics.unit, LengthUnit::millimetre) << "of a cached result that lacks the unit";
    EXPECT_EQ(report_.metrics.find("sum")->value, 2);
}

}  // namespace
}  // namespace scanmill
