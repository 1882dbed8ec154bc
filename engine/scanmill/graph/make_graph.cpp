// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "scanmill/base/error.hpp"
#include "scanmill/base/hash.hpp"
#include "scanmill/formats/common/format.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/graph/graph.hpp"
#include "scanmill/graph/output_files.hpp"
#include "scanmill/io/mapped_file.hpp"
#include "scanmill/plan/step_parameters.hpp"
#include "scanmill/plugin/module.hpp"
#include "scanmill/workflow/grammar.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

/// Increases when the meaning of a plan key or of a value's content name changes.
constexpr std::string_view key_scheme = "6";

/// The hashes of the builds that read files: the core, and the modules of formats.
std::string builds_of_readers(const std::string& core) {
    std::string builds = core;
    for (std::filesystem::path module : module_manifests(installed_format_folder())) {
        std::error_code absent;
        if (module.replace_extension(".so"); std::filesystem::is_regular_file(module, absent))
            builds += " " + content_hash(module);
    }
    return builds;
}

std::string text_of(const RigidTransform& pose) {
    std::string text = fmt::format("{} {} {}", symbol(pose.unit), pose.from, pose.to);
    for (const double number : pose.rotation.reshaped()) text += fmt::format(" {:a}", number);
    for (const double number : pose.translation) text += fmt::format(" {:a}", number);
    return text;
}

/// The part of plan keys that is equal for all nodes of a graph. A plan key contains filter, version, builds,
/// parameters, unit, seed and the keys of everything upstream, but no thread count, path or step name.
struct KeyBase {
    std::string core;     ///< build of the core
    std::string readers;  ///< builds of everything that reads files
    std::uint64_t seed = 0;
};

KeyBase key_base(std::uint64_t seed) {
    const std::string core = content_hash(core_library_file());
    return {core, builds_of_readers(core), seed};
}

std::string key_of_leaf(const LeafSource& leaf, const KeyBase& base) {
    KeyBuilder key;
    key.field("scheme", key_scheme)
        .field("content", leaf.content)
        .field("readers", base.readers)
        .field("extension", extension_of(leaf.file))  // readers may depend on it
        .field("kind", name_of(leaf.kind))
        .field("unit", symbol(leaf.unit))
        .field("frame", leaf.frame)
        .field("pose", leaf.pose ? text_of(*leaf.pose) : leaf.refusal.sentence)
        .field("invalid", name_of(leaf.invalid));
    if (leaf.view > 0) key.field("view", std::to_string(leaf.view));
    for (const Kind kind : leaf.also) key.field("also", name_of(kind));
    return key.key();
}

struct StepKeys {
    std::string code;  ///< RunNode::code
    std::string plan;  ///< RunNode::key
};

/// `module`: build of the step's filter. `inputs`: ports with the keys of their sources.
StepKeys keys_of_step(const PlannedStep& step, const std::string& module, const KeyBase& base,
                      const std::function<std::string(const std::filesystem::path&)>& content,
                      const std::vector<std::pair<std::string, std::string>>& inputs) {
    KeyBuilder key;
    key.field("scheme", key_scheme)
        .field("filter", step.spec.name)
        .field("version", std::to_string(step.spec.version))
        .field("module", module)
        .field("core", base.core)
        .field("seed", std::to_string(base.seed));
    for (const auto& [name, value] : step.parameters.values)
        if (names_files(step.spec, name)) key.field("parameter " + name, key_text_of_paths(value, content));
    const std::string code = key.key();
    for (const auto& [name, value] : step.parameters.values)
        if (!names_files(step.spec, name)) key.field("parameter " + name, canonical_text(value));
    for (const auto& [port, from] : inputs) key.field("port " + port, from);
    return {code, key.key()};
}

/// The content of the files that a graph reads. Hashes each file once.
class FileContents {
public:
    struct Content {
        std::string hash;  ///< hash of the file's bytes; unique for a file that cannot be read
        std::string why_unreadable;  ///< error and hint; empty for a readable file
    };

    explicit FileContents(const HashOfFile& hash) : hash_(hash) {}

