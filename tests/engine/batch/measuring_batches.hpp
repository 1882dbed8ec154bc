// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Batches with a filter that measures, declared only: compare: mesh, truth (mesh or points) → metrics.

#include "engine/batch/batch_support.hpp"
#include "scanmill/filter/declare.hpp"

namespace scanmill::test {

struct CompareParams {
    int samples = 1000;
    Length near = Length::percent_of_diagonal(1);
};

inline FilterSpec measuring_filter(const std::string& name) {
    const std::string help = "As its name says.";
    Declare<CompareParams> declaration(name, 1);
    declaration.summary("Does what its name says.")
        .source("Hand-made for tests")
        .ties("There are none.")
        .not_finite(help)
        .in<TriangleMesh>("mesh", help)
        .in<TriangleMesh, PointCloud>("truth", help)
        .out<Metrics>("metrics", help)
        .measures("mesh", "truth")
        .param("samples", &CompareParams::samples, help, at_least(1))
        .param("near", &CompareParams::near, help, above(0))
        .metric("distance", Unit::length, help, headline, smaller_is_better)
        .metric("score", Unit::ratio, help, numbered, larger_is_better)
        .metric("handles", Unit::count, help);
    return static_cast<const FilterDeclaration&>(declaration).spec;
}

/// w.yaml makes two meshes in two variants: `surface`, the workflow's output, and `light`, which is not one.
class MeasuringBatches : public Batches {
protected:
    MeasuringBatches() {
        filters_.add(measuring_filter("compare"));
        library_ = filters_.library();
        for (const char* truth : {"a.stl", "b.stl"}) folder_.write(std::string("truth/") + truth, "x");
        folder_.write("w.yaml",
                      "scanmill: 1\nname: w\ninputs: {scan: points}\nparameters: {alpha: {sweep: [1 u, 2 u]}}\nsteps:\n"
                      "  - tetrahedralise:\n  - id: surface\n    solid: {alpha: $alpha}\n"
                      "  - id: light\n    simplify: {max-error: 1 u}\n"
                      "outputs: {'{folder}/{scan}.{variant}.stl': surface}\n");
    }
    static std::string batch(const std::string& rest, const std::string& scans = "scans/*.ply") {
        return "scanmill: 1\nbatch: b\nscans: [{path: " + scans +
               ", unit: mm, truth: 'truth/{stem}.stl'}]\nworkflows: w.yaml\n" + rest;
    }
    const Plan& plan(std::size_t part = 0) const { return *checked_.parts.at(part).plan; }
    /// "label <- value at the first port", of every measuring step of the plan.
    static std::vector<std::string> measuring(const Plan& plan) {
        std::vector<std::string> found;
        for (const PlannedStep& step : plan.steps)
            if (step.spec.measures) found.push_back(step.label + " <- " + describe(plan, step.inputs[0].sources[0]));
        return found;
    }
};

}  // namespace scanmill::test
