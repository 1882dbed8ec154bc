// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/shading.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <atomic>
#include <cmath>

#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
using Light = Eigen::Array3d;

// Colours are mixed as light: the square of the picture's numbers, which is near enough to sRGB and needs no power.
Light light_of(const Colour& colour) {
    const Light numbers(colour[0], colour[1], colour[2]);
    return (numbers / 255).square();
}

constexpr Colour clay = {226, 219, 204}, clay_from_behind = {120, 144, 176}, crossing = {200, 30, 140},
                 wire = {60, 60, 60}, dark_band = {40, 40, 44}, bright_band = {244, 244, 240};

/// Lights of plain surfaces: from everywhere, from the upper left, and from the camera.
constexpr double everywhere = 0.20, upper_left = 0.62, from_camera = 0.32;
/// Surfaces that show values have light from the camera only, so that a face towards the camera has the legend's
/// colour.
constexpr double least_light_of_values = 0.75;
/// Share of light that ambient occlusion can take away.
constexpr double occlusion_of_plain = 0.75, occlusion_of_values = 0.25;

/// Reflected bands over the sphere of directions.
constexpr double bands = 9;

constexpr int occlusion_rays = 8, pattern_side = 4;
constexpr double occlusion_reach = 0.4;  // in radii of the scene
constexpr double surface_offset = 1e-4;  // in radii; rays from a surface start here

/// Directions over the upper half of the unit sphere, more of them near the pole, as light from everywhere arrives.
/// Neighbouring pixels use different directions.
class OcclusionDirections {
public:
    OcclusionDirections() {
        constexpr int count = occlusion_rays * pattern_side * pattern_side;
        // Points of a spiral with the golden angle; turning by it is a product with this unit vector.
        constexpr double cosine = -0.7373688780783197, sine = 0.6754902942615238;
        double x = 1, y = 0;
        for (int i = 0; i < count; ++i) {
            const double squared_radius = (i + 0.5) / count, radius = std::sqrt(squared_radius);
            // The rays of one pixel are every sixteenth of the spiral.
            directions_[static_cast<std::size_t>(i)] = {radius * x, radius * y, std::sqrt(1 - squared_radius)};
            const double turned = x * cosine - y * sine;
            y = x * sine + y * cosine;
            x = turned;
        }
    }
    const Vec3& of(u32 x, u32 y, int ray) const {
        // An order in which neighbours in a 4 x 4 block are far apart on the spiral.
        constexpr std::array<int, 16> order{0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
        const int cell = order[(y % pattern_side) * pattern_side + x % pattern_side];
        return directions_[static_cast<std::size_t>(ray * pattern_side * pattern_side + cell)];
    }

private:
    std::array<Vec3, static_cast<std::size_t>(occlusion_rays) * pattern_side * pattern_side> directions_;
};

/// What a pixel shows of the surface.
struct Pixel {
    std::array<float, 3> light{};  ///< sum over the samples that hit
    std::array<float, 3> normal{};  ///< at the first sample that hits, towards the camera; zero if not known yet
    float depth = 0;  ///< at the first sample that hits
    float open = 1;  ///< share of the directions that are not occluded
    u8 hits = 0, first = 0;
    bool is_value = false;
};

class Shader {
public:
    Shader(const View& view, const DrawnScene& scene, const RayCaster& caster, const SurfaceNormals* normals,
           const RenderParams& params, Context& context, const std::array<double, 2>& progress)
        : view_(view),
          scene_(scene),
          caster_(caster),
          normals_(normals),
          params_(params),
          context_(context),
          progress_(progress),
          side_(params.style == RenderParams::Style::lines ? 3 : 2),
          key_((-0.5 * view.right() + 0.6 * view.up() + 0.6 * view.back()).normalized()) {}

