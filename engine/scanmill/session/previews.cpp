// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/session/previews.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "scanmill/base/error.hpp"
#include "scanmill/base/hash.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/batch/batch.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/graph/graph.hpp"
#include "scanmill/io/atomic_file.hpp"
#include "scanmill/io/mapped_file.hpp"
#include "scanmill/plan/pictures.hpp"
#include "scanmill/record/json.hpp"
#include "scanmill/run/run.hpp"
#include "scanmill/session/session.hpp"
#include "scanmill/worker/file_description.hpp"
#include "scanmill/worker/worker_processes.hpp"
#include "scanmill/worker/workers.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

/// Increases when previews of equal files change, other than by the filters.
constexpr std::string_view preview_scheme = "2";
constexpr std::string_view picture_size = "[320, 240]", size_on_paper = "[1200, 900]";
constexpr std::size_t most_triangles = 3000;
/// Only the number of triangles should end the simplification.
constexpr std::string_view largest_error = "5 %diag";
constexpr double share_of_first_pass = 5.0 / 6;  // share of the time limit
constexpr std::size_t wishes_per_run = 24;

constexpr std::string_view picture_end = ".png", deviation_end = "-deviation.png", mesh_end = ".ply",
                           note_end = ".json";

/// The content of KEY.json. It is written after the other files.
struct Note {
    std::string sha256;  ///< hash of the previewed file
    std::string read;  ///< name of this file if a run read it; empty for an output
    std::vector<std::string> files;  ///< names in the folder of previews
    double scale = 0;
    std::string reason;
};
constexpr auto fields(const Note*) {
    return std::tuple{field("sha256", &Note::sha256, "Hash of the previewed file."),
                      field("read", &Note::read, "Name of this file if a run read it.").optional(),
                      field("files", &Note::files), field("scale", &Note::scale).optional(),
                      field("reason", &Note::reason, "Why a file is missing.").optional()};
}

/// Empty for a file that cannot be read.
std::optional<Note> note_in(const fs::path& file) {
    try {
        Note note;
        read_json(Json::parse(MappedFile(file).bytes()), note);
        return note;
    } catch (const std::exception&) {
        return std::nullopt;
    }
}

/// The filters that make previews; null if none is installed.
struct Makers {
    const FilterSpec* draws = nullptr;
    const FilterSpec* simplifies = nullptr;
    const FilterSpec* measures = nullptr;
};

Makers makers_in(const FilterLibrary& library) {
    Makers makers;
    if (const std::vector<std::string> names = drawing_filters(library); !names.empty())
        makers.draws = library.find(names.front());
    for (const std::string& name : measuring_filters(library))
        if (!makers.measures && !library.find(name)->measures->deviation.empty()) makers.measures = library.find(name);
    for (const std::string& name : library.names()) {
        const FilterSpec& spec = *library.find(name);
        const auto is_fed = [&](const PortSpec& port) { return port.optional || port.name == spec.simplifies->value; };
        if (!makers.simplifies && spec.simplifies && std::ranges::all_of(spec.inputs, is_fed))
            makers.simplifies = &spec;
    }
    return makers;
}

/// A wish and its preview.
struct Item {
    PreviewWish wish;
    Preview preview;
    std::string truth;      ///< identifies truth and units; empty: no deviation is measured
    bool is_made = false;   ///< the folder has the preview
    bool is_usable = true;  ///< the file has the content that was recorded
    bool is_measured = false;  ///< the mesh of the preview has its deviation from the truth
    std::string name_if_read;  ///< name of the file if it is not an output
    bool is_stored = true;  ///< the note is written: the next call would come to the same result
    std::string lasting;    ///< reasons that hold until the key changes; they are part of the note

