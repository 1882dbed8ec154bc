// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/graph.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <set>

#include "scanmill/engine/key.hpp"
#include "scanmill/engine/output_template.hpp"
#include "scanmill/filter/error.hpp"
#include "scanmill/filter/module.hpp"
#include "scanmill/filter/suggestion.hpp"
#include "scanmill/formats/files.hpp"

namespace scanmill {

namespace {

constexpr std::string_view key_scheme = "1";

namespace fs = std::filesystem;

class GraphBuilder {
public:
    GraphBuilder(const Plan& plan, FilterLibrary& library, const RunRequest& request)
        : plan_(plan),
          library_(library),
          request_(request),
          core_build_(content_hash(core_library_file())) {
        output_folder_ = fs::weakly_canonical(fs::absolute(request.output_folder));
    }

    RunGraph build() {
        require_fed();
        require_known_names();
        const std::vector<WorkflowInput>& inputs = plan_.workflow.inputs;
        if (inputs.empty()) {
            graph_.scan_names.push_back(plan_.workflow.name.empty() ? "workflow" : plan_.workflow.name);
            add_cells(0, {});
        }
        for (std::size_t scan = 0; scan < request_.scans.size(); ++scan) {
            graph_.scan_names.push_back(request_.scans[scan].string());
            add_cells(scan, request_.scans[scan]);
        }
        return std::move(graph_);
    }

private:
    void require_fed() const {
        const std::vector<WorkflowInput>& inputs = plan_.workflow.inputs;
        if (inputs.empty() && !request_.scans.empty())
            throw Error("the workflow takes no scans: it declares no inputs; found {}", request_.scans.size());
        if (!inputs.empty() && request_.scans.empty())
            throw Error("no scan was given for the workflow's input '{}'", inputs.front().name)
                .hint("scanmill run WORKFLOW SCAN…");
        std::vector<std::string> others;
        for (std::size_t i = 1; i < inputs.size(); ++i) others.push_back(inputs[i].name);
        for (const auto& [name, files] : request_.inputs) {
            if (std::ranges::find(others, name) == others.end())
                throw Error("--in {}: the workflow has no such input beside the scans; {}{}", name,
                            others.empty() ? "it has none" : "it has " + enumerated(others),
                            did_you_mean(name, others));
            const auto& input = *std::ranges::find(inputs, name, &WorkflowInput::name);
            if (!input.list && files.size() > 1)
                throw Error("--in {}: the input takes one file; found {}", name, files.size());
        }
        for (const std::string& name : others)
            if (!request_.inputs.contains(name))
                throw Error("the workflow's input '{}' is not fed", name).hint("--in " + name + "=FILE");
    }

    void require_known_names() const {
        std::vector<std::string> variants;
        std::set<std::string> steps;
        for (const PlannedVariant& variant : plan_.variants) {
            variants.push_back(variant.name);
            for (const auto& [name, index] : variant.steps_by_name) steps.insert(name);
        }
        for (const std::string& name : request_.only)
            if (std::ranges::find(variants, name) == variants.end())
                throw Error("--only {}: there is no such variant; there {} {}{}", name,
                            variants.size() == 1 ? "is" : "are", enumerated(variants), did_you_mean(name, variants));
        const std::vector<std::string> step_names(steps.begin(), steps.end());
        const auto require_step = [&](const std::string& option, const std::string& name) {
            if (!steps.contains(name))
                throw Error("{} {}: there is no such step; there {} {}{}", option, name,
                            step_names.size() == 1 ? "is" : "are", enumerated(step_names),
                            did_you_mean(name, step_names));
        };
        if (!request_.until.empty()) require_step("--until", request_.until);
        for (const std::string& name : request_.save) require_step("--save", name.substr(0, name.find('.')));
    }