    DepthMap draw(Canvas& canvas) {
        const Rectangle& part = view_.part();
        pixels_.resize(std::size_t(part.width) * part.height);
        depths_.samples_per_side = side_;
        depths_.depths.assign(pixels_.size() * side_ * side_, std::numeric_limits<float>::infinity());
        for_each_row([&](u32 row) { cast(row); });
        const bool estimates_normals = !scene_.discs.empty();
        if (estimates_normals) {
            const Array<Pixel> before = pixels_;
            for_each_row([&](u32 row) { estimate_normals(row, before); });
        }
        for_each_row([&](u32 row) { find_occlusion(row); });
        for (u32 row = 0; row < part.height; ++row) compose(row, canvas);
        return std::move(depths_);
    }

private:
    template <class Action>
    void for_each_row(const Action& action) {
        for_each_chunk(context_.threads(), view_.part().height, 4, [&](std::size_t begin, std::size_t end) {
            context_.check_cancelled();
            for (std::size_t row = begin; row < end; ++row) action(static_cast<u32>(row));
            constexpr double passes = 3;
            const double done = static_cast<double>(rows_done_ += end - begin) / (passes * view_.part().height);
            context_.progress(progress_[0] + (progress_[1] - progress_[0]) * done);
        });
    }

    Pixel& at(u32 column, u32 row) { return pixels_[std::size_t(row) * view_.part().width + column]; }

    Ray ray_of(u32 column, u32 row, u32 sample) const {
        return view_.ray(view_.part().x + column + (sample % side_ + 0.5) / side_,
                         view_.part().y + row + (sample / side_ + 0.5) / side_);
    }

    void cast(u32 row) {
        for (u32 column = 0; column < view_.part().width; ++column) {
            Pixel& pixel = at(column, row);
            pixel = {};
            Light sum = Light::Zero();
            for (u32 sample = 0; sample < side_ * side_; ++sample) {
                const Ray ray = ray_of(column, row, sample);
                const RayHit hit = caster_.first(ray);
                if (!hit.found()) continue;
                const double depth = hit.distance * -view_.back().dot(ray.direction);
                depths_.depths[(std::size_t(row) * view_.part().width + column) * side_ * side_ + sample] =
                    static_cast<float>(depth);
                const bool is_front = caster_.faces(hit.item, ray);
                const Vec3 normal = normal_at(hit, ray);
                sum += shown(hit, ray, normal, is_front, depth);
                if (pixel.hits++ > 0) continue;
                pixel.first = static_cast<u8>(sample);
                pixel.depth = static_cast<float>(depth);
                for (std::size_t i = 0; i < 3; ++i)
                    pixel.normal[i] = static_cast<float>(normal[static_cast<Eigen::Index>(i)]);
                pixel.is_value = scene_.column && !is_crossing(hit);
            }
            for (std::size_t i = 0; i < 3; ++i) pixel.light[i] = static_cast<float>(sum[static_cast<Eigen::Index>(i)]);
        }
    }

    /// Towards the camera; zero for discs without a normal.
    Vec3 normal_at(const RayHit& hit, const Ray& ray) const {
        const bool is_triangle = hit.item < caster_.triangles();
        Vec3 normal =
            is_triangle ? normals_->at(hit.item, hit.weights) : scene_.discs[hit.item - caster_.triangles()].normal;
        // The facet decides which side is seen; an averaged normal beside a silhouette may point away.
        const Vec3 facing = is_triangle ? normals_->facet(hit.item) : normal;
        if (facing.dot(ray.direction) > 0) normal = -normal;
        return normal;
    }

    bool is_crossing(const RayHit& hit) const {
        return !scene_.intersecting.empty() && hit.item < caster_.triangles() && scene_.intersecting[hit.item];
    }

    /// The surface's own colour at a hit.
    Light colour_at(const RayHit& hit, bool is_front) const {
        if (is_crossing(hit)) return light_of(crossing);
        if (!scene_.column) return light_of(is_front ? clay : clay_from_behind);
        const DrawnColumn& column = *scene_.column;
        const bool is_triangle = hit.item < caster_.triangles();
        const u32 row = is_triangle ? hit.item : scene_.disc_rows[hit.item - caster_.triangles()];
        if (!is_triangle || column.by_face)
            return light_of(column.colours.empty() ? colour_of(column.scale, column.values[row]) : column.colours[row]);
        const Triangle& corners = scene_.mesh.triangles[row];
        if (!column.colours.empty()) {
            Light light = Light::Zero();
            for (std::size_t i = 0; i < 3; ++i) light += hit.weights[i] * light_of(column.colours[corners[i]]);
            return light;
        }
        double value = 0;
        for (std::size_t i = 0; i < 3; ++i) value += hit.weights[i] * column.values[corners[i]];
        return light_of(colour_of(column.scale, value));
    }

