// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/transfer.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/filter/inputs.hpp"
#include "transfer/samples.hpp"
#include "transfer/srgb_curve.hpp"

namespace scanmill {

namespace {

using namespace transferring;

constexpr std::string_view mark = "transferred";
/// Similar colours, see transfer.hpp. With normally distributed noise, two samples of one colour are farther apart than
/// 2.5 times the median in 0.2 % of all cases. Without noise, colours of smooth gradients are similar within the floor.
constexpr double similar_medians = 2.5, similar_floor = 12.0 / 255;
/// Share of the rows near `from` that may face away from it, as at thin parts of which one side was scanned.
constexpr double doubtful_share = 0.05;
constexpr std::size_t chunk = 1024;

bool is_colour(const Column& column) {
    const bool has_channels = column.components() == 3 || column.components() == 4;
    return has_channels && ((column.name() == "colour" && column.type() == ScalarType::uint8) ||
                            (column.name() == "colour16" && column.type() == ScalarType::uint16));
}
bool is_direction(const Column& column) {
    return column.components() == 3 && (column.name() == "normal" || column.name() == "approach");
}
bool is_float(const Column& column) {
    return !column.is_list() && (column.type() == ScalarType::float32 || column.type() == ScalarType::float64);
}

/// A column of `from`.
struct Carried {
    const Column* column;
    bool of_faces = false;
};

const ColumnTable& columns_of(const PointCloud& cloud) { return cloud.columns; }
const ColumnTable& columns_of(const TriangleMesh& mesh) { return mesh.vertex_columns; }
ColumnTable& columns_of(PointCloud& cloud) { return cloud.columns; }
ColumnTable& columns_of(TriangleMesh& mesh) { return mesh.vertex_columns; }
const ColumnTable* face_columns_of(const PointCloud&) { return nullptr; }
const ColumnTable* face_columns_of(const TriangleMesh& mesh) { return &mesh.face_columns; }

template <class From>
std::optional<Carried> find_column(const From& from, std::string_view name) {
    if (const Column* column = columns_of(from).find(name)) return Carried{column};
    const ColumnTable* faces = face_columns_of(from);
    if (const Column* column = faces ? faces->find(name) : nullptr) return Carried{column, true};
    return std::nullopt;
}

template <class From>
std::string names_in(const From& from) {
    std::vector<std::string> names;
    for (const Column& column : columns_of(from)) names.push_back(fmt::format("'{}'", column.name()));
    if (const ColumnTable* faces = face_columns_of(from))
        for (const Column& column : *faces) names.push_back(fmt::format("'{}' (faces)", column.name()));
    return names.empty() ? "it has no columns" : fmt::format("it has {}", fmt::join(names, ", "));
}

/// The columns to carry; empty if `from` has none of the default ones.
template <class From>
std::vector<Carried> carried_columns(const From& from, const TransferParams& params) {
    std::vector<Carried> carried;
    if (!params.columns) {
        for (const char* name : {"colour", "colour16"})
            if (const auto found = find_column(from, name)) carried.push_back(*found);
        return carried;
    }
    if (params.columns->empty())
        throw Error("columns is an empty list; at least one name is needed")
            .hint("leave columns out to carry the colours");
    std::set<std::string> names;
    for (const std::string& name : *params.columns) {
        const auto found = find_column(from, name);
        if (name == mark)
            throw Error("columns contains '{}', the name of the column that the filter adds", mark)
                .hint("remove it from columns");
        if (!found)
            throw Error("`from` has no column '{}'; {}", name, names_in(from))
                .hint("`columns: colour` carries colours where there are any, and accepts scans without");
        if (!names.insert(name).second) throw Error("columns contains '{}' twice", name).hint("remove one of the two");
        carried.push_back(*found);
    }
    return carried;
}

/// Warns of colours that are columns of their own, as files with channels of more than a byte have them.
template <class From>
void warn_of_channels(const From& from, Context& context) {
    for (const char* name : {"red", "green", "blue"})
        if (!find_column(from, name)) return;
    context.warn(
        "`from` has no column 'colour', but 'red', 'green' and 'blue', which are not taken as colours; `columns: [red, "
        "green, blue]` carries them as numbers");
}

void require_rows(const Column& column, std::size_t rows, std::string_view elements) {
    if (column.rows() != rows)
        throw Error("the column '{}' has {}, but there are {} {}", column.name(),
                    count_text(column.rows(), "row", "rows"), rows, elements)
            .hint("a column needs one row per element");
}

void require_source(const PointCloud& from) { require_points(from, "transfer needs at least one in `from`"); }
void require_source(const TriangleMesh& from) {
    require_triangles(from, "transfer needs at least one in `from`; points can be wired instead");
}
void require_target(const PointCloud& to) { require_points(to, "transfer needs at least one in `to`"); }
void require_target(const TriangleMesh& to) {
    if (to.positions.empty())
        throw Error("the mesh has 0 vertices; transfer needs at least one in `to`")
            .hint("`scanmill info` shows what a file contains");
    require_consistent(to);
    require_finite(to.positions.span(), "vertices");
}

PointSamples samples_of(const PointCloud& from, std::optional<double> max_distance, unsigned threads) {
    return {from, max_distance, threads};
}
MeshSamples samples_of(const TriangleMesh& from, std::optional<double> max_distance, unsigned threads) {
    return {from, max_distance, threads};
}

/// The squared distance within which two colours are similar. A mesh is interpolated, so all its colours are.
double similar_colours(const PointSamples& samples, const Column& colour, unsigned threads) {
    const double full = colour.type() == ScalarType::uint8 ? 255 : 65535;
    const double distance = std::max(similar_medians * samples.colour_noise(colour, threads), similar_floor * full);
    return distance * distance;
}
double similar_colours(const MeshSamples&, const Column&, unsigned) { return std::numeric_limits<double>::infinity(); }

/// Computes one column of `to`, row by row. Safe from several threads for different rows.
class ColumnWriter {
public:
    virtual ~ColumnWriter() = default;
    virtual void write(std::size_t row, const Samples& found) = 0;
    virtual void write_neutral(std::size_t row) = 0;
    virtual Column finish() = 0;
};

/// Copies whole rows: of the nearest point or corner, or of the nearest face. Also for lists.
class CopiedColumn : public ColumnWriter {
public:
    CopiedColumn(const Carried& carried, std::size_t rows)
        : from_(*carried.column),
          of_faces_(carried.of_faces),
          sources_(rows) {}
    void write(std::size_t row, const Samples& found) override {
        sources_[row] = of_faces_ ? found.face : found.nearest;
    }
    void write_neutral(std::size_t row) override { sources_[row] = no_row; }
    Column finish() override { return from_.is_list() ? lists() : numbers(); }

private:
    Column numbers() const {
        const std::size_t width = from_.components() * size_of(from_.type());
        const Array<std::byte> neutral = neutral_row();
        Array<std::byte> bytes(sources_.size() * width);
        for (std::size_t row = 0; row < sources_.size(); ++row)
            std::memcpy(bytes.data() + row * width,
                        sources_[row] == no_row ? neutral.data() : from_.bytes().data() + sources_[row] * width, width);
        return {from_.name(), from_.type(), from_.components(), std::move(bytes), {}, from_.length_exponent()};
    }
    Column lists() const {
        const Buffer<u64>& from = from_.offsets();
        const std::size_t width = size_of(from_.type());
        Array<u64> offsets(sources_.size() + 1);
        offsets[0] = 0;
        for (std::size_t row = 0; row < sources_.size(); ++row) {
            const u32 source = sources_[row];
            offsets[row + 1] = offsets[row] + (source == no_row ? 0 : from[source + 1] - from[source]);
        }
        Array<std::byte> bytes(offsets.back() * width);
        for (std::size_t row = 0; row < sources_.size(); ++row)
            if (const std::size_t size = (offsets[row + 1] - offsets[row]) * width; size > 0)
                std::memcpy(bytes.data() + offsets[row] * width, from_.bytes().data() + from[sources_[row]] * width,
                            size);
        return {from_.name(), from_.type(), 0, std::move(bytes), std::move(offsets), from_.length_exponent()};
    }
    Array<std::byte> neutral_row() const {
        Array<std::byte> row(from_.components() * size_of(from_.type()), std::byte{0});
        if (!is_colour(from_)) return row;
        for (u32 channel = 0; channel < from_.components(); ++channel) {
            const bool is_byte = from_.type() == ScalarType::uint8;
            if (is_byte) row[channel] = std::byte{channel == 3 ? u8{255} : u8{128}};
            const std::uint16_t word = channel == 3 ? 65535 : 128 * 257;
            if (!is_byte) std::memcpy(row.data() + 2 * channel, &word, 2);
        }
        return row;
    }

