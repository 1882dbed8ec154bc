// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/camera.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "scanmill/base/elementary.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/spatial/direction.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill {

namespace {

constexpr double margin = 0.05;  // of a view's sides

/// Rows of pixels in the silhouettes that are compared.
constexpr u32 silhouette_rows = 64;
constexpr std::array<double, 3> elevations{15, 30, 50};  // in degrees
constexpr int azimuths = 24;
constexpr double weight_of_back = 0.25, clearly_larger = 1.02;

Vec3 axis_of(UpAxis up) { return up == UpAxis::x ? Vec3::UnitX() : up == UpAxis::y ? Vec3::UnitY() : Vec3::UnitZ(); }

/// The direction from the scene to a camera in front of it: as in drawings, from -y if z is up and from +z if y is up.
Vec3 front_of(UpAxis up) { return up == UpAxis::z ? Vec3(-Vec3::UnitY()) : Vec3(Vec3::UnitZ()); }

/// The share of the surface, or of the points, that is a flat base at the low end of an axis.
double base_share(const DrawnScene& scene, int axis) {
    constexpr double near_end = 0.02, downwards = -0.94;
    BoundingBox box;
    for (const Triangle& triangle : scene.mesh.triangles)
        for (const u32 vertex : triangle) box.add(scene.mesh.positions[vertex]);
    for (const Disc& disc : scene.discs) box.add(disc.centre);
    const double limit = box.low[axis] + near_end * (box.high[axis] - box.low[axis]);
    double base = 0, all = 0;
    for (const auto& [a, b, c] : scene.mesh.triangles) {
        const Vec3 &pa = scene.mesh.positions[a], &pb = scene.mesh.positions[b], &pc = scene.mesh.positions[c];
        const Vec3 normal = area_vector(pa, pb, pc);
        const double area = normal.norm();
        all += area;
        if (std::max({pa[axis], pb[axis], pc[axis]}) <= limit && normal[axis] <= downwards * area) base += area;
    }
    for (const Disc& disc : scene.discs) {
        all += 1;
        if (disc.centre[axis] <= limit) base += 1;
    }
    return all > 0 ? base / all : 0;
}

UpAxis up_axis(const DrawnScene& scene, UpAxis wanted) {
    if (wanted != UpAxis::automatic) return wanted;
    constexpr double clearly = 1.5, least = 0.02;
    const double z = base_share(scene, 2), y = base_share(scene, 1), x = base_share(scene, 0);
    if (y >= least && y > clearly * z && y >= x) return UpAxis::y;
    if (x >= least && x > clearly * z && x > y) return UpAxis::x;
    return UpAxis::z;
}

/// The direction with this azimuth, counter-clockwise from the front seen from above, and elevation, in degrees.
Vec3 direction_at(double azimuth, double elevation, UpAxis up) {
    constexpr double radian = std::numbers::pi / 180;
    const Vec3 axis = axis_of(up), front = front_of(up), side = axis.cross(front);
    const elementary::Turn around = elementary::turn_of((azimuth > 180 ? azimuth - 360 : azimuth) * radian),
                           above = elementary::turn_of(elevation * radian);
    return above.cosine * (around.cosine * front + around.sine * side) + above.sine * axis;
}

/// Visible area of the scene seen from `back`, in units that depend on the scene only.
double silhouette(const RayCaster& caster, const Vec3& back, const Vec3& up) {
    const Vec3 right = up.cross(back).normalized(), above = back.cross(right);
    double seen = 0;
    for (u32 row = 0; row < silhouette_rows; ++row)
        for (u32 column = 0; column < silhouette_rows; ++column) {
            const auto offset = [&](u32 i) { return caster.radius() * (2 * (i + 0.5) / silhouette_rows - 1); };
            const Ray ray{caster.centre() + offset(column) * right + offset(row) * above + 2 * caster.radius() * back,
                          -back};
            if (const RayHit hit = caster.first(ray); hit.found())
                seen += caster.faces(hit.item, ray) ? 1 : weight_of_back;
        }
    return seen;
}

Vec3 automatic_direction(const RayCaster* caster, UpAxis up, Context& context) {
    if (!caster) return direction_at(30, elevations[1], up);
    std::vector<Vec3> directions;
    for (const double elevation : elevations)
        for (int i = 0; i < azimuths; ++i) directions.push_back(direction_at(i * 360.0 / azimuths, elevation, up));
    std::vector<double> areas(directions.size());
    for_each_chunk(context.threads(), directions.size(), 1, [&](std::size_t i, std::size_t) {
        context.check_cancelled();
        areas[i] = silhouette(*caster, directions[i], axis_of(up));
    });
    std::size_t best = 0;
    for (std::size_t i = 1; i < areas.size(); ++i)
        if (areas[i] > clearly_larger * areas[best]) best = i;
    return directions[best];
}

/// The direction to the camera, and the direction that is up in the picture.
std::array<Vec3, 2> directions_of(CameraView view, UpAxis up, const RayCaster* caster, Context& context) {
    const Vec3 axis = axis_of(up), front = front_of(up), side = axis.cross(front);
    switch (view) {
        case CameraView::front: return {front, axis};
        case CameraView::back: return {-front, axis};
        case CameraView::left: return {-side, axis};
        case CameraView::right: return {side, axis};
        case CameraView::top: return {axis, -front};
        case CameraView::bottom: return {-axis, front};
        case CameraView::automatic: break;
    }
    return {automatic_direction(caster, up, context), axis};
}

std::string name_of(CameraView view) {
    constexpr std::array<const char*, 7> names{"auto", "front", "back", "left", "right", "top", "bottom"};
    return names[static_cast<std::size_t>(view)];
}

/// The rectangles of `count` views, in rows that are as square as possible.
std::vector<Rectangle> parts_of(const Rectangle& whole, std::size_t count) {
    std::size_t columns = 1;
    while (columns * columns < count) ++columns;
    if (count == 2 && whole.height > whole.width) columns = 1;
    const std::size_t rows = (count + columns - 1) / columns;
    std::vector<Rectangle> parts;
    for (std::size_t i = 0; i < count; ++i) {
        const auto edge = [](u32 length, std::size_t at, std::size_t of) { return static_cast<u32>(length * at / of); };
        const std::size_t column = i % columns, row = i / columns;
        const u32 x = edge(whole.width, column, columns), y = edge(whole.height, row, rows);
        parts.push_back({whole.x + x, whole.y + y, edge(whole.width, column + 1, columns) - x,
                         edge(whole.height, row + 1, rows) - y});
    }
    return parts;
}

View from_eye(const DrawnScene& framed, const Vec3& origin, UpAxis up, const RenderParams& params,
              const Rectangle& part) {
    const BoundingBox box = bounding_box(framed.extent());
    const Vec3 eye = position_of(*params.eye, "eye") - origin;
    const Vec3 target =
        params.look_at ? Vec3(position_of(*params.look_at, "look-at") - origin) : Vec3((box.low + box.high) / 2);
    const Vec3 back = eye - target;
    if (!(back.norm() > 0))
        throw Error("the eye and the point that it looks at are the same").hint("give `eye` or `look-at` elsewhere");
    // A view along the up axis has the front upwards.
    const bool is_vertical = axis_of(up).cross(back.normalized()).norm() < 1e-6;
    return {"eye", eye, target, is_vertical ? front_of(up) : axis_of(up), part};
}

}  // namespace

