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

constexpr Colour ink = {90, 90, 90};
/// Height of a line of text: 14 pixels in a picture with 600 rows.
constexpr double text_share = 14.0 / 600;
constexpr double least_text = 10;
/// A line on the surface may lie behind it by this share of the scene's radius.
constexpr double line_tolerance = 0.005;

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

Vec3 origin_of(const Drawable& scene) {
    return std::visit(
        [](const auto& value) -> Vec3 {
            if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, std::monostate>)
                return Vec3::Zero();
            else
                return value->frame.origin;
        },
        scene);
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
    if (params.size.size() != 2) throw Error("`size` needs two numbers: columns and rows");
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

    const Vec3 origin = origin_of(inputs.scene);
    std::vector<View> views;
    if (!std::holds_alternative<std::monostate>(inputs.truth)) {
        const DrawnScene truth = make_scene({inputs.truth, {}, {}}, {}, context);
        const Surface framed(truth, context.threads());
        views = views_of(truth, &*framed.caster, origin, params, part, context);
    } else {
        views = views_of(scene, surface.caster ? &*surface.caster : nullptr, origin, params, part, context);
    }
    context.progress(0.4);

    std::size_t hidden_labels = 0;
    for (std::size_t i = 0; i < views.size(); ++i) {
        DepthMap depths;
        if (surface.caster)
            depths = shade(canvas, views[i], scene, *surface.caster, surface.normals ? &*surface.normals : nullptr,
                           params, context);
        const double radius = surface.caster ? surface.caster->radius() : 0;
        hidden_labels += draw_overlay(canvas, font, views[i], scene, depths, line_tolerance * radius, size);
        if (views.size() > 1)
            font.draw(canvas, views[i].name(), views[i].part().x + size, views[i].part().y + 1.5 * size, size, ink);
        context.progress(0.4 + 0.6 * static_cast<double>(i + 1) / static_cast<double>(views.size()));
    }
    if (hidden_labels > 0)
        context.warn(fmt::format("{} of the labels found no free place in the picture", hidden_labels));
    return {canvas.width(), canvas.height(), canvas.pixels(), caption_of(scene, legend, views)};
}

}  // namespace scanmill