    const Column& from_;
    bool of_faces_;
    Array<u32> sources_;
};

/// The mean of float columns; of directions, with length 1.
template <class T>
class MeanColumn : public ColumnWriter {
public:
    MeanColumn(const Column& from, std::size_t rows)
        : from_(from),
          values_(from.values<T>()),
          is_direction_(is_direction(from)),
          result_(rows * from.components()) {}
    void write(std::size_t row, const Samples& found) override {
        const u32 components = from_.components();
        T* const to = result_.data() + row * components;
        for (u32 component = 0; component < components; ++component) {
            // Differences to one value, so that the mean of equal values is that value.
            const auto value = [&](u32 from) { return static_cast<double>(values_[from * components + component]); };
            double base = value(found.nearest), sum = 0, weights = 0;
            for (const auto& [from, squared, weight] : found.samples) {
                if (!std::isfinite(value(from))) continue;
                if (!std::isfinite(base)) base = value(from);
                sum += weight * (value(from) - base);
                weights += weight;
            }
            to[component] = static_cast<T>(weights > 0 ? base + sum / weights : base);
        }
        if (is_direction_) {
            const double x = to[0], y = to[1], z = to[2], length = Vec3(x, y, z).stableNorm();
            const bool has_direction = length > 0 && std::isfinite(length);
            for (u32 component = 0; component < components; ++component)
                to[component] = has_direction ? static_cast<T>(to[component] / length)
                                              : values_[found.nearest * components + component];
        }
    }
    void write_neutral(std::size_t row) override {
        std::fill_n(result_.data() + row * from_.components(), from_.components(), T(0));
    }
    Column finish() override {
        return Column(from_.name(), from_.components(), Buffer<T>(std::move(result_)))
            .with_length_exponent(from_.length_exponent());
    }

private:
    const Column& from_;
    std::span<const T> values_;
    bool is_direction_;
    Array<T> result_;
};

/// The mean, in linear light, of the similar colours that have the most weight. T: u8 or uint16.
template <class T>
class ColourColumn : public ColumnWriter {
public:
    ColourColumn(const Column& from, std::size_t rows, double squared_similar)
        : from_(from),
          values_(from.values<T>()),
          similar_(squared_similar),
          curve_(most + 1u),
          result_(rows * from.components()) {}
    void write(std::size_t row, const Samples& found) override {
        const u32 components = from_.components(), middle = found.samples[mode_of(found.samples)].row;
        T* const to = result_.data() + row * components;
        for (u32 channel = 0; channel < components; ++channel) {
            const bool is_alpha = channel == 3;
            const auto value = [&](u32 from) {
                const T code = values_[from * components + channel];
                return is_alpha ? static_cast<double>(code) : curve_.linear(code);
            };
            const double base = value(middle);
            double sum = 0, weights = 0;
            for (const auto& [from, squared, weight] : found.samples)
                if (are_similar(from, middle)) sum += weight * (value(from) - base), weights += weight;
            const double mean = base + sum / weights;
            to[channel] = static_cast<T>(is_alpha ? std::floor(mean + 0.5) : curve_.code(mean));
        }
    }
    void write_neutral(std::size_t row) override {
        for (u32 channel = 0; channel < from_.components(); ++channel)
            result_[row * from_.components() + channel] = channel == 3 ? most : most / 255 * 128;
    }
    Column finish() override { return Column(from_.name(), from_.components(), Buffer<T>(std::move(result_))); }

private:
    static constexpr T most = std::numeric_limits<T>::max();