    /// Adds a reason that holds until the key changes.
    void miss(const std::string& reason) {
        add(reason, lasting);
        add(reason, preview.reason);
    }
    /// Adds the reason why an input of the preview is missing. The key depends on it.
    void lack(const std::string& reason) { add(reason, preview.reason); }
    /// Adds a reason that may be gone in the next call.
    void fail(const std::string& reason) {
        add(reason, preview.reason);
        is_stored = false;
    }

private:
    static void add(const std::string& reason, std::string& all) {
        if (all.find(reason) == std::string::npos) all += (all.empty() ? "" : "; ") + reason;
    }
};

double absolute_quantile(std::vector<double> values, double share) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::ranges::nth_element(values, at);
    return *at;
}

/// The number rounded up to two digits. Pre: above 0.
double rounded_up(double number) {
    const double step = std::pow(10, std::floor(std::log10(number)) - 1);
    double rounded = number;
    parse_number(fmt::format("{:.1e}", std::ceil(number / step - 1e-9) * step), rounded);
    return rounded;
}

const Column* deviation_column(const TriangleMesh& mesh) {
    for (const Column& column : mesh.vertex_columns)
        if (column.components() == 1 && column.length_exponent() == 1) return &column;
    return nullptr;
}

/// The absolute deviations of the finite vertices.
std::vector<double> deviations(const TriangleMesh& mesh) {
    std::vector<double> all;
    if (const Column* column = deviation_column(mesh))
        for (std::size_t row = 0; row < column->rows(); ++row)
            if (const double value = std::abs(column->number(row)); std::isfinite(value)) all.push_back(value);
    return all;
}

/// Makes the previews of one call.
class PreviewMaker {
public:
    PreviewMaker(const fs::path& folder, FilterLibrary& library, const PreviewSettings& settings)
        : folder_(previews_folder(folder)),
          library_(library),
          settings_(settings),
          makers_(makers_in(library)) {
        for (const FilterSpec* spec : {makers_.draws, makers_.simplifies, makers_.measures})
            versions_ += spec ? fmt::format("{} {}\n", spec->name, spec->version) : "none\n";
    }

    std::vector<Preview> previews(const std::vector<PreviewWish>& wishes) {
        for (const PreviewWish& wish : wishes) add(wish);
        std::vector<Item*> chunk;
        std::size_t missing = 0;
        for (const std::vector<Item*>& group : groups()) {
            chunk.insert(chunk.end(), group.begin(), group.end());
            missing += static_cast<std::size_t>(std::ranges::count(group, false, &Item::is_made));
            if (missing < wishes_per_run) continue;
            make(chunk);
            chunk.clear();
            missing = 0;
        }
        make(chunk);
        std::vector<Preview> all;
        for (const std::size_t index : index_of_wish_) all.push_back(items_[index].preview);
        return all;
    }

private:
    fs::path file(const Item& item, std::string_view end) const {
        return folder_ / (item.preview.key + std::string(end));
    }

    // Keys and existing previews.

    /// The hash of the file's bytes, with the number of the view if `name` is that of a view; empty, with a reason, if
    /// it cannot be read.
    std::string content(const fs::path& name, Item& item) {
        const FileView view = file_view(name);
        const auto [found, is_new] = contents_.try_emplace(view.file.string());
        if (is_new) try {
                if (const std::optional<Error> other = why_no_file(view.file)) throw *other;
                found->second.first = content_hash(view.file);
            } catch (const Error& error) {
                found->second.second = error.sentence();
            }
        if (!found->second.first.empty()) return fmt::format("{} {}", found->second.first, view.view);
        item.lack(found->second.second);
        return {};
    }