    void add_cells(std::size_t scan, const fs::path& file) {
        for (std::size_t variant = 0; variant < plan_.variants.size(); ++variant) {
            const PlannedVariant& planned = plan_.variants[variant];
            if (!request_.only.empty() && std::ranges::find(request_.only, planned.name) == request_.only.end())
                continue;
            RunCell cell{scan, variant, {}, {}};
            std::map<std::size_t, std::size_t> node_of_step;
            for (const std::size_t step : steps_to_run(planned)) {
                node_of_step[step] = add_step(step, node_of_step, scan, file, cell);
                add_to(cell, node_of_step[step]);
            }
            const TemplateValues values{
                file.empty() ? graph_.scan_names.back() : file.stem().string(), planned.name,
                plan_.workflow.name.empty() ? fs::path(plan_.workflow.file).stem().string() : plan_.workflow.name};
            for (const auto& [name, source] : outputs(planned)) {
                if (source.step && !node_of_step.contains(*source.step)) continue;  // beyond --until
                const std::size_t node =
                    source.step ? node_of_step[*source.step] : add_leaf(source.input, scan, file, cell);
                add_output(cell, expand_template(name, values), node, source.port);
            }
            graph_.cells.push_back(std::move(cell));
        }
    }

    std::vector<std::size_t> steps_to_run(const PlannedVariant& variant) const {
        const auto last = variant.steps_by_name.find(request_.until);
        if (last == variant.steps_by_name.end()) return variant.steps;
        const auto end = std::ranges::find(variant.steps, last->second);
        return {variant.steps.begin(), end == variant.steps.end() ? end : end + 1};
    }

    /// The variant's outputs and what --save adds, as file templates.
    std::vector<std::pair<std::string, ValueSource>> outputs(const PlannedVariant& variant) const {
        std::vector<std::pair<std::string, ValueSource>> all;
        for (const PlannedOutput& output : variant.outputs) all.emplace_back(output.file, output.source);
        for (const std::string& wanted : request_.save) {
            const std::size_t dot = wanted.find('.');
            const auto step = variant.steps_by_name.find(wanted.substr(0, dot));
            if (step == variant.steps_by_name.end()) continue;  // a step of another variant
            const FilterSpec& spec = plan_.steps[step->second].spec;
            const std::string port = dot == std::string::npos ? spec.outputs.front().name : wanted.substr(dot + 1);
            if (!spec.output(port)) throw Error("--save {}: the step has no output port '{}'", wanted, port);
            const Kind kind = spec.output(port)->kind;
            if (!can_write("ply", kind))
                throw Error("--save {}: {} cannot be written to a file yet", wanted, name_of(kind));
            const std::string variant_part = plan_.variants.size() > 1 ? ".{variant}" : "";
            all.emplace_back("{scan}" + variant_part + "." + wanted + ".ply", ValueSource{step->second, 0, port});
        }
        return all;
    }

    std::size_t add_step(std::size_t step, const std::map<std::size_t, std::size_t>& node_of_step, std::size_t scan,
                         const fs::path& file, RunCell& cell) {
        const PlannedStep& planned = plan_.steps[step];
        RunNode node;
        node.step = step;
        node.scan = scan;
        KeyBuilder key;
        key.field("scheme", key_scheme)
            .field("filter", planned.spec.name)
            .field("version", std::to_string(planned.spec.version))
            .field("module", library_.build_id(planned.spec.name))
            .field("core", core_build_)
            .field("seed", std::to_string(request_.seed));
        for (const auto& [name, value] : planned.parameters.values)
            key.field("parameter " + name, canonical_text(value));
        for (const PlannedInput& input : planned.inputs)
            for (const ValueSource& source : input.sources)
                for (const std::size_t from : sources_of(source, node_of_step, scan, file, cell)) {
                    node.inputs.push_back({input.port, from, source.port});
                    key.field("port " + input.port, graph_.nodes[from].key + "." + source.port);
                }
        node.key = key.key();
        return add_node(std::move(node));
    }

    std::vector<std::size_t> sources_of(const ValueSource& source,
                                        const std::map<std::size_t, std::size_t>& node_of_step, std::size_t scan,
                                        const fs::path& file, RunCell& cell) {
        if (source.step) return {node_of_step.at(*source.step)};
        if (source.input == 0) return {add_leaf(0, scan, file, cell)};
        std::vector<std::size_t> leaves;
        for (const fs::path& other : request_.inputs.at(plan_.workflow.inputs[source.input].name))
            leaves.push_back(add_leaf(source.input, scan, other, cell));
        return leaves;
    }

