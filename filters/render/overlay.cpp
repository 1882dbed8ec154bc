// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/overlay.hpp"

#include <algorithm>
#include <cmath>

namespace scanmill {

namespace {

/// Widths and radii are given for this height of a text line, which a picture with 600 rows has.
constexpr double usual_size = 14;

/// Not std::hypot, whose last bits depend on the processor.
double length(double x, double y) { return std::sqrt(x * x + y * y); }

struct Box {
    double left, top, right, bottom;
    bool meets(const Box& other) const {
        return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
    }
};

class Overlay {
public:
    Overlay(Canvas& canvas, Font& font, const View& view, const DepthMap& depths, double tolerance, double size)
        : canvas_(canvas),
          font_(font),
          view_(view),
          depths_(depths),
          tolerance_(tolerance),
          size_(size) {}

    void draw(const DrawnLine& line) {
        const Projected from = view_.project(line.from), to = view_.project(line.to);
        if (!view_.is_before(from) || !view_.is_before(to)) return;
        const double half = line.width / 2 * size_ / usual_size;
        const double dx = to.x - from.x, dy = to.y - from.y, squared = dx * dx + dy * dy;
        for_each_pixel({std::min(from.x, to.x) - half, std::min(from.y, to.y) - half, std::max(from.x, to.x) + half,
                        std::max(from.y, to.y) + half},
                       [&](std::int64_t x, std::int64_t y) {
                           const double px = x + 0.5 - from.x, py = y + 0.5 - from.y;
                           const double along = squared > 0 ? std::clamp((px * dx + py * dy) / squared, 0.0, 1.0) : 0;
                           const double distance = length(px - along * dx, py - along * dy);
                           lay(x, y, from.depth + along * (to.depth - from.depth), line.colour, half - distance + 0.5);
                       });
    }

    void draw(const DrawnDot& dot) {
        const Projected place = view_.project(dot.position);
        if (!view_.is_before(place)) return;
        const double radius = dot.radius * size_ / usual_size;
        for_each_pixel({place.x - radius, place.y - radius, place.x + radius, place.y + radius},
                       [&](std::int64_t x, std::int64_t y) {
                           const double distance = length(x + 0.5 - place.x, y + 0.5 - place.y);
                           lay(x, y, place.depth, dot.colour, radius - distance + 0.5);
                       });
    }

    /// Returns false if the label had no free place.
    bool label(const DrawnDot& dot) {
        const Projected place = view_.project(dot.position);
        if (dot.label.empty() || !view_.is_before(place)) return true;
        const auto x = static_cast<std::int64_t>(std::floor(place.x)),
                   y = static_cast<std::int64_t>(std::floor(place.y));
        if (depths_.visible(view_, x, y, place.depth - tolerance_) == 0) return true;
        const double width = font_.width(dot.label, size_), near = 0.8 * size_;
        for (const double reach : {near, 2.5 * near, 4 * near, 6 * near})
            for (const auto& [right, up] : {std::pair(1, 1), {1, -1}, {-1, 1}, {-1, -1}}) {
                const double left = place.x + (right > 0 ? reach : -reach - width);
                const double base = place.y - (up > 0 ? 0.5 * reach : -0.5 * reach - 0.8 * size_);
                const Box box{left - 2, base - size_, left + width + 2, base + 0.3 * size_};
                const Rectangle& part = view_.part();
                const bool is_inside = box.left >= part.x && box.top >= part.y && box.right <= part.x + part.width &&
                                       box.bottom <= part.y + part.height;
                if (!is_inside || std::ranges::any_of(taken_, [&](const Box& other) { return box.meets(other); }))
                    continue;
                taken_.push_back(box);
                font_.draw(canvas_, dot.label, left, base, size_, dot.colour, TextAnchor::left, true);
                return true;
            }
        return false;
    }

private:
    template <class Action>
    void for_each_pixel(const Box& box, const Action& action) const {
        const Rectangle& part = view_.part();
        const auto clamped = [](double value, u32 begin, u32 length) {
            return static_cast<std::int64_t>(std::floor(std::clamp(value, double(begin), double(begin) + length)));
        };
        const std::int64_t left = clamped(box.left - 1, part.x, part.width),
                           right = clamped(box.right + 2, part.x, part.width),
                           top = clamped(box.top - 1, part.y, part.height),
                           bottom = clamped(box.bottom + 2, part.y, part.height);
        for (std::int64_t y = top; y < bottom; ++y)
            for (std::int64_t x = left; x < right; ++x) action(x, y);
    }

    void lay(std::int64_t x, std::int64_t y, double depth, const Colour& colour, double share) {
        if (share <= 0) return;
        canvas_.lay(x, y, colour, std::min(1.0, share) * depths_.visible(view_, x, y, depth - tolerance_));
    }

    Canvas& canvas_;
    Font& font_;
    const View& view_;
    const DepthMap& depths_;
    const double tolerance_, size_;
    std::vector<Box> taken_;
};

}  // namespace

std::size_t draw_overlay(Canvas& canvas, Font& font, const View& view, const DrawnScene& scene, const DepthMap& depths,
                         double tolerance, double size) {
    Overlay overlay(canvas, font, view, depths, tolerance, size);
    for (const DrawnLine& line : scene.lines) overlay.draw(line);
    for (const DrawnDot& dot : scene.dots) overlay.draw(dot);
    std::size_t left_out = 0;
    for (const DrawnDot& dot : scene.dots) left_out += !overlay.label(dot);
    return left_out;
}

}  // namespace scanmill