    void add(const PreviewWish& wish) {
        Item item;
        item.wish = wish;
        PreviewWish& own = item.wish;
        const FileView view = file_view(wish.file);
        KeyBuilder key;
        key.field("scheme", preview_scheme).field("versions", versions_);
        if (own.sha256.empty()) {
            item.name_if_read = view.file.filename().string();
            own.sha256 = sha256_of(view.file);  // empty: check_file() gives the reason
        }
        key.field("file", own.sha256)
            .field("extension", extension_of(view.file))
            .field("view", std::to_string(view.view))
            .field("unit", symbol(own.unit))
            .field("kind", own.kind ? name_of(*own.kind) : "");
        if (own.deviation) {
            key.field("column", own.deviation->column);
            for (const double end : {own.deviation->range[0], own.deviation->range[1], own.deviation->tolerance[0],
                                     own.deviation->tolerance[1]})
                key.field("end", number_text(end));
        }
        if (own.is_for_paper) key.field("for paper", size_on_paper);
        const bool may_measure =
            own.kind == kind_of<TriangleMesh>() && !own.deviation && makers_.measures && makers_.simplifies;
        if (!may_measure) own.truth_file.clear();
        if (!own.truth_file.empty()) {
            const std::string truth = content(own.truth_file, item);
            if (truth.empty())
                own.truth_file.clear();
            else
                item.truth = fmt::format("{} {} {}", truth, symbol(own.truth_unit), symbol(own.unit));
            key.field("truth", item.truth);
        }
        if (!makers_.draws || makers_.draws->draws->camera.empty()) own.camera_file.clear();
        if (!own.camera_file.empty()) {
            const std::string camera = content(own.camera_file, item);
            if (camera.empty()) own.camera_file.clear();
            key.field("camera", camera).field("camera unit", symbol(own.camera_unit));
        }
        item.preview.key = key.key();
        const auto [found, is_new] = index_of_key_.emplace(item.preview.key, items_.size());
        index_of_wish_.push_back(found->second);
        if (!is_new) return;
        find(item);
        if (!item.is_made) check_file(item);
        items_.push_back(std::move(item));
    }

    /// Takes the preview from the folder, if it is complete.
    void find(Item& item) const {
        std::error_code absent;
        if (!fs::is_regular_file(file(item, note_end), absent)) return;
        const std::optional<Note> found = note_in(file(item, note_end));
        if (!found) return;  // the preview is made again
        const Note& note = *found;
        const auto exists = [&](const std::string& name) { return fs::is_regular_file(folder_ / name, absent); };
        if (!std::ranges::all_of(note.files, exists)) return;
        item.is_made = true;
        if (!note.reason.empty()) item.miss(note.reason);
        item.preview.scale = note.scale;
        const auto set = [&](fs::path Preview::*part, std::string_view end) {
            if (std::ranges::find(note.files, item.preview.key + std::string(end)) != note.files.end())
                item.preview.*part = file(item, end);
        };
        set(&Preview::picture, picture_end);
        set(&Preview::deviation, deviation_end);
        set(&Preview::mesh, mesh_end);
        // A picture that failed is not tried again.
        item.is_measured = !item.wish.deviation && !item.preview.deviation.empty();
    }

    /// Checks that the file has the content that was recorded.
    static void check_file(Item& item) {
        const fs::path path = file_view(item.wish.file).file;
        try {
            if (const std::optional<Error> other = why_no_file(path)) throw *other;
            const std::string found = sha256_of(path);
            if (found.empty()) throw Error("'{}' cannot be read", path.string());
            if (found == item.wish.sha256) return;
            item.fail(fmt::format("'{}' has changed since it was recorded", path.string()));
        } catch (const Error& error) {
            item.fail(error.sentence());
        }
        item.is_usable = false;
    }

    /// The items of each truth. An item without a truth is a group of its own.
    std::vector<std::vector<Item*>> groups() {
        std::vector<std::vector<Item*>> all;
        std::map<std::string, std::size_t> group_of_truth;
        for (Item& item : items_) {
            if (item.truth.empty()) {
                all.push_back({&item});
                continue;
            }
            const auto [found, is_new] = group_of_truth.emplace(item.truth, all.size());
            if (is_new) all.emplace_back();
            all[found->second].push_back(&item);
        }
        return all;
    }

    // Making.