    /// Colour and light of a hit, without occlusion. Without a normal, only the colour.
    Light shown(const RayHit& hit, const Ray& ray, const Vec3& normal, bool is_front, double depth) const {
        if (params_.edges && hit.item < caster_.triangles() && is_at_edge(hit, ray, depth)) return light_of(wire);
        if (normal == Vec3::Zero()) return colour_at(hit, is_front);
        if (params_.style == RenderParams::Style::lines && hit.item < caster_.triangles()) return band(normal, ray);
        const bool is_value = scene_.column && !is_crossing(hit);
        return colour_at(hit, is_front) * lighting(normal, ray.direction, is_value);
    }

    double lighting(const Vec3& normal, const Vec3& direction, bool is_value) const {
        const double facing = std::max(0.0, -normal.dot(direction));
        if (is_value) return least_light_of_values + (1 - least_light_of_values) * facing;
        return everywhere + upper_left * std::max(0.0, normal.dot(key_)) + from_camera * facing;
    }

    /// The band that the surface reflects.
    Light band(const Vec3& normal, const Ray& ray) const {
        const Vec3 reflected = ray.direction - 2 * normal.dot(ray.direction) * normal;
        const double place = bands * reflected.dot(view_.up());
        const bool is_dark = place - std::floor(place) < 0.5;
        constexpr double least = 0.6;
        return light_of(is_dark ? dark_band : bright_band) *
               (least + (1 - least) * std::max(0.0, -normal.dot(ray.direction)));
    }

    /// Whether the hit is within a third of a pixel of an edge of its triangle, in the picture.
    bool is_at_edge(const RayHit& hit, const Ray& ray, double depth) const {
        const Triangle& corners = scene_.mesh.triangles[hit.item];
        const Vec3 place = ray.origin + hit.distance * ray.direction;
        const double width = 0.35 * view_.pixel(depth);
        for (std::size_t i = 0; i < 3; ++i) {
            const auto seen = [&](const Vec3& position) {
                const Vec3 offset = position - place;
                return Eigen::Vector2d(view_.right().dot(offset), view_.up().dot(offset));
            };
            const Eigen::Vector2d a = seen(scene_.mesh.positions[corners[i]]),
                                  b = seen(scene_.mesh.positions[corners[(i + 1) % 3]]);
            const double twice_area = std::abs(a.x() * b.y() - a.y() * b.x());
            if (twice_area <= width * (b - a).norm()) return true;
        }
        return false;
    }

    /// The normal of a plane through the depths around every pixel that has none.
    void estimate_normals(u32 row, const Array<Pixel>& before) {
        constexpr std::int64_t reach = 3;
        const Rectangle& part = view_.part();
        for (u32 column = 0; column < part.width; ++column) {
            Pixel& pixel = at(column, row);
            if (pixel.hits == 0 || pixel.normal != std::array<float, 3>{}) continue;
            const double width = view_.pixel(pixel.depth);
            const double nearby = std::max(3 * width, scene_.disc_radius) * 2;
            Eigen::Matrix3d sums = Eigen::Matrix3d::Zero();
            Vec3 right_side = Vec3::Zero();
            for (std::int64_t dy = -reach; dy <= reach; ++dy)
                for (std::int64_t dx = -reach; dx <= reach; ++dx) {
                    const std::int64_t x = column + dx, y = row + dy;
                    if (x < 0 || y < 0 || x >= part.width || y >= part.height) continue;
                    const Pixel& other = before[static_cast<std::size_t>(y) * part.width + static_cast<std::size_t>(x)];
                    if (other.hits == 0 || std::abs(double(other.depth) - pixel.depth) > nearby) continue;
                    const Vec3 place(static_cast<double>(dx), static_cast<double>(dy), 1);
                    sums += place * place.transpose();
                    right_side += place * ((double(other.depth) - pixel.depth) / width);
                }
            Vec3 slopes = Vec3::Zero();
            if (std::abs(sums.determinant()) > 1e-6) slopes = sums.ldlt().solve(right_side);
            // Depth grows away from the camera, rows of pixels grow downwards.
            const Vec3 normal = (slopes.x() * view_.right() - slopes.y() * view_.up() + view_.back()).normalized();
            const Ray ray = ray_of(column, row, pixel.first);
            const double light = lighting(normal, ray.direction, pixel.is_value);
            for (std::size_t i = 0; i < 3; ++i) {
                pixel.normal[i] = static_cast<float>(normal[static_cast<Eigen::Index>(i)]);
                pixel.light[i] = static_cast<float>(pixel.light[i] * light);
            }
        }
    }

