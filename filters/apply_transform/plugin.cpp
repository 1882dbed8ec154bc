// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "apply_transform/apply_transform.hpp"

using namespace scanmill;

namespace {

struct ApplyTransformParams {};

/// The value wired to `value`, which is of one of the kinds.
template <class... Kinds>
struct ValueOf {
    static Value at(const Inputs& inputs) {
        Value value;
        ((inputs.find<Kinds>("value") ? void(value = inputs.list<Kinds>("value").front()) : void()), ...);
        return value;
    }
    static Declare<ApplyTransformParams>& declare(Declare<ApplyTransformParams>& filter) {
        return filter.in<Kinds...>("value", "The value that is moved; only positions and directions change.");
    }
};
/// Every kind with positions.
using Geometry = ValueOf<PointCloud, TriangleMesh, TetMesh, FeatureGraph, PatchComplex, ProbePlan>;

Declare<ApplyTransformParams> declaration() {
    Declare<ApplyTransformParams> filter("apply-transform", 1);
    filter.summary("Moves points, a mesh or anything else with positions into another frame.")
        .source("Wang 2006, chapter 5")
        .ties("None: every position is moved independently.")
        .not_finite("They are carried along; NaN stays NaN.")
        .in<Transforms>("transform",
                        "The motion from the frame of the value to another frame, or a list with this motion.")
        .made_by("align");
    return Geometry::declare(filter)
        .out_like("value", "value", "The value in the target frame of the transform.")
        .run([](const Inputs& inputs, const ApplyTransformParams&, Context& context) {
            return Outputs().set("value",
                                 apply_transform(Geometry::at(inputs), inputs.get<Transforms>("transform"), context));
        });
}

}  // namespace

SCANMILL_FILTER() { return declaration(); }