View::View(std::string name, std::span<const Vec3> positions, const Vec3& back, const Vec3& up, const Rectangle& part)
    : name_(std::move(name)),
      part_(part),
      is_perspective_(false) {
    turn_to(back, up);
    BoundingBox box;
    for (const Vec3& position : positions) box.add({right_.dot(position), up_.dot(position), back_.dot(position)});
    const Vec3 size = box.high - box.low;
    pixel_ = std::max(size.x() / part.width, size.y() / part.height) / (1 - 2 * margin);
    if (!(pixel_ > 0)) pixel_ = 1;  // a single position
    const double before = std::max(size.norm(), pixel_);
    const Vec3 middle = (box.low + box.high) / 2;
    eye_ = middle.x() * right_ + middle.y() * up_ + (box.high.z() + before) * back_;
}

View::View(std::string name, const Vec3& eye, const Vec3& target, const Vec3& up, const Rectangle& part)
    : name_(std::move(name)),
      part_(part),
      is_perspective_(true),
      eye_(eye) {
    constexpr double half_angle_tangent = 0.36397023426620234;  // of 20 degrees
    turn_to(eye - target, up);
    pixel_ = 2 * half_angle_tangent / std::min(part.width, part.height);
    least_depth_ = 1e-6 * (eye - target).norm();
}

void View::turn_to(const Vec3& back, const Vec3& up) {
    back_ = back.normalized();
    right_ = up.cross(back_).normalized();
    up_ = back_.cross(right_);
}

Ray View::ray(double x, double y) const {
    const double to_right = (x - part_.x - part_.width / 2.0) * pixel_,
                 upwards = (part_.y + part_.height / 2.0 - y) * pixel_;
    if (is_perspective_) return {eye_, (to_right * right_ + upwards * up_ - back_).normalized()};
    // What lies before the framed positions is seen, too.
    return {eye_ + to_right * right_ + upwards * up_, -back_, -std::numeric_limits<double>::infinity()};
}

Projected View::project(const Vec3& position) const {
    const Vec3 offset = position - eye_;
    const double along = -back_.dot(offset);
    const double scale = 1 / pixel(is_perspective_ ? along : 1);
    return {part_.x + part_.width / 2.0 + right_.dot(offset) * scale,
            part_.y + part_.height / 2.0 - up_.dot(offset) * scale, along};
}

std::vector<View> views_of(const DrawnScene& framed, const RayCaster* caster, const Vec3& origin,
                           const RenderParams& params, const Rectangle& part, Context& context) {
    if (params.look_at && !params.eye) throw Error("`look-at` needs an `eye`").hint("give both, or choose a `camera`");
    const UpAxis up = up_axis(framed, params.up);
    if (params.eye && params.camera != RenderParams().camera)
        throw Error("`eye` and `camera` are two ways to set the view").hint("leave one of them out");
    if (params.eye) return {from_eye(framed, origin, up, params, part)};
    if (params.camera.empty()) throw Error("`camera` is empty").hint("name at least one camera, as [auto]");
    const std::vector<Rectangle> parts = parts_of(part, params.camera.size());
    const Array<Vec3> extent = framed.extent();
    std::vector<View> views;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const auto [back, above] = directions_of(params.camera[i], up, caster, context);
        views.emplace_back(name_of(params.camera[i]), extent, back, above, parts[i]);
    }
    return views;
}

}  // namespace scanmill
