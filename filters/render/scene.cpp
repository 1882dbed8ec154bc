// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/scene.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/data/point_tree.hpp"
#include "scanmill/data/spacing.hpp"
#include "scanmill/filter/inputs.hpp"
#include "scanmill/geometry/distance/self_intersections.hpp"
#include "scanmill/geometry/mesh/coincident.hpp"
#include "scanmill/geometry/mesh/facet_normals.hpp"
#include "scanmill/geometry/mesh/feature_lines.hpp"
#include "scanmill/geometry/spatial/angle.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"
#include "tessellate/tessellate.hpp"

namespace scanmill {

namespace {

/// Colours that remain different for colour-blind people (Okabe and Ito 2008).
constexpr Colour black = {30, 30, 30}, blue = {0, 114, 178}, vermillion = {213, 94, 0}, green = {0, 158, 115};

/// The radius of a point's disc is this share of the distance to this neighbour, within these limits in spacings. Discs
/// on a grid, or on scan lines that are farther apart than the points on a line, have no gaps then.
constexpr std::size_t disc_neighbour = 6;
constexpr double disc_share = 0.7, least_disc = 0.75, largest_disc = 3;
/// Limit between smooth and sharp edges without declared sharp edges.
const double crease_angle = FeatureParams{}.sharp_angle.in_radians();
constexpr double line_width = 1.6, dot_radius = 3.5;
constexpr std::size_t most_labels = 1000;

std::string with_separators(std::size_t count) {
    std::string text = std::to_string(count);
    for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, ",");
    return text;
}
std::string counted(std::size_t count, std::string_view singular, std::string_view plural) {
    return fmt::format("{} {}", with_separators(count), by_count(count, singular, plural));
}

/// The ends of the automatic scale: they leave out 1 % of the values on either side.
ColourScale automatic_scale(std::span<const double> values) {
    Array<double> finite;
    for (const double value : values)
        if (!std::isnan(value)) finite.push_back(value);
    if (finite.empty()) return {0, 0};
    const std::size_t left_out = finite.size() / 100;
    const auto low = finite.begin() + static_cast<std::ptrdiff_t>(left_out),
               high = finite.end() - 1 - static_cast<std::ptrdiff_t>(left_out);
    std::nth_element(finite.begin(), low, finite.end());
    const double lowest = *low;
    std::nth_element(finite.begin(), high, finite.end());
    ColourScale scale{lowest, *high};
    if (scale.low < 0 && scale.high > 0) {
        scale.high = std::max(-scale.low, scale.high);
        scale.low = -scale.high;
    }
    return scale;
}

/// The scale for a tolerance of width 0: it ends at the largest absolute value.
ColourScale scale_without_tolerance(std::span<const double> values) {
    double widest = 0;
    for (const double value : values)
        if (std::abs(value) > widest) widest = std::abs(value);
    return {-widest, widest};
}

class SceneMaker {
public:
    SceneMaker(const RenderParams& params, Context& context) : params_(params), context_(context) {}

    DrawnScene scene(const RenderInputs& inputs) {
        tolerance_ = limits_of(params_.tolerance, "tolerance");
        scale_ = limits_of(params_.scale, "scale");
        std::visit([&](const auto& value) { show(value); }, inputs.scene);
        if (scene_.mesh.triangles.empty()) warn_of_marks();
        if (params_.colour && !scene_.column)
            throw Error("the scene has no columns, so `colour: {}` does not apply", *params_.colour)
                .hint("`colour` is for meshes and points; leave it out");
        std::visit([&](const auto& value) { draw_over(value); }, inputs.over);
        if (!scene_.has_surface() && scene_.lines.empty() && scene_.dots.empty())
            throw Error("there is nothing to draw: the scene is empty")
                .hint("the step that made it reports why it found nothing");
        return std::move(scene_);
    }

private:
    void show(std::monostate) {
        throw Error("there is nothing to draw: the scene is missing").hint("name it in `in`, as `in: {scene: STEP}`");
    }

    void show(const TriangleMesh* mesh) {
        require_triangles(*mesh, "a picture needs at least one");
        show(*mesh);
    }

    void show(const TriangleMesh& mesh) {
        scene_.mesh = mesh;
        scene_.summary = counted(mesh.triangles.size(), "triangle", "triangles");
        if (params_.colour && params_.style == RenderParams::Style::lines)
            throw Error("`style: lines` shows bands, not the colours of '{}'", *params_.colour)
                .hint("leave out `style` or `colour`; two steps make two pictures");
        if (params_.colour) {
            const Column* column = mesh.vertex_columns.find(*params_.colour);
            const bool by_face = !column;
            if (by_face) column = mesh.face_columns.find(*params_.colour);
            if (!column) no_such_column({&mesh.vertex_columns, &mesh.face_columns});
            colour_by(*column, by_face, mesh.frame);
        }
        label(mesh.positions.span(), mesh.vertex_columns);
        if (params_.boundaries || params_.creases) draw_edges(mesh);
        if (params_.intersections) find_intersections(mesh);
    }

