// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/overlay.hpp"

#include <algorithm>
#include <cmath>

namespace scanmill {

namespace {

/// Widths and radii are given for this height of a text line, which a picture with 600 rows has.
constexpr double usual_size = 14;
constexpr Colour leader = {90, 90, 90};

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
    Overlay(Canvas& canvas, Font& font, const View& view, const DepthMap& depths, double tolerance,
            double label_tolerance, double size)
        : canvas_(canvas),
          font_(font),
          view_(view),
          depths_(depths),
          tolerance_(tolerance),
          label_tolerance_(label_tolerance),
          size_(size) {}

    void draw(const DrawnLine& line) {
        Vec3 start = line.from, end = line.to;
        if (!clip(start, end)) return;
        const Projected from = view_.project(start), to = view_.project(end);
        const double half = line.width / 2 * size_ / usual_size;
        stroke(from, to, half, [&](std::int64_t x, std::int64_t y, double along, double share) {
            lay(x, y, depth_between(from.depth, to.depth, along), line.colour, share);
        });
    }

    void draw(const DrawnDot& dot) {
        const Projected place = view_.project(dot.position);
        if (place.depth < view_.least_depth()) return;
        const double radius = dot.radius * size_ / usual_size;
        for_each_pixel({place.x - radius, place.y - radius, place.x + radius, place.y + radius},
                       [&](std::int64_t x, std::int64_t y) {
                           const double distance = length(x + 0.5 - place.x, y + 0.5 - place.y);
                           const double slack = dot.label.empty() ? 0 : label_tolerance_ - tolerance_;
                           lay(x, y, place.depth - slack, dot.colour, radius - distance + 0.5);
                       });
    }

    /// Returns false if the label had no free place.
    bool label(const DrawnDot& dot) {
        const Projected place = view_.project(dot.position);
        if (dot.label.empty() || place.depth < view_.least_depth()) return true;
        const auto x = static_cast<std::int64_t>(std::floor(place.x)),
                   y = static_cast<std::int64_t>(std::floor(place.y));
        if (depths_.visible(view_, x, y, place.depth - label_tolerance_) == 0) return true;
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
                if (reach > near) lead(place, {right > 0 ? box.left : box.right, (box.top + box.bottom) / 2, 0});
                font_.draw(canvas_, dot.label, left, base, size_, dot.colour, TextAnchor::left, true);
                return true;
            }
        return false;
    }

private:
    /// Moves the end of a line that is behind the eye to where the line comes into view. False if all of it is behind.
    bool clip(Vec3& start, Vec3& end) const {
        const double least = view_.least_depth(), from = view_.project(start).depth, to = view_.project(end).depth;
        if (from < least && to < least) return false;
        if (from < least) start += (least - from) / (to - from) * (end - start);
        if (to < least) end += (least - to) / (from - to) * (start - end);
        return true;
    }

    /// The depth at a share of the way on the picture. In perspective, its reciprocal changes evenly.
    double depth_between(double from, double to, double along) const {
        if (!view_.is_perspective()) return from + along * (to - from);
        return 1 / ((1 - along) / from + along / to);
    }

    /// A thin line from a dot to its label, over everything.
    void lead(const Projected& dot, const Projected& label) {
        stroke(dot, label, 0.4 * size_ / usual_size, [&](std::int64_t x, std::int64_t y, double, double share) {
            canvas_.lay(x, y, leader, std::min(1.0, share));
        });
    }

    /// Calls action(x, y, along, share) for the pixels of a line on the picture; `along` is the share of the way.
    template <class Action>
    void stroke(const Projected& from, const Projected& to, double half, const Action& action) const {
        const double dx = to.x - from.x, dy = to.y - from.y, squared = dx * dx + dy * dy, reach = half + 1;
        const auto [top, bottom] = rows(std::min(from.y, to.y) - reach, std::max(from.y, to.y) + reach);
        for (std::int64_t y = top; y < bottom; ++y) {
            // The part of the line near this row.
            const auto crossing = [&](double at) { return dy == 0 ? 0.5 : std::clamp((at - from.y) / dy, 0.0, 1.0); };
            double first = from.x + dx * crossing(static_cast<double>(y) - reach),
                   last = from.x + dx * crossing(static_cast<double>(y) + 1 + reach);
            if (dy == 0) first = from.x, last = to.x;
            const auto [left, right] = columns(std::min(first, last) - reach, std::max(first, last) + reach);
            for (std::int64_t x = left; x < right; ++x) {
                const double px = static_cast<double>(x) + 0.5 - from.x, py = static_cast<double>(y) + 0.5 - from.y;
                const double along = squared > 0 ? std::clamp((px * dx + py * dy) / squared, 0.0, 1.0) : 0;
                const double share = half - length(px - along * dx, py - along * dy) + 0.5;
                if (share > 0) action(x, y, along, share);
            }
        }
    }

    /// The rows or columns of the view that meet an interval.
    std::array<std::int64_t, 2> rows(double low, double high) const {
        return clamped(low, high, view_.part().y, view_.part().height);
    }
    std::array<std::int64_t, 2> columns(double low, double high) const {
        return clamped(low, high, view_.part().x, view_.part().width);
    }
    static std::array<std::int64_t, 2> clamped(double low, double high, u32 begin, u32 size) {
        const double end = double(begin) + size;
        return {static_cast<std::int64_t>(std::floor(std::clamp(low, double(begin), end))),
                static_cast<std::int64_t>(std::ceil(std::clamp(high, double(begin), end)))};
    }

    template <class Action>
    void for_each_pixel(const Box& box, const Action& action) const {
        const auto [left, right] = columns(box.left - 1, box.right + 1);
        const auto [top, bottom] = rows(box.top - 1, box.bottom + 1);
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
    const double tolerance_, label_tolerance_, size_;
    std::vector<Box> taken_;
};

}  // namespace

std::size_t draw_overlay(Canvas& canvas, Font& font, const View& view, const DrawnScene& scene, const DepthMap& depths,
                         double tolerance, double label_tolerance, double size) {
    Overlay overlay(canvas, font, view, depths, tolerance, label_tolerance, size);
    for (const DrawnLine& line : scene.lines) overlay.draw(line);
    for (const DrawnDot& dot : scene.dots) overlay.draw(dot);
    std::size_t left_out = 0;
    for (const DrawnDot& dot : scene.dots) left_out += !overlay.label(dot);
    return left_out;
}

}  // namespace scanmill