    void make(const std::vector<Item*>& chunk) {
        std::vector<Item*> missing;
        for (Item* item : chunk)
            if (!item->is_made && item->is_usable) missing.push_back(item);
        run(
            missing, share_of_first_pass, [&](Item& item, const fs::path& made) { return part_of_file(item, made); },
            [&](Item& item, const fs::path& made) { take_files(item, made); });
        const std::vector<Item*> to_draw = choose_scales(chunk);
        run(
            to_draw, 1 - share_of_first_pass,
            [&](Item& item, const fs::path& made) { return part_of_deviation(item, made); },
            [&](Item& item, const fs::path& made) {
                publish(item, &Preview::deviation, made / "deviation.png", deviation_end);
            });
        for (Item* item : chunk)
            if ((!item->is_made && item->is_usable) || std::ranges::find(to_draw, item) != to_draw.end())
                write_note(*item);
    }

    /// Makes the workflow for an item, with outputs in a folder of the item's own below `folder`; nullopt if there is
    /// nothing to make.
    using MakePart = std::function<std::optional<GraphPart>(Item& item, const fs::path& folder)>;
    /// Takes what was made from the item's own folder.
    using Take = std::function<void(Item& item, const fs::path& folder)>;

    /// Runs one workflow for each item and takes its outputs.
    void run(const std::vector<Item*>& items, double share_of_time, const MakePart& make_part, const Take& take) {
        if (items.empty()) return;
        try {
            const ScratchFolder scratch;
            const fs::path folder = scratch.folder("previews");
            std::vector<GraphPart> parts;
            std::vector<Item*> item_of_cell;
            for (Item* item : items)
                if (std::optional<GraphPart> part = make_part(*item, folder)) {
                    parts.push_back(std::move(*part));
                    item_of_cell.push_back(item);
                }
            if (parts.empty()) return;
            const RunGraph graph = make_graph(parts, library_);
            const RunReport report = run_graph(graph, share_of_time);
            for (std::size_t cell = 0; cell < item_of_cell.size(); ++cell) {
                Item& item = *item_of_cell[cell];
                explain(item, graph, report, cell);
                try {
                    take(item, folder / item.preview.key);
                } catch (const Error& error) {
                    item.fail(error.sentence());
                }
            }
        } catch (const Error& error) {
            for (Item* item : items) item->fail(error.sentence());
        }
    }

    RunReport run_graph(const RunGraph& graph, double share_of_time) {
        const u64 held = available_memory() / std::max<u64>(1, memory_need(graph));
        const auto jobs = static_cast<unsigned>(
            std::clamp<u64>(std::min<u64>(held, graph.cells.size()), 1, std::max(1u, settings_.jobs)));
        RunSettings running;
        running.threads = settings_.threads > 0 ? settings_.threads : std::max(1u, usable_cores() / jobs);
        running.limits.cell_seconds = settings_.seconds * share_of_time;
        running.is_cancelled = settings_.is_cancelled;
        if (settings_.jobs == 0 || settings_.worker_command.empty()) {
            InProcessWorker worker(library_, nullptr, KeepRule::Policy::never, settings_.is_cancelled);
            return scanmill::run(library_, graph, worker, running);
        }
        WorkerProcessSettings workers;
        workers.command = settings_.worker_command;
        workers.count = jobs;
        WorkerProcesses processes(std::move(workers));
        processes.start_early();  // throws an Error that does not count as a failure of the files
        return scanmill::run(library_, graph, processes, running);
    }

    /// Adds the reasons of the cell's failures.
    static void explain(Item& item, const RunGraph& graph, const RunReport& report, std::size_t cell) {
        if (report.interrupted && report.cells[cell].outcome >= Outcome::failed)
            return item.fail("the preview was not completed, because the call was cancelled");
        const Failure& whole = report.cells[cell].failure;
        bool is_explained = false;
        for (const std::size_t node : graph.cells[cell].nodes) {
            const Failure& failure = report.nodes[node].failure;
            if (!failure) continue;
            is_explained = true;
            const std::string what = graph.nodes[node].step ? graph.label(graph.nodes[node]) + ": " : "";
            item.miss(what + failure.error.sentence());
        }
        if (is_explained || !whole) return;
        if (whole.cause == Cause::output)
            item.fail(whole.error.sentence());
        else
            item.miss(whole.error.sentence());
    }