    const Content& of(const fs::path& file) {
        const auto [found, is_new] = contents_.try_emplace(file.string());
        Content& content = found->second;
        if (!is_new) return content;
        try {
            if (const std::optional<Error> other = why_no_file(file)) throw *other;
            content.hash = hash_(file);
        } catch (const Error& error) {
            content = {"unreadable " + file.string(),
                       error.sentence() + (error.hint().empty() ? "" : "; " + error.hint())};
        }
        return content;
    }

private:
    const HashOfFile& hash_;
    std::map<std::string, Content> contents_;  // by path
};

class GraphBuilder {
public:
    GraphBuilder(const std::vector<GraphPart>& parts, FilterLibrary& library, const HashOfFile& hash)
        : contents_(hash),
          library_(library),
          parts_(parts),
          base_(key_base(parts.front().request.seed)),
          output_files_(parts.front().request.output_folder) {
        graph_.seed = parts.front().request.seed;
        graph_.output_folder = output_files_.folder();
    }

    RunGraph build() {
        for (const GraphPart& part : parts_) {
            require_fits(part.request, *part.plan);
            protect_inputs(part);
        }
        for (const GraphPart& part : parts_) add_part(part);
        mark_streams(graph_);
        return std::move(graph_);
    }

private:
    void protect_inputs(const GraphPart& part) {
        output_files_.protect(part.plan->workflow.file);
        for (const ScanFile& scan : part.request.scans) {
            output_files_.protect(scan.path);
            for (const ScanFile& view : scan.views) output_files_.protect(view.path);
            for (const auto& [name, files] : scan.inputs)
                for (const ScanFile& file : files) output_files_.protect(file.path);
        }
        for (const auto& [name, files] : part.request.inputs)
            for (const fs::path& file : files) output_files_.protect(file);
        for (const fs::path& file : part.request.protected_files) output_files_.protect(file);
        for (const PlannedStep& step : part.plan->steps)
            for (const auto& [name, value] : step.parameters.values)
                if (names_files(step.spec, name))
                    key_text_of_paths(value, [this](const fs::path& file) {
                        output_files_.protect(file);
                        return std::string();
                    });
    }

    void add_part(const GraphPart& part) {
        plan_ = part.plan.get();
        request_ = &part.request;
        graph_.plans.push_back(part.plan);
        const std::vector<WorkflowInput>& inputs = plan_->workflow.inputs;
        const bool has_objects = !request_->scans.empty() && !request_->scans.front().views.empty();
        if (inputs.empty() || (inputs.front().list && !has_objects)) {
            add_cells(scan_index(workflow_name(*plan_)), nullptr);
            return;
        }
        for (const ScanFile& scan : request_->scans) add_cells(scan_index(scan.path.string()), &scan);
    }

    /// The index of the scan in RunGraph::scan_names. Parts that name the same scan share one index.
    std::size_t scan_index(const std::string& name) {
        const auto [found, is_new] = scan_of_name_.emplace(name, graph_.scan_names.size());
        if (is_new) graph_.scan_names.push_back(name);
        return found->second;
    }

    /// `file`: the scan or the object; null if the workflow has no scan, or all scans as a list.
    void add_cells(std::size_t scan, const ScanFile* file) {
        const std::string& scan_name = graph_.scan_names[scan];
        for (std::size_t variant = 0; variant < plan_->variants.size(); ++variant) {
            const PlannedVariant& planned = plan_->variants[variant];
            if (!request_->only.empty() && std::ranges::find(request_->only, planned.name) == request_->only.end())
                continue;
            if (!request_->until.empty() && !planned.steps_by_name.contains(request_->until)) continue;
            RunCell cell{graph_.plans.size() - 1, scan, variant, {}, {}};
            std::map<std::size_t, std::size_t> node_of_step;
            for (const std::size_t step : steps_to_run(planned)) {
                node_of_step[step] = add_step(step, node_of_step, scan, file, cell);
                add_to(cell, node_of_step[step]);
            }
            const std::string name_of_scan = !file                 ? scan_name
                                             : file->views.empty() ? stem_of(file->path)
                                                                   : file->path.filename().string();
            const TemplateValues values{name_of_scan, planned.name, workflow_name(*plan_),
                                        file ? folder_name(file->path) : scan_name};
            for (const auto& [name, source] : outputs(planned)) {
                if (source.step && !node_of_step.contains(*source.step))
                    continue;  // the output's step comes after the last step to run
                const std::size_t node = sources_of(source, node_of_step, scan, file, cell).front();
                const std::string writer = cell_text(scan_name, planned.name, parts_.size() > 1 ? values.workflow : "");
                const std::string content = fmt::format("{} {} {}", node, scan, plan_->workflow.file);
                const fs::path target =
                    output_files_.add(expand_template(name, values), {content, source.port}, writer, values);
                output_files_.add(description_of(expand_template(name, values)), {content, source.port + " described"},
                                  writer, values);
                cell.outputs.push_back({target, node, source.port});
            }
            graph_.cells.push_back(std::move(cell));
        }
    }