    bool are_similar(u32 a, u32 b) const {
        double sum = 0;
        for (u32 channel = 0; channel < 3; ++channel) {
            const double difference = static_cast<double>(values_[a * from_.components() + channel]) -
                                      static_cast<double>(values_[b * from_.components() + channel]);
            sum += difference * difference;
        }
        return sum <= similar_;
    }
    /// The sample with the most weight of samples of similar colours; ties: the first.
    std::size_t mode_of(std::span<const Sample> samples) const {
        if (similar_ == std::numeric_limits<double>::infinity()) return 0;
        std::size_t best = 0;
        double most_weight = 0;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            double weight = 0;
            for (const Sample& other : samples)
                if (are_similar(samples[i].row, other.row)) weight += other.weight;
            if (weight > most_weight) best = i, most_weight = weight;
        }
        return best;
    }

    const Column& from_;
    std::span<const T> values_;
    double similar_;
    SrgbCurve curve_;
    Array<T> result_;
};

template <class Source>
std::unique_ptr<ColumnWriter> writer_of(const Carried& carried, std::size_t rows, const Source& source,
                                        TransferParams::Method method, unsigned threads) {
    const Column& column = *carried.column;
    const bool is_blended = method == TransferParams::Method::blend && !carried.of_faces;
    if (is_blended && is_colour(column)) {
        const double similar = similar_colours(source, column, threads);
        if (column.type() == ScalarType::uint8) return std::make_unique<ColourColumn<u8>>(column, rows, similar);
        return std::make_unique<ColourColumn<std::uint16_t>>(column, rows, similar);
    }
    if (is_blended && is_float(column)) {
        if (column.type() == ScalarType::float32) return std::make_unique<MeanColumn<float>>(column, rows);
        return std::make_unique<MeanColumn<double>>(column, rows);
    }
    return std::make_unique<CopiedColumn>(carried, rows);
}

/// The outcome of a row; `transferred` is the value of the column of this name.
enum class Outcome : u8 { unknown, transferred, facing_away, filled };

const Column* filled_column(const ColumnTable& columns, const TransferParams& params) {
    const Column* filled = columns.find("filled");
    return !params.filled && filled && filled->components() == 1 ? filled : nullptr;
}

}  // namespace