    // The workflow that draws, simplifies and measures a file.

    struct Source {
        std::string name;  ///< name of the workflow's input
        Kind kind;
        std::vector<Kind> also;
    };

    static Source mesh_or_points(std::string name) {
        return {std::move(name), kind_of<TriangleMesh>(), {kind_of<PointCloud>()}};
    }

    static void add_input(Workflow& workflow, Source source) {
        WorkflowInput& input = workflow.inputs.emplace_back();
        input.name = std::move(source.name);
        input.kind = source.kind;
        input.also = std::move(source.also);
        input.by_name = true;
    }

    using Texts = std::vector<std::pair<std::string, std::string>>;

    /// Adds a step. `inputs`: port and source. `parameters`: name and text; those without a name are left out.
    static void add_step(Workflow& workflow, const std::string& filter, std::string id, const Texts& inputs,
                         const Texts& parameters) {
        StepSyntax& step = std::get<StepSyntax>(workflow.steps.emplace_back().item);
        step.filter = filter;
        step.id = std::move(id);
        for (const auto& [port, source] : inputs) step.in.push_back({port, {}, {{source, {}}}});
        Diagnostics diagnostics("");
        for (const auto& [name, text] : parameters)
            if (!name.empty()) step.parameters.push_back({name, {}, parse_value_expression(text, diagnostics)});
    }

    static void add_output(Workflow& workflow, const Item& item, const char* file, std::string source) {
        workflow.outputs.push_back({item.preview.key + "/" + file, {}, {std::move(source), {}}});
    }

    /// The parameters of a picture that shows the deviations of the file.
    Texts colours_of(const FileDeviation& deviation) const {
        const DrawSpec& draws = *makers_.draws->draws;
        const auto lengths = [](const std::array<double, 2>& two) {
            return fmt::format("[{} u, {} u]", number_text(two[0]), number_text(two[1]));
        };
        return {{draws.colour, deviation.column},
                {draws.scale, lengths(deviation.range)},
                {draws.tolerance, lengths(deviation.tolerance)}};
    }

    /// Adds a step that draws the input `scene`, with the camera of the wish.
    void add_picture(Workflow& workflow, const Item& item, std::string id, const std::string& scene, Texts parameters,
                     ScanFile& scan) const {
        const DrawSpec& draws = *makers_.draws->draws;
        Texts inputs{{draws.value, scene}};
        if (!item.wish.camera_file.empty()) {
            add_input(workflow, mesh_or_points("camera"));
            inputs.emplace_back(draws.camera, "camera");
            add_file(scan, "camera", item.wish.camera_file, item.wish.camera_unit);
        }
        parameters.emplace_back(draws.size, item.wish.is_for_paper ? size_on_paper : picture_size);
        add_step(workflow, makers_.draws->name, std::move(id), inputs, parameters);
    }

    static void add_file(ScanFile& scan, const std::string& input, const fs::path& file, LengthUnit unit) {
        ScanFile& added = scan.inputs[input].emplace_back(file);
        added.unit = unit;
        added.invalid = InvalidRows::drop;
    }

    GraphPart part(Workflow workflow, ScanFile scan, const fs::path& folder) const {
        workflow.name = "preview";
        Diagnostics diagnostics("");
        auto plan = std::make_shared<const Plan>(make_plan(std::move(workflow), library_, {}, diagnostics));
        if (diagnostics.has_errors()) throw Error("previews cannot be made: {}", diagnostics.sorted().front().message);
        RunRequest request;
        request.scans.push_back(std::move(scan));
        request.output_folder = folder;
        return {std::move(plan), std::move(request)};
    }

