// SPDX-License-Identifier: GPL-3.0-or-later
/// a-patch, tessellate and patch-distance stop soon after they are cancelled, at every point where they check.

#include <gtest/gtest.h>

#include "filters/a_patch/cases.hpp"
#include "patch_distance/patch_distance.hpp"
#include "tessellate/tessellate.hpp"

namespace scanmill::test {
namespace {

/// How often the action asks whether it is cancelled. A single thread asks equally often every time.
template <class Action>
int questions_of(Action&& action) {
    int asked = 0;
    ContextOptions options;
    options.threads = 1;
    options.is_cancelled = [&] { return ++asked, false; };
    Context context(options);
    action(context);
    return asked;
}

template <class Action>
void expect_cancellable(Action&& action) {
    const int questions = questions_of(action);
    ASSERT_GT(questions, 2);
    for (const int last : {1, questions / 2, questions}) {
        int asked = 0;
        ContextOptions options;
        options.threads = 1;
        options.is_cancelled = [&] { return ++asked >= last; };
        Context context(options);
        EXPECT_THROW(action(context), Cancelled) << last << " of " << questions;
        EXPECT_LE(asked, last + 1);
    }
}

TEST(Patches, WhenCancelled_StopBeingMade) {
    expect_cancellable([mesh = exact_sphere(12)](Context& context) { a_patch(mesh, nullptr, {}, context); });
}

TEST(Patches, WhenCancelled_StopBeingTessellated) {
    expect_cancellable(
        [patches = patched(exact_sphere(12)).result.patches](Context& context) { tessellate(patches, {}, context); });
}

TEST(Patches, WhenCancelled_StopBeingMeasured) {
    PointCloud points;
    points.positions = geodesic_sphere(1.01, 20).positions;
    expect_cancellable([&, patches = patched(exact_sphere(4)).result.patches](Context& context) {
        patch_distance(patches, points, context);
    });
}

}  // namespace
}  // namespace scanmill::test