    void show(const PointCloud* cloud) {
        require_points(*cloud, "a picture needs at least one");
        scene_.summary = counted(cloud->size(), "point", "points");
        const double spacing = point_spacing(cloud->positions.span());
        const double diagonal = bounding_box(cloud->positions.span()).diagonal();
        constexpr double of_diagonal = 0.005;  // for one point, and for points that coincide
        constexpr double largest_of_diagonal = 0.05;  // for a few points
        Array<double> radii(cloud->size(), diagonal > 0 ? of_diagonal * diagonal : 1);
        if (spacing > 0) radii = local_radii(cloud->positions.span(), spacing, largest_of_diagonal * diagonal);
        const Column* normals = cloud->columns.find("normal");
        const bool has_normals = normals && normals->components() == 3;
        // Only the first of several points at one position is seen.
        const Array<u32> lowest = lowest_at_position(cloud->positions.span());
        for (std::size_t row = 0; row < cloud->size(); ++row) {
            if (lowest[row] != row) continue;
            Vec3 normal = Vec3::Zero();
            if (has_normals) {
                normal = {normals->number(row, 0), normals->number(row, 1), normals->number(row, 2)};
                normal = normal.allFinite() && normal.norm() > 0 ? normal.normalized().eval() : Vec3::Zero().eval();
            }
            scene_.discs.push_back({cloud->positions[row], normal, radii[row]});
            scene_.disc_rows.push_back(static_cast<u32>(row));
        }
        const auto median = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
        std::nth_element(radii.begin(), median, radii.end());
        scene_.disc_radius = *median;
        if (params_.colour) {
            const Column* column = cloud->columns.find(*params_.colour);
            if (!column) no_such_column({&cloud->columns});
            colour_by(*column, false, cloud->frame);
        }
        label(cloud->positions.span(), cloud->columns);
    }

    /// By row, for points that do not all coincide.
    Array<double> local_radii(std::span<const Vec3> positions, double spacing, double largest) const {
        const PointTree tree(positions, context_.threads());
        Array<double> by_position(tree.positions().size());
        tree.for_each_nearest(disc_neighbour, context_.threads(), [&](const NeighbourBatch& batch) {
            for (std::size_t i = 0; i < batch.indices.size(); ++i) {
                const double reach = batch.each == 0 ? 0 : std::sqrt(batch.of(i).back().squared);
                by_position[batch.indices[i]] =
                    std::min(largest, std::clamp(disc_share * reach, least_disc * spacing, largest_disc * spacing));
            }
        });
        Array<double> radii(positions.size());
        for (std::size_t row = 0; row < radii.size(); ++row) radii[row] = by_position[tree.index_of_row()[row]];
        return radii;
    }

    void show(const PatchComplex* patches) {
        if (patches->tets.empty())
            throw Error("the complex has no patches; a picture needs at least one").hint("`a-patch` makes patches");
        show(tessellate(*patches, {}, context_));
        scene_.summary = counted(patches->tets.size(), "patch", "patches");
    }

    void show(const FeatureGraph* features) {
        draw_over(features);
        scene_.summary = counted(features->polylines.size(), "feature line", "feature lines");
    }

    void show(const ProbePlan* plan) {
        draw_over(plan);
        scene_.summary = counted(plan->touches.size(), "touch", "touches");
    }

    void draw_over(std::monostate) {}
    void draw_over(const TriangleMesh*) {}
    void draw_over(const PatchComplex*) {}

    void draw_over(const PointCloud* cloud) {
        require_finite(cloud->positions.span());
        if (cloud->columns.find("label")) return label(cloud->positions.span(), cloud->columns);
        for (const Vec3& position : cloud->positions) scene_.dots.push_back({position, vermillion, dot_radius, ""});
    }

    void draw_over(const FeatureGraph* features) {
        require_finite(features->positions.span(), "vertices");
        for (const FeaturePolyline& line : features->polylines) {
            const Colour colour = line.type == FeatureType::crease           ? black
                                  : line.type == FeatureType::outer_boundary ? blue
                                                                             : vermillion;
            const auto at = [&](u32 i) { return features->positions[features->vertices[i]]; };
            for (u32 i = line.begin; i + 1 < line.end; ++i)
                scene_.lines.push_back({at(i), at(i + 1), colour, line_width});
            if (line.closed && line.end > line.begin + 1)
                scene_.lines.push_back({at(line.end - 1), at(line.begin), colour, line_width});
        }
        for (const u32 corner : features->corners)
            scene_.dots.push_back({features->positions[corner], black, dot_radius, ""});
    }