    std::optional<GraphPart> part_of_file(Item& item, const fs::path& folder) {
        const bool is_mesh = item.wish.kind == kind_of<TriangleMesh>();
        Workflow workflow;
        add_input(workflow, item.wish.kind ? Source{"file", *item.wish.kind, {}} : mesh_or_points("file"));
        ScanFile scan(item.wish.file);
        scan.unit = item.wish.unit;
        if (!item.wish.kind || item.wish.kind == kind_of<PointCloud>()) scan.invalid = InvalidRows::drop;
        const Kind kind = workflow.inputs.front().kind;
        if (makers_.draws && makers_.draws->input(makers_.draws->draws->value)->takes(kind)) {
            if (!item.wish.is_for_paper) {
                add_picture(workflow, item, "picture", "file", {}, scan);
                add_output(workflow, item, "picture.png", "picture");
            }
            if (item.wish.deviation) {
                add_picture(workflow, item, "deviation-picture", "file", colours_of(*item.wish.deviation), scan);
                add_output(workflow, item, "deviation.png", "deviation-picture");
            }
        } else {
            item.miss(fmt::format("no installed filter draws {}", name_of(kind)));
        }
        if (is_mesh && !item.wish.is_for_paper && makers_.simplifies) {
            const SimplifySpec& simplifies = *makers_.simplifies->simplifies;
            add_step(workflow, makers_.simplifies->name, "simplified", {{simplifies.value, "file"}},
                     {{simplifies.triangles, std::to_string(most_triangles)},
                      {simplifies.max_error, std::string(largest_error)}});
            add_output(workflow, item, "simplified.ply", "simplified");
        } else if (is_mesh && !item.wish.is_for_paper) {
            item.miss("no installed filter simplifies meshes");
        }
        if (!item.truth.empty()) {
            const MeasureSpec& measures = *makers_.measures->measures;
            const PortSpec& port = *makers_.measures->input(measures.truth);
            add_input(workflow, {"truth", port.kind, port.also});
            add_file(scan, "truth", item.wish.truth_file, item.wish.truth_unit);
            add_step(workflow, makers_.measures->name, "deviation",
                     {{measures.value, "simplified"}, {measures.truth, "truth"}}, {});
            add_output(workflow, item, "deviation.ply", "deviation." + measures.deviation);
        }
        if (workflow.steps.empty()) return std::nullopt;
        return part(std::move(workflow), std::move(scan), folder);
    }

    void take_files(Item& item, const fs::path& made) {
        publish(item, &Preview::picture, made / "picture.png", picture_end);
        publish(item, &Preview::deviation, made / "deviation.png", deviation_end);
        std::error_code absent;
        const bool is_measured = fs::exists(made / "deviation.ply", absent);
        const fs::path file = made / (is_measured ? "deviation.ply" : "simplified.ply");
        if (!fs::exists(file, absent)) return;
        const auto mesh = read_mesh(file);
        if (mesh->triangles.size() > most_triangles)
            return item.miss(fmt::format("the simplified mesh has {} triangles; expected at most {}",
                                         mesh->triangles.size(), most_triangles));
        TriangleMesh light;
        light.frame = mesh->frame;
        light.positions = mesh->positions;
        light.triangles = mesh->triangles;
        const std::string wished = item.wish.deviation ? item.wish.deviation->column
                                   : is_measured       ? makers_.measures->measures->column
                                                       : "";
        if (const Column* column = mesh->vertex_columns.find(wished)) {
            light.vertex_columns.add(*column);
            item.is_measured = is_measured;
        }
        const fs::path target = this->file(item, mesh_end);
        write_file(target, Value(std::make_shared<const TriangleMesh>(without_unused_vertices(light))));
        item.preview.mesh = target;
    }

    /// Copies a file into the folder of previews, if it was made.
    void publish(Item& item, fs::path Preview::*part, const fs::path& made, std::string_view end) const {
        std::error_code absent;
        if (!fs::exists(made, absent)) return;
        const fs::path target = file(item, end);
        AtomicFile copy(target);
        copy.write(MappedFile(made).bytes());
        copy.commit();
        item.preview.*part = target;
    }

    // The scale of the deviations from one truth, and the pictures with it.

