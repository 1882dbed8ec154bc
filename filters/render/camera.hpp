// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Views of a scene: directions, projections and the rectangle of the picture that a view fills.

#include <span>
#include <string>

#include "render/render.hpp"
#include "render/scene.hpp"

namespace scanmill {

/// Part of a picture, in pixels.
struct Rectangle {
    u32 x = 0, y = 0, width = 0, height = 0;
};

/// A point's place in the picture: the column and row (a pixel's centre is at .5), and its distance from a plane: the
/// one through the eye, or in orthographic views one before the framed positions.
struct Projected {
    double x, y, depth;
};

class View {
public:
    /// An orthographic view in which all `positions` lie in `part`, with a margin. `back` points from the scene to the
    /// camera, `up` upwards. Pre: at least one position; the vectors are not parallel.
    View(std::string name, std::span<const Vec3> positions, const Vec3& back, const Vec3& up, const Rectangle& part);
    /// A perspective view from `eye` towards `target`. The shorter side of `part` spans 40 degrees.
    View(std::string name, const Vec3& eye, const Vec3& target, const Vec3& up, const Rectangle& part);

    /// The ray through a point of the picture.
    Ray ray(double x, double y) const;
    Projected project(const Vec3& position) const;
    /// Width of a pixel at this depth.
    double pixel(double depth) const { return is_perspective_ ? pixel_ * depth : pixel_; }
    bool is_perspective() const { return is_perspective_; }
    /// The least depth of a position that a perspective view shows; minus infinity in orthographic views.
    double least_depth() const { return least_depth_; }

    const std::string& name() const { return name_; }
    const Rectangle& part() const { return part_; }
    /// Unit vectors of the picture in space: to the right, upwards, towards the camera.
    const Vec3& right() const { return right_; }
    const Vec3& up() const { return up_; }
    const Vec3& back() const { return back_; }

private:
    void turn_to(const Vec3& back, const Vec3& up);
    Vec3 in_view(const Vec3& position) const;

    std::string name_;
    Rectangle part_;
    Vec3 right_, up_, back_;
    bool is_perspective_;
    Vec3 eye_;  ///< the camera, or the middle of the plane where distances begin
    double pixel_;  ///< width of a pixel; in perspective views at distance 1
    double least_depth_ = -std::numeric_limits<double>::infinity();
};

/// One view per camera of the parameters, or one from the eye; side by side in `part`, in rows. `framed` is the scene
/// that sets the camera, `caster` contains its surface or is null.
std::vector<View> views_of(const DrawnScene& framed, const RayCaster* caster, const Vec3& origin,
                           const RenderParams& params, const Rectangle& part, Context& context);

}  // namespace scanmill