    void draw_over(const ProbePlan* plan) {
        for (const ProbeTouch& touch : plan->touches) {
            if (!touch.position.allFinite())
                throw Error("touch {} has a coordinate that is not finite", touch.touch)
                    .hint("correct the plan's file, or plan the probes again");
            scene_.dots.push_back({touch.position, touch.is_made() ? green : vermillion, dot_radius, ""});
            if (touch.is_made()) scene_.lines.push_back({touch.start, touch.position, blue, line_width});
        }
    }

    [[noreturn]] void no_such_column(std::initializer_list<const ColumnTable*> tables) const {
        std::vector<std::string> names;
        for (const ColumnTable* table : tables)
            for (const Column& column : *table) names.push_back(column.name());
        throw Error("the scene has no column '{}'; {}{}", *params_.colour,
                    names.empty() ? "it has none" : "it has " + enumerated(names), did_you_mean(*params_.colour, names))
            .hint("name the value that has the column, as `in: {scene: inspect.deviation}`");
    }

    void colour_by(const Column& column, bool by_face, const Frame& frame) {
        context_.check_cancelled();
        DrawnColumn& drawn = scene_.column.emplace();
        drawn.name = column.name();
        drawn.by_face = by_face;
        const std::size_t rows = column.rows();
        if (column.type() == ScalarType::uint8 && (column.components() == 3 || column.components() == 4)) {
            const std::span<const u8> numbers = column.values<u8>();
            drawn.colours.resize(rows);
            for (std::size_t row = 0; row < rows; ++row)
                for (std::size_t i = 0; i < 3; ++i) drawn.colours[row][i] = numbers[row * column.components() + i];
            return;
        }
        if (column.components() != 1)
            throw Error("the column '{}' has {} per row; a picture needs one number, or a colour of three bytes",
                        column.name(), column.is_list() ? "a list" : fmt::format("{} numbers", column.components()))
                .hint("choose another column with `colour`");
        drawn.values.resize(rows);
        for (std::size_t row = 0; row < rows; ++row) {
            const double value = column.number(row);
            drawn.values[row] = std::isfinite(value) ? value : std::numeric_limits<double>::quiet_NaN();
        }
        const auto is_nan = [](double value) { return std::isnan(value); };
        const std::size_t gaps = static_cast<std::size_t>(std::ranges::count_if(drawn.values, is_nan));
        drawn.has_gaps = gaps > 0;
        if (gaps == rows)
            context_.warn(fmt::format("the column '{}' has no value: the whole scene is grey", column.name()));
        if (column.length_exponent() == 1) drawn.unit = symbol(frame.unit);
        drawn.scale = !tolerance_ ? automatic_scale(drawn.values)
                      : tolerance_->low != 0 || tolerance_->high != 0
                          ? scale_of_tolerance(tolerance_->low, tolerance_->high)
                          : scale_without_tolerance(drawn.values);
        if (scale_) {
            drawn.scale.low = scale_->low;
            drawn.scale.high = scale_->high;
        }
    }

    struct Limits {
        double low, high;
    };
    static std::optional<Limits> limits_of(const std::optional<std::vector<Length>>& lengths, std::string_view name) {
        if (!lengths) return std::nullopt;
        const Limits limits{lengths->front().value(), lengths->back().value()};
        if (!(limits.low <= limits.high) || !std::isfinite(limits.high - limits.low))
            throw Error("the {} is upside down: it goes from {} to {}", name, number_text(limits.low),
                        number_text(limits.high))
                .hint("write the lower end first");
        return limits;
    }

    /// Writes the coloured column's value, or the label's number, at every row with a label.
    void label(std::span<const Vec3> positions, const ColumnTable& columns) {
        const Column* labels = columns.find("label");
        if (!labels || labels->components() != 1) return;
        const Column* values = params_.colour ? columns.find(*params_.colour) : nullptr;
        if (values && values->components() != 1) values = nullptr;
        std::vector<std::size_t> rows;
        for (std::size_t row = 0; row < positions.size(); ++row)
            if (labels->number(row) > 0) rows.push_back(row);
        if (rows.size() > most_labels) {  // a column of classes, for instance
            context_.warn(
                fmt::format("the column 'label' has {} values above 0, too many to write; at most {} are "
                            "written",
                            rows.size(), most_labels));
            return;
        }
        for (const std::size_t row : rows)
            scene_.dots.push_back(
                {positions[row], black, dot_radius,
                 values ? fmt::format("{:+.3g}", values->number(row)) : number_text(labels->number(row))});
    }