    /// Sets the scale of all items with a deviation, and returns those whose picture must be drawn.
    std::vector<Item*> choose_scales(const std::vector<Item*>& chunk) {
        std::vector<Item*> to_draw;
        if (!makers_.draws || makers_.draws->draws->colour.empty() || makers_.draws->draws->scale.empty())
            return to_draw;
        std::map<std::string, std::vector<Item*>> items_of_truth;
        for (Item* item : chunk)
            if (item->is_measured && !item->preview.mesh.empty()) items_of_truth[item->truth].push_back(item);
        for (const auto& [truth, items] : items_of_truth) {
            const auto drawn = std::ranges::find_if(items, [](const Item* item) { return item->preview.scale > 0; });
            const double scale = drawn != items.end() ? (*drawn)->preview.scale : scale_of(items);
            for (Item* item : items) {
                if (item->preview.scale == scale || scale == 0) continue;
                item->preview.scale = scale;
                item->preview.deviation.clear();
                to_draw.push_back(item);
            }
        }
        return to_draw;
    }

    /// The scale for new pictures; 0 if no mesh has a deviation.
    static double scale_of(const std::vector<Item*>& items) {
        constexpr double per_quantile = 1.5;
        std::vector<double> quantiles;
        double diagonal = 0;
        for (Item* item : items) try {
                const auto mesh = read_mesh(item->preview.mesh);
                if (std::vector<double> all = deviations(*mesh); !all.empty())
                    quantiles.push_back(absolute_quantile(std::move(all), 0.95));
                diagonal = std::max(diagonal, surface_box(*mesh).diagonal());
            } catch (const Error& error) {
                item->fail(error.sentence());
            }
        if (quantiles.empty()) return 0;
        // Deviations that are all 0 need a scale, too.
        return rounded_up(std::max(per_quantile * absolute_quantile(std::move(quantiles), 0.5), 1e-6 * diagonal));
    }

    GraphPart part_of_deviation(Item& item, const fs::path& folder) const {
        const DrawSpec& draws = *makers_.draws->draws;
        const double scale = item.preview.scale;
        Workflow workflow;
        add_input(workflow, {"file", kind_of<TriangleMesh>(), {}});
        ScanFile scan(item.preview.mesh);
        add_picture(workflow, item, "deviation-picture", "file",
                    {{draws.colour, makers_.measures->measures->column},
                     {draws.scale, fmt::format("[{} u, {} u]", number_text(-scale), number_text(scale))}},
                    scan);
        add_output(workflow, item, "deviation.png", "deviation-picture");
        return part(std::move(workflow), std::move(scan), folder);
    }

    // The note that completes a preview.

    void write_note(Item& item) const {
        const Preview& preview = item.preview;
        std::error_code ignored;
        if (preview.deviation.empty()) {
            item.preview.scale = 0;
            fs::remove(file(item, deviation_end), ignored);  // with another scale
        }
        if (!item.is_stored) {
            fs::remove(file(item, note_end), ignored);
            return;
        }
        Note note;
        note.sha256 = item.wish.sha256;
        note.read = item.name_if_read;
        for (const fs::path& part : {preview.picture, preview.deviation, preview.mesh})
            if (!part.empty()) note.files.push_back(part.filename().string());
        note.scale = preview.scale;
        note.reason = item.lasting;
        try {
            AtomicFile target(file(item, note_end));
            target.write(json_of(note).dump(2) + "\n");
            target.commit();
        } catch (const Error& error) {
            item.fail(error.sentence());
        }
    }

    const fs::path folder_;
    FilterLibrary& library_;
    const PreviewSettings& settings_;
    const Makers makers_;
    std::string versions_;
    std::map<std::string, std::pair<std::string, std::string>> contents_;  // hash and error, by path
    std::vector<Item> items_;
    std::map<std::string, std::size_t> index_of_key_;
    std::vector<std::size_t> index_of_wish_;
};

