// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/render.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "render/legend.hpp"
#include "render/overlay.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/filter/inputs.hpp"

namespace scanmill {

namespace {

constexpr Colour title_ink = {90, 90, 90};
/// Height of a line of text: 14 pixels in a picture with 600 rows.
constexpr double text_share = 14.0 / 600;
constexpr double least_text = 10;
/// A line on the surface may lie behind it by this share of the scene's radius.
constexpr double line_tolerance = 0.005;
/// As much for labels, which belong to points of a scan beside the surface.
constexpr double label_tolerance = 0.03;

/// A surface that rays can hit.
struct Surface {
    std::optional<RayCaster> caster;
    std::optional<SurfaceNormals> normals;

    Surface(const DrawnScene& scene, unsigned threads) {
        if (!scene.has_surface()) return;
        caster.emplace(scene.mesh.positions.span(), scene.mesh.triangles.span(), scene.discs, threads);
        if (!scene.mesh.triangles.empty()) normals.emplace(scene.mesh, threads);
    }
};

/// nullptr for nothing.
const Frame* frame_of(const Drawable& drawable) {
    return std::visit(
        [](const auto& value) -> const Frame* {
            if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, std::monostate>)
                return nullptr;
            else
                return &value->frame;
        },
        drawable);
}

void require_frame_of_scene(const Drawable& scene, const Drawable& other, std::string_view name) {
    const Frame *frame = frame_of(scene), *its = frame_of(other);
    if (frame && its) require_same_frame(*its, fmt::format("{} is", name), *frame, "the scene");
}

/// Whether all pixels of the part are white.
bool is_empty(const Canvas& canvas, const Rectangle& part) {
    const Buffer<Colour> pixels = canvas.pixels();
    for (u32 y = part.y; y < part.y + part.height; ++y)
        for (u32 x = part.x; x < part.x + part.width; ++x)
            if (pixels[std::size_t(y) * canvas.width() + x] != Colour{255, 255, 255}) return false;
    return true;
}

std::string caption_of(const DrawnScene& scene, const std::optional<Legend>& legend, const std::vector<View>& views) {
    std::string caption = scene.summary;
    if (legend) {
        caption += fmt::format("; {}: {} to {}", legend->title, legend->ticks.front().text, legend->ticks.back().text);
        if (!legend->upper_word.empty())
            caption += fmt::format(", below 0 {}, above 0 {}", legend->lower_word, legend->upper_word);
    }
    caption += "; view";
    for (const View& view : views) caption += " " + view.name();
    return caption;
}

}  // namespace

Picture render(const RenderInputs& inputs, const RenderParams& params, Context& context) {
    if (params.size.size() != 2)
        throw Error("`size` has {} numbers; expected two: columns and rows", params.size.size())
            .hint("write it as [800, 600]");
    require_frame_of_scene(inputs.scene, inputs.over, "the value at 'over'");
    require_frame_of_scene(inputs.scene, inputs.truth, "the value at 'truth'");
    const DrawnScene scene = make_scene(inputs, params, context);
    const Surface surface(scene, context.threads());
    context.progress(0.3);
    context.check_cancelled();

    Canvas canvas(params.size[0], params.size[1]);
    Font font;
    const double size = std::max(least_text, text_share * std::min(params.size[1], params.size[0]));
    std::optional<Legend> legend;
    if (params.legend && scene.column && scene.column->colours.empty()) legend = legend_of(*scene.column);
    Rectangle part{0, 0, canvas.width(), canvas.height()};
    if (legend) {
        const u32 width = width_of(*legend, font, size);
        if (width < part.width / 2) {
            part.width -= width;
            draw(*legend, canvas, font, {part.width, 0, width, part.height}, size);
        } else {
            context.warn(
                fmt::format("the legend is left out: it needs {} of the picture's {} columns", width, canvas.width()));
        }
    }

    const Vec3 origin = frame_of(inputs.scene)->origin;  // make_scene() refuses a scene without a value
    std::vector<View> views;
    if (!std::holds_alternative<std::monostate>(inputs.truth)) {
        const DrawnScene truth = make_scene({inputs.truth, {}, {}}, {}, context);
        const Surface framed(truth, context.threads());
        views = views_of(truth, framed.caster ? &*framed.caster : nullptr, origin, params, part, context);
    } else {
        views = views_of(scene, surface.caster ? &*surface.caster : nullptr, origin, params, part, context);
    }
    context.progress(0.4);

    const auto progress_at = [&](std::size_t view) {
        return 0.4 + 0.6 * static_cast<double>(view) / static_cast<double>(views.size());
    };
    std::size_t hidden_labels = 0;
    for (std::size_t i = 0; i < views.size(); ++i) {
        const double begin = progress_at(i), end = progress_at(i + 1);
        DepthMap depths;
        if (surface.caster)
            depths = shade(canvas, views[i], scene, *surface.caster, surface.normals ? &*surface.normals : nullptr,
                           params, context, {begin + (end - begin) * 0.1, end});
        const double radius = surface.caster ? surface.caster->radius() : 0;
        hidden_labels += draw_overlay(canvas, font, views[i], scene, depths, line_tolerance * radius,
                                      label_tolerance * radius, size);
        if (views.size() > 1)
            font.draw(canvas, views[i].name(), views[i].part().x + size, views[i].part().y + 1.5 * size, size,
                      title_ink);
        context.progress(end);
    }
    if (is_empty(canvas, part))
        context.doubt("the picture shows nothing: the scene is out of view, seen edge-on, or without area");
    if (hidden_labels > 0)
        context.warn(fmt::format("{} of the labels found no free place in the picture", hidden_labels));
    return {canvas.width(), canvas.height(), canvas.pixels(), caption_of(scene, legend, views)};
}

}  // namespace scanmill