    void find_occlusion(u32 row) {
        for (u32 column = 0; column < view_.part().width; ++column) {
            Pixel& pixel = at(column, row);
            if (pixel.hits == 0) continue;
            const Ray ray = ray_of(column, row, pixel.first);
            const Vec3 place = ray.origin + pixel.depth / -view_.back().dot(ray.direction) * ray.direction;
            const Vec3 normal = Vec3(pixel.normal[0], pixel.normal[1], pixel.normal[2]).normalized();
            const auto [one, other] = directions_across(normal);
            // A float's depth errs; a disc lies beside its neighbours, not on them.
            const double disc = scene_.disc_radius;
            const double offset = surface_offset * caster_.radius() + 1e-6 * pixel.depth + 2 * disc;
            int open = 0;
            for (int i = 0; i < occlusion_rays; ++i) {
                const Vec3& sample = directions_.of(column, row, i);
                const Vec3 direction = sample.x() * one + sample.y() * other + sample.z() * normal;
                open += !caster_.is_blocked({place + offset * normal, direction.normalized()},
                                            occlusion_reach * caster_.radius());
            }
            pixel.open = static_cast<float>(open) / occlusion_rays;
        }
    }

    /// The mean of the open shares in a 4 x 4 block of pixels on the same surface.
    double smoothed_open(u32 column, u32 row) {
        const Pixel& pixel = at(column, row);
        const double nearby = 6 * view_.pixel(pixel.depth) + 1e-6 * pixel.depth + 2 * scene_.disc_radius;
        double sum = 0, weight = 0;
        for (int dy = -2; dy < 2; ++dy)
            for (int dx = -2; dx < 2; ++dx) {
                const std::int64_t x = std::int64_t(column) + dx, y = std::int64_t(row) + dy;
                if (x < 0 || y < 0 || x >= view_.part().width || y >= view_.part().height) continue;
                const Pixel& other = at(static_cast<u32>(x), static_cast<u32>(y));
                if (other.hits == 0 || std::abs(double(other.depth) - pixel.depth) > nearby) continue;
                sum += other.open;
                weight += 1;
            }
        return sum / weight;  // the pixel itself is in its block
    }

    void compose(u32 row, Canvas& canvas) {
        for (u32 column = 0; column < view_.part().width; ++column) {
            const Pixel& pixel = at(column, row);
            if (pixel.hits == 0) continue;
            const double occlusion =
                (pixel.is_value ? occlusion_of_values : occlusion_of_plain) * (1 - smoothed_open(column, row));
            std::array<double, 3> colour;
            for (std::size_t i = 0; i < 3; ++i)
                colour[i] = 255 * std::sqrt(pixel.light[i] / pixel.hits * (1 - occlusion));
            canvas.lay(view_.part().x + column, view_.part().y + row, colour, double(pixel.hits) / (side_ * side_));
        }
    }

    const View& view_;
    const DrawnScene& scene_;
    const RayCaster& caster_;
    const SurfaceNormals* normals_;
    const RenderParams& params_;
    Context& context_;
    const std::array<double, 2> progress_;
    std::atomic<std::size_t> rows_done_ = 0;
    const u32 side_;
    const Vec3 key_;
    const OcclusionDirections directions_;
    Array<Pixel> pixels_;
    DepthMap depths_;
};

}  // namespace

double DepthMap::visible(const View& view, std::int64_t x, std::int64_t y, double depth) const {
    const std::int64_t column = x - view.part().x, row = y - view.part().y;
    if (column < 0 || row < 0 || column >= view.part().width || row >= view.part().height) return 0;
    if (depths.empty()) return 1;
    const std::size_t each = std::size_t(samples_per_side) * samples_per_side;
    const std::size_t first =
        (static_cast<std::size_t>(row) * view.part().width + static_cast<std::size_t>(column)) * each;
    std::size_t visible = 0;
    for (std::size_t i = 0; i < each; ++i) visible += depths[first + i] >= depth;
    return static_cast<double>(visible) / static_cast<double>(each);
}

DepthMap shade(Canvas& canvas, const View& view, const DrawnScene& scene, const RayCaster& caster,
               const SurfaceNormals* normals, const RenderParams& params, Context& context,
               const std::array<double, 2>& progress) {
    return Shader(view, scene, caster, normals, params, context, progress).draw(canvas);
}

}  // namespace scanmill