/// KEY of the name of a preview's file; empty for other files.
std::string key_of_name(const std::string& name) {
    constexpr std::size_t digits = 32;
    if (name.size() < digits || name.find_first_not_of("0123456789abcdef") < digits) return {};
    const std::string_view end = std::string_view(name).substr(digits);
    return end == picture_end || end == deviation_end || end == mesh_end || end == note_end ? name.substr(0, digits)
                                                                                            : std::string();
}

std::uint16_t quantised(double share) {
    constexpr double most = std::numeric_limits<std::uint16_t>::max();
    return static_cast<std::uint16_t>(std::lround(std::clamp(share, 0.0, 1.0) * most));
}

}  // namespace

fs::path previews_folder(const fs::path& folder) { return folder / "previews"; }

std::vector<Preview> make_previews(const fs::path& folder, const std::vector<PreviewWish>& wishes,
                                   FilterLibrary& library, const PreviewSettings& settings,
                                   const std::function<void(std::string)>& warn) {
    if (wishes.empty()) return {};
    try {
        std::error_code trouble;
        fs::create_directories(previews_folder(folder), trouble);
        if (trouble) throw Error("'{}' cannot be created: {}", previews_folder(folder).string(), trouble.message());
        return PreviewMaker(folder, library, settings).previews(wishes);
    } catch (const Error& error) {
        if (warn) warn(fmt::format("no previews are made: {}", error.sentence()));
        std::vector<Preview> none(wishes.size());
        for (Preview& preview : none) preview.reason = error.sentence();
        return none;
    }
}

std::vector<fs::path> unused_previews(const fs::path& folder, const std::set<std::string>& outputs,
                                      const std::set<std::string>& read) {
    std::error_code ignored;
    std::set<std::string> used;  // keys
    std::vector<fs::path> unused;
    for (const auto& entry : fs::directory_iterator(previews_folder(folder), ignored)) {
        const std::string name = entry.path().filename().string(), key = key_of_name(name);
        if (key.empty() || !name.ends_with(note_end)) continue;
        const std::optional<Note> note = note_in(entry.path());
        if (note && (outputs.contains(note->sha256) || read.contains(note->read))) used.insert(key);
    }
    for (const auto& entry : fs::directory_iterator(previews_folder(folder), ignored))
        if (const std::string key = key_of_name(entry.path().filename().string()); !key.empty() && !used.contains(key))
            unused.push_back(entry.path());
    // Without its note, a preview is incomplete and made again.
    std::ranges::sort(unused, {}, [](const fs::path& path) { return std::pair(path.extension() != note_end, path); });
    return unused;
}

QuantisedMesh quantised(const fs::path& file) {
    const auto mesh = read_mesh(file);
    QuantisedMesh result;
    result.unit = mesh->frame.unit;
    const BoundingBox box = surface_box(*mesh);
    result.low = mesh->frame.origin + box.low;
    result.high = mesh->frame.origin + box.high;
    for (const Vec3& position : mesh->positions)
        for (int axis = 0; axis < 3; ++axis) {
            const double extent = box.high[axis] - box.low[axis];
            result.positions.push_back(extent > 0 ? quantised((position[axis] - box.low[axis]) / extent)
                                                  : std::uint16_t{0});
        }
    for (const Triangle& triangle : mesh->triangles)
        result.triangles.insert(result.triangles.end(), triangle.begin(), triangle.end());
    const Column* column = deviation_column(*mesh);
    if (!column) return result;
    for (const double each : deviations(*mesh)) result.range = std::max(result.range, each);
    for (std::size_t row = 0; row < column->rows(); ++row) {
        const double value = column->number(row);
        const double place = result.range > 0 ? 0.5 + value / (2 * result.range) : 0.5;
        result.deviation.push_back(std::isfinite(value)
                                       ? static_cast<std::uint16_t>(std::lround(std::clamp(place, 0.0, 1.0) *
                                                                                (QuantisedMesh::no_deviation - 1)))
                                       : QuantisedMesh::no_deviation);
    }
    return result;
}

}  // namespace scanmill