    std::size_t add_leaf(std::size_t input, std::size_t scan, const fs::path& file, RunCell& cell) {
        const WorkflowInput& declared = plan_.workflow.inputs[input];
        RunNode node;
        node.file = file;
        node.input = input;
        node.scan = scan;
        KeyBuilder key;
        key.field("scheme", key_scheme)
            .field("content", content_of(file, node.unreadable))
            .field("kind", name_of(declared.kind))
            .field("unit", symbol(request_.unit != LengthUnit::unknown ? request_.unit : declared.unit))
            .field("frame", declared.frame);
        node.key = key.key();
        const std::size_t index = add_node(std::move(node));
        add_to(cell, index);
        return index;
    }

    /// The content's hash; a file that cannot be read stands for itself alone.
    std::string content_of(const fs::path& file, std::string& unreadable) {
        const auto [known, is_new] = contents_.try_emplace(file.string());
        if (is_new) {
            try {
                std::error_code absent;  // a pipe would block, a folder has no content; reading them says why
                if (!fs::is_regular_file(file, absent)) throw Error("'{}' is no file", file.string());
                known->second.first = content_hash(file);
            } catch (const Error& error) {
                known->second = {"unreadable " + file.string(), error.sentence()};
            }
        }
        unreadable = known->second.second;
        return known->second.first;
    }

    std::size_t add_node(RunNode node) {
        const auto [known, is_new] = node_of_key_.emplace(node.key, graph_.nodes.size());
        if (is_new) graph_.nodes.push_back(std::move(node));
        return known->second;
    }

    static void add_to(RunCell& cell, std::size_t node) {
        if (std::ranges::find(cell.nodes, node) == cell.nodes.end()) cell.nodes.push_back(node);
    }

    void add_output(RunCell& cell, const std::string& name, std::size_t node, const std::string& port) {
        const fs::path file = (output_folder_ / name).lexically_normal();
        const std::string what =
            fmt::format("scan '{}' under variant '{}'", graph_.scan_names.back(), plan_.variants[cell.variant].name);
        const auto [known, is_new] = writers_.emplace(file, Writer{what, node, port});
        if (!is_new && (known->second.node != node || known->second.port != port))
            throw Error("{} and {} would both write '{}'", known->second.what, what, file.string())
                .hint("use {scan} and {variant} in the output's name, or rename a scan");
        if (const fs::path real = fs::weakly_canonical(file.parent_path()); !lies_below(real, output_folder_))
            throw Error("'{}' would be written outside the output folder, to '{}'", file.string(), real.string())
                .hint("a symbolic link below the output folder leads out of it; remove it");
        if (is_input(file))
            throw Error("'{}' is an input; an output must not replace it", file.string())
                .hint("choose another output folder with -o");
        cell.outputs.push_back({file, node, port});
    }

    static bool lies_below(const fs::path& path, const fs::path& folder) {
        const auto [end, rest] = std::ranges::mismatch(folder, path);
        return end == folder.end() || end->empty();
    }

    /// Whether the file is one of the inputs, by whatever name or link.
    bool is_input(const fs::path& file) {
        if (input_identities_.empty()) {
            for (const fs::path& scan : request_.scans) input_identities_.insert(identity(scan));
            for (const auto& [name, files] : request_.inputs)
                for (const fs::path& other : files) input_identities_.insert(identity(other));
        }
        const auto found = identity(file);
        return found.second != 0 && input_identities_.contains(found);
    }

    /// Device and inode; zeros for what does not exist.
    static std::pair<dev_t, ino_t> identity(const fs::path& file) {
        struct stat status;
        if (::stat(file.c_str(), &status) != 0) return {0, 0};
        return {status.st_dev, status.st_ino};
    }

    struct Writer {
        std::string what;
        std::size_t node;
        std::string port;
    };

    const Plan& plan_;
    FilterLibrary& library_;
    const RunRequest& request_;
    std::string core_build_;
    fs::path output_folder_;
    RunGraph graph_;
    std::map<std::string, std::size_t> node_of_key_;
    std::map<std::string, std::pair<std::string, std::string>> contents_;  // file → hash, reason
    std::map<fs::path, Writer> writers_;
    std::set<std::pair<dev_t, ino_t>> input_identities_;
};

}  // namespace

RunGraph make_graph(const Plan& plan, FilterLibrary& library, const RunRequest& request) {
    return GraphBuilder(plan, library, request).build();
}

}  // namespace scanmill