    /// Warns that marks of meshes do not apply.
    void warn_of_marks() const {
        std::vector<std::string> names;
        for (const auto& [name, is_wanted] : {std::pair("edges", params_.edges),
                                              {"boundaries", params_.boundaries},
                                              {"intersections", params_.intersections},
                                              {"creases", params_.creases},
                                              {"style", params_.style == RenderParams::Style::lines}})
            if (is_wanted) names.push_back(fmt::format("`{}`", name));
        if (!names.empty())
            context_.warn(fmt::format("the scene is not a mesh, so {} {} not apply", enumerated(names),
                                      by_count(names.size(), "does", "do")));
    }

    /// Boundaries and creases of the mesh with vertices at one position as one vertex, as files with repeated vertices
    /// mean it.
    void draw_edges(const TriangleMesh& mesh) {
        const bool by_angle = mesh.sharp_edges.empty();
        const auto add = [&](u32 a, u32 b, Colour colour) {
            scene_.lines.push_back({mesh.positions[a], mesh.positions[b], colour, line_width});
        };
        TriangleMesh joined;
        joined.positions = mesh.positions;
        const Array<u32> lowest = lowest_at_position(mesh.positions.span());
        Array<Triangle> triangles(mesh.triangles.begin(), mesh.triangles.end());
        for (Triangle& triangle : triangles)
            for (u32& vertex : triangle) vertex = lowest[vertex];
        joined.triangles = std::move(triangles);
        const half_edges::ByVertex by_vertex = half_edges::by_smaller_vertex(joined);
        half_edges::for_each_edge(by_vertex, [&](u32 vertex, std::span<const half_edges::VertexHalfEdge> edge) {
            if (edge.size() == 1 && params_.boundaries) add(vertex, edge[0].other, vermillion);
            if (edge.size() == 2 && params_.creases && by_angle && is_crease(joined, edge[0].number, edge[1].number))
                add(vertex, edge[0].other, black);
        });
        if (params_.creases)
            for (const Edge& edge : mesh.sharp_edges) add(edge[0], edge[1], black);
    }

    /// Whether the triangles of two half-edges with the same ends meet at more than crease_angle. No triangle without
    /// area does.
    static bool is_crease(const TriangleMesh& mesh, u32 one, u32 other) {
        const auto normal_of = [&](u32 half_edge) {
            return area_vector(mesh.positions, mesh.triangles[half_edge / 3]);
        };
        const bool are_opposite = half_edges::start(mesh, one) != half_edges::start(mesh, other);
        const Vec3 a = normal_of(one), b = are_opposite ? normal_of(other) : Vec3(-normal_of(other));
        return a != Vec3::Zero() && b != Vec3::Zero() && angle_between(a, b) > crease_angle + angle_tie;
    }

    void find_intersections(const TriangleMesh& mesh) {
        const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), context_.threads());
        const SelfIntersections found =
            self_intersections(mesh.positions.span(), mesh.triangles.span(), tree, context_);
        scene_.intersecting.assign(mesh.triangles.size(), 0);
        for (const auto& pair : found.pairs)
            for (const u32 triangle : pair) scene_.intersecting[triangle] = 1;
        scene_.summary += fmt::format(", {}", counted(found.count, "intersection", "intersections"));
    }

    const RenderParams& params_;
    Context& context_;
    std::optional<Limits> tolerance_, scale_;
    DrawnScene scene_;
};

}  // namespace

Array<Vec3> DrawnScene::extent() const {
    Array<Vec3> positions;
    std::vector<bool> is_used(mesh.positions.size(), false);
    for (const Triangle& triangle : mesh.triangles)
        for (const u32 vertex : triangle) is_used[vertex] = true;
    for (std::size_t vertex = 0; vertex < is_used.size(); ++vertex)
        if (is_used[vertex]) positions.push_back(mesh.positions[vertex]);
    for (const Disc& disc : discs) {
        positions.push_back(disc.centre - Vec3::Constant(disc.radius / std::sqrt(3.0)));
        positions.push_back(disc.centre + Vec3::Constant(disc.radius / std::sqrt(3.0)));
    }
    for (const DrawnLine& line : lines) {
        positions.push_back(line.from);
        positions.push_back(line.to);
    }
    for (const DrawnDot& dot : dots) positions.push_back(dot.position);
    return positions;
}

DrawnScene make_scene(const RenderInputs& inputs, const RenderParams& params, Context& context) {
    return SceneMaker(params, context).scene(inputs);
}

}  // namespace scanmill