    std::vector<std::size_t> steps_to_run(const PlannedVariant& variant) const {
        const auto last = variant.steps_by_name.find(request_->until);
        if (last == variant.steps_by_name.end()) return variant.steps;
        const auto end = std::ranges::find(variant.steps, last->second);
        return {variant.steps.begin(), end == variant.steps.end() ? end : end + 1};
    }

    /// The variant's outputs and the steps to save, as file templates.
    std::vector<std::pair<std::string, ValueSource>> outputs(const PlannedVariant& variant) const {
        std::vector<std::pair<std::string, ValueSource>> all;
        for (const PlannedOutput& output : variant.outputs) all.emplace_back(output.file, output.source);
        for (const std::string& wanted : request_->save) {
            const std::size_t dot = wanted.find('.');
            const auto step = variant.steps_by_name.find(wanted.substr(0, dot));
            if (step == variant.steps_by_name.end()) continue;  // a step of another variant
            const FilterSpec& spec = plan_->steps[step->second].spec;
            const std::string port = dot == std::string::npos ? spec.outputs.front().name : wanted.substr(dot + 1);
            if (!spec.output(port)) throw Error("the step to save, '{}', has no output port '{}'", wanted, port);
            const Kind kind = spec.output(port)->kind;
            const std::string extensions = writable_extensions(kind);
            if (extensions.empty())
                throw Error("the step to save, '{}', gives {}, which no file format can hold", wanted, name_of(kind));
            const std::string variant_part = plan_->variants.size() > 1 ? ".{variant}" : "";
            all.emplace_back("{scan}" + variant_part + "." + wanted + "." + extensions.substr(0, extensions.find(',')),
                             ValueSource{step->second, 0, port});
        }
        return all;
    }

    std::size_t add_step(std::size_t step, const std::map<std::size_t, std::size_t>& node_of_step, std::size_t scan,
                         const ScanFile* file, RunCell& cell) {
        const PlannedStep& planned = plan_->steps[step];
        RunNode node;
        node.plan = graph_.plans.size() - 1;
        node.step = step;
        node.scan = scan;
        const auto content = [&](const fs::path& parameter) {
            const FileContents::Content& found = contents_.of(parameter);
            node.parameter_files.push_back({parameter, found.hash});
            node.is_uncacheable = node.is_uncacheable || !found.why_unreadable.empty();
            return found.hash;
        };
        std::vector<std::pair<std::string, std::string>> ports;
        for (const PlannedInput& input : planned.inputs)
            for (const ValueSource& source : input.sources)
                for (const std::size_t from : sources_of(source, node_of_step, scan, file, cell)) {
                    node.inputs.push_back({input.port, from, source.port});
                    node.is_uncacheable = node.is_uncacheable || graph_.nodes[from].is_uncacheable;
                    ports.emplace_back(input.port, graph_.nodes[from].key + "." + source.port);
                }
        const StepKeys keys = keys_of_step(planned, library_.build_id(planned.spec.name), base_, content, ports);
        node.code = keys.code;
        node.key = keys.plan;
        return add_node(std::move(node));
    }

    std::vector<std::size_t> sources_of(const ValueSource& source,
                                        const std::map<std::size_t, std::size_t>& node_of_step, std::size_t scan,
                                        const ScanFile* file, RunCell& cell) {
        if (source.step) return {node_of_step.at(*source.step)};
        const WorkflowInput& input = plan_->workflow.inputs[source.input];
        if (source.input == 0 && !input.list) return {add_leaf(0, scan, *file, cell)};
        std::vector<ScanFile> files = source.input > 0 ? files_of(input.name, file)
                                      : file           ? file->views
                                                       : request_->scans;
        if (input.list) files = views_of(files);
        std::vector<std::size_t> leaves;
        for (const ScanFile& each : files) leaves.push_back(add_leaf(source.input, scan, each, cell));
        return leaves;
    }

