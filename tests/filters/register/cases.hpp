// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Views for tests of register.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <functional>
#include <string>
#include <vector>

#include "register/register_views.hpp"
#include "scanmill/base/random.hpp"

namespace scanmill::test {

struct View {
    std::string name;
    std::vector<Vec3> points;
    Vec3 to_scanner = Vec3::UnitZ();
    RigidMotion truth;  ///< from the view's frame to the world
    std::optional<RigidMotion> start{};
};

inline RigidMotion random_motion(Random& random, double shift) {
    const Eigen::Quaterniond q(random.normal(), random.normal(), random.normal(), random.normal());
    return {q.normalized().toRotationMatrix(), shift * Vec3(random.normal(), random.normal(), random.normal())};
}

/// The views with their poses thrown away: each in a random frame of its own.
inline std::vector<View> in_random_frames(std::vector<View> views, u64 seed, double shift) {
    Random random(seed);
    for (View& view : views) {
        const RigidMotion motion = random_motion(random, shift);
        for (Vec3& p : view.points) p = motion.apply(p);
        view.to_scanner = motion.turned(view.to_scanner);
        view.truth = motion.inverse().then(view.truth);
    }
    return views;
}

inline RegisterViewsResult registered(const std::vector<View>& views, const RegisterViewsParams& params = {},
                                      unsigned threads = 2) {
    std::vector<ViewToRegister> input;
    for (const View& view : views) input.push_back({view.name, view.points, view.to_scanner, view.start});
    ExecutionOptions options;
    options.threads = threads;
    Execution execution(options);
    return register_views(input, params, execution);
}

/// The root mean square distance of each placed view's points from where they belong, after one motion of all of them
/// together; negative for refused views.
inline std::vector<double> errors_of(const RegisterViewsResult& result, const std::vector<View>& views) {
    std::vector<Vec3> from, to;
    for (std::size_t i = 0; i < views.size(); ++i)
        if (result.views[i].pose)
            for (std::size_t k = 0; k < views[i].points.size(); k += 50) {
                from.push_back(result.views[i].pose->apply(views[i].points[k]));
                to.push_back(views[i].truth.apply(views[i].points[k]));
            }
    std::vector<double> errors(views.size(), -1);
    if (from.empty()) return errors;
    const RigidMotion all = fitted_motion(from, to);
    std::size_t next = 0;
    for (std::size_t i = 0; i < views.size(); ++i) {
        if (!result.views[i].pose) continue;
        double squares = 0;
        std::size_t count = 0;
        for (std::size_t k = 0; k < views[i].points.size(); k += 50, ++next, ++count)
            squares += (all.apply(from[next]) - to[next]).squaredNorm();
        errors[i] = std::sqrt(squares / static_cast<double>(count));
    }
    return errors;
}

/// A view from above of the height field over a rectangle of unit squares.
inline View height_view(std::string name, double from_x, double to_x, double from_y, double to_y,
                        const std::function<double(double, double)>& height, double noise = 0, u64 seed = 1) {
    Random random(seed);
    View view;
    view.name = std::move(name);
    for (double x = from_x; x < to_x; ++x)
        for (double y = from_y; y < to_y; ++y)
            view.points.emplace_back(x, y, height(x, y) + noise * random.normal());
    return view;
}

/// A landscape without symmetry.
inline double hills(double x, double y) {
    return 9 * std::sin(x / 13) * std::cos(y / 17) + 5 * std::sin((x + 2 * y) / 23) + 6 * std::cos((x * 0.7 - y) / 9) +
           0.0005 * x * x;
}

}  // namespace scanmill::test