template <class From, class To>
TransferResult<To> transfer(const From& from, const To& to, const TransferParams& params, Context& context) {
    if (params.max_distance && !(params.max_distance->value() > 0 && std::isfinite(params.max_distance->value())))
        throw Error("max-distance must be above 0; it is {:g} u", params.max_distance->value())
            .hint("`auto` is about 3 spacings of `from`");
    TransferResult<To> result;
    const std::vector<Carried> carried = carried_columns(from, params);
    const auto report = [&] {
        context.metric("transferred", static_cast<double>(result.transferred));
        context.metric("unknown", static_cast<double>(result.unknown));
        context.metric("filled", static_cast<double>(result.filled));
        context.metric("max-distance", result.max_distance, Unit::length);
    };
    if (carried.empty()) {
        warn_of_channels(from, context);
        result.result = to;
        report();
        return result;
    }
    require_source(from);
    require_target(to);
    for (const auto& [column, of_faces] : carried) {
        if constexpr (std::is_same_v<From, TriangleMesh>)
            require_rows(*column, of_faces ? from.triangles.size() : from.positions.size(),
                         of_faces ? "triangles" : "vertices");
        else
            require_rows(*column, from.size(), "points");
    }
    require_same_frame(from.frame, "`from` is", to.frame, "`to`");
    const unsigned threads = context.threads();
    std::optional<double> max_distance;
    if (params.max_distance) max_distance = params.max_distance->value();
    const auto source = samples_of(from, max_distance, threads);
    result.max_distance = source.max_distance();
    if (!(result.max_distance > 0))
        throw Error("the spacing of `from` is 0, so max-distance needs a value")
            .hint("give a length, such as `max-distance: 1 %diag`");
    context.check_cancelled();
    const Array<Vec3> normals = normals_of(to);
    const Vec3 shift = to.frame.origin - from.frame.origin;
    const std::size_t rows = to.positions.size();
    const Column* filled = filled_column(columns_of(to), params);
    std::vector<std::unique_ptr<ColumnWriter>> writers;
    for (const Carried& column : carried) writers.push_back(writer_of(column, rows, source, params.method, threads));
    Array<Outcome> outcomes(rows);
    std::atomic<std::size_t> done = 0;
    for_each_chunk(threads, rows, chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        Samples found;
        for (std::size_t row = begin; row < end; ++row) {
            if (filled && filled->number(row) == 1) {
                outcomes[row] = Outcome::filled;
            } else {
                source.find(to.positions[row] + shift, normals.empty() ? Vec3(Vec3::Zero()) : normals[row], found);
                outcomes[row] = found.nearest != no_row ? Outcome::transferred
                                : found.is_near         ? Outcome::facing_away
                                                        : Outcome::unknown;
            }
            for (const auto& writer : writers)
                outcomes[row] == Outcome::transferred ? writer->write(row, found) : writer->write_neutral(row);
        }
        context.progress(static_cast<double>(done += end - begin) / static_cast<double>(rows));
    });

    const auto count = [&](Outcome outcome) { return static_cast<std::size_t>(std::ranges::count(outcomes, outcome)); };
    result.transferred = count(Outcome::transferred);
    result.facing_away = count(Outcome::facing_away);
    result.filled = count(Outcome::filled);
    result.unknown = count(Outcome::unknown) + result.facing_away;
    if (result.transferred + result.facing_away == 0 && result.unknown > 0)
        throw Error("none of the {} of `to` is within {:.4g} u of `from`", count_text(result.unknown, "row", "rows"),
                    result.max_distance)
            .hint("check that both are in one place, or raise max-distance");
    if (result.filled == rows)
        context.doubt(fmt::format(
            "the column `filled` marks all of `to` ({}), so none has values; `filled: true` gives them values",
            count_text(rows, "row", "rows")));
    const std::size_t near = result.transferred + result.facing_away;
    if (static_cast<double>(result.facing_away) > doubtful_share * static_cast<double>(near))
        context.doubt(
            fmt::format("{} of the {} of `to` that are near `from` face away from it, and have no values; "
                        "one of the two may be inside out",
                        result.facing_away, count_text(near, "row", "rows")));
    result.result = to;
    Array<u8> marks(rows);
    std::ranges::transform(outcomes, marks.begin(), [](Outcome outcome) { return outcome == Outcome::transferred; });
    std::vector<Column> added;
    for (const auto& writer : writers) added.push_back(writer->finish());
    added.emplace_back(std::string(mark), 1, Buffer<u8>(std::move(marks)));
    ColumnTable columns;
    for (const Column& column : columns_of(to))
        if (std::ranges::find(added, column.name(), &Column::name) == added.end()) columns.add(column);
    for (Column& column : added) columns.add(std::move(column));
    columns_of(result.result) = std::move(columns);
    report();
    return result;
}

template TransferResult<PointCloud> transfer(const PointCloud&, const PointCloud&, const TransferParams&, Context&);
template TransferResult<PointCloud> transfer(const TriangleMesh&, const PointCloud&, const TransferParams&, Context&);
template TransferResult<TriangleMesh> transfer(const PointCloud&, const TriangleMesh&, const TransferParams&, Context&);
template TransferResult<TriangleMesh> transfer(const TriangleMesh&, const TriangleMesh&, const TransferParams&,
                                               Context&);

}  // namespace scanmill