    /// The files of an input other than the first. Pre: require_fits() did not throw.
    std::vector<ScanFile> files_of(const std::string& input, const ScanFile* file) const {
        if (const auto common = request_->inputs.find(input); common != request_->inputs.end())
            return {common->second.begin(), common->second.end()};
        return (file ? *file : request_->scans.front()).inputs.at(input);
    }

    /// The files, with every view of a file in place of the file.
    std::vector<ScanFile> views_of(const std::vector<ScanFile>& files) {
        std::vector<ScanFile> views;
        for (const ScanFile& file : files) {
            if (file_view(file.path).view > 0) {
                views.push_back(file);
                continue;
            }
            const auto [found, is_new] = views_in_.try_emplace(file.path.string(), 1);
            if (is_new) found->second = count_views(file.path);
            for (u32 view = 1; view <= found->second; ++view) {
                views.push_back(file);
                if (found->second > 1) views.back().path = view_name(file.path, view);
            }
        }
        return views;
    }

    std::size_t add_leaf(std::size_t input, std::size_t scan, const ScanFile& file, RunCell& cell) {
        const WorkflowInput& declared = plan_->workflow.inputs[input];
        RunNode node;
        node.plan = graph_.plans.size() - 1;
        node.is_scan = input == 0;
        node.scan = scan;
        const FileView source = file_view(file.path);
        node.leaf.file = source.file;
        node.leaf.view = source.view;
        const FileContents::Content& content = contents_.of(source.file);
        node.leaf.content = content.hash;
        node.unreadable = !content.why_unreadable.empty() ? content.why_unreadable : file.refusal.text();
        node.leaf.kind = declared.kind;
        node.leaf.also = declared.also;
        node.leaf.unit = file.unit != LengthUnit::unknown        ? file.unit
                         : request_->unit != LengthUnit::unknown ? request_->unit
                                                                 : declared.unit;
        node.leaf.frame = with_stem(!file.frame.empty() ? file.frame : declared.frame, file.path);
        node.leaf.pose = file.pose;
        node.leaf.refusal = file.refusal;
        if (declared.kind == kind_of<PointCloud>() ||
            std::ranges::find(declared.also, kind_of<PointCloud>()) != declared.also.end())
            node.leaf.invalid = file.invalid != InvalidRows::by_format        ? file.invalid
                                : request_->invalid != InvalidRows::by_format ? request_->invalid
                                                                              : declared.invalid;
        node.is_uncacheable = !node.unreadable.empty();
        node.key = key_of_leaf(node.leaf, base_);
        const std::size_t index = add_node(std::move(node));
        add_to(cell, index);
        return index;
    }

    std::size_t add_node(RunNode node) {
        // Equal steps with different expectations are different nodes.
        std::string identity = node.key;
        if (node.step)
            for (const PlannedExpectation& expectation : plan_->steps[*node.step].expectations)
                identity += "\n" + expectation.text;
        const auto [found, is_new] = node_of_key_.emplace(std::move(identity), graph_.nodes.size());
        if (is_new) graph_.nodes.push_back(std::move(node));
        return found->second;
    }

    static void add_to(RunCell& cell, std::size_t node) {
        if (std::ranges::find(cell.nodes, node) == cell.nodes.end()) cell.nodes.push_back(node);
    }

    FileContents contents_;
    FilterLibrary& library_;
    const std::vector<GraphPart>& parts_;
    const Plan* plan_ = nullptr;  // plan of the part that is being added
    const RunRequest* request_ = nullptr;
    KeyBase base_;
    OutputFiles output_files_;
    RunGraph graph_;
    std::map<std::string, u32> views_in_;  // by path
    std::map<std::string, std::size_t> node_of_key_;  // by plan key and expectations
    std::map<std::string, std::size_t> scan_of_name_;
};

}  // namespace

RunGraph make_graph(const std::vector<GraphPart>& parts, FilterLibrary& library, const HashOfFile& hash) {
    return GraphBuilder(parts, library, hash).build();
}

RunGraph make_graph(const Plan& plan, FilterLibrary& library, const RunRequest& request, const HashOfFile& hash) {
    return make_graph({{std::make_shared<const Plan>(plan), request}}, library, hash);
}

}  // namespace scanmill
