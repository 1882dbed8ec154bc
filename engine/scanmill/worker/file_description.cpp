// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/worker/file_description.hpp"

#include <fmt/format.h>
#include <nettle/sha2.h>
#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "scanmill/base/error.hpp"
#include "scanmill/graph/output_files.hpp"
#include "scanmill/io/atomic_file.hpp"
#include "scanmill/kinds/document.hpp"

namespace scanmill {

// Nettle is as fast as OpenSSL here. It loads in a tenth of the time, and every process has to load it.

Sha256::Sha256() : context_(std::make_unique<sha256_ctx>()) { ::sha256_init(context_.get()); }

Sha256::~Sha256() = default;

void Sha256::add(std::string_view bytes) {
    ::sha256_update(context_.get(), bytes.size(), reinterpret_cast<const std::uint8_t*>(bytes.data()));
}

std::string Sha256::text() {
    std::array<std::uint8_t, SHA256_DIGEST_SIZE> digest;
    ::sha256_digest(context_.get(), digest.size(), digest.data());
    std::string text;
    for (const std::uint8_t byte : digest) text += fmt::format("{:02x}", byte);
    return text;
}

std::string sha256_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    Sha256 hash;
    std::vector<char> buffer(1 << 20);
    while (stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size())), stream.gcount() > 0)
        hash.add({buffer.data(), static_cast<std::size_t>(stream.gcount())});
    return stream.eof() ? hash.text() : "";
}

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json to_json(const ParameterSet& parameters) {
    Json json = Json::object();
    for (const auto& [name, value] : parameters.values)
        if (std::string shown = text(value); !shown.empty()) json[name] = std::move(shown);
    return json;
}

std::string dumped(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace); }

/// Adds the node after all nodes upstream of it that `found` lacks.
void add_ancestry(const RunGraph& graph, std::size_t node, std::vector<std::size_t>& found) {
    for (const NodeInput& input : graph.nodes[node].inputs)
        if (std::ranges::find(found, input.node) == found.end()) add_ancestry(graph, input.node, found);
    found.push_back(node);
}

/// The node and all nodes upstream of it. Every node comes after its inputs. The order depends on the wiring alone, not
/// on what else the graph has.
std::vector<std::size_t> ancestry(const RunGraph& graph, std::size_t node) {
    std::vector<std::size_t> found;
    add_ancestry(graph, node, found);
    return found;
}

}  // namespace

std::string made_how(const RunGraph& graph, const std::vector<std::size_t>& cells, const RunOutput& output,
                     const std::vector<NodeReport>& reports, bool is_evidence) {
    const RunCell& cell = graph.cells[cells.front()];
    Json json{{"scanmill", 1},
              {"version", SCANMILL_VERSION},
              {"workflow", graph.workflow(cell)},
              {"variants", Json::array()},
              {"scan", graph.scan_names[cell.scan]},
              {"seed", graph.seed},
              {"expected", Json::array()},
              {"doubts", Json::array()},
              {"steps", Json::array()}};
    for (const std::size_t each : cells) json["variants"].push_back(graph.variant(graph.cells[each]).name);
    if (const PlannedStep* step = graph.step(graph.nodes[output.node]))
        for (const PlannedExpectation& expectation : step->expectations) json["expected"].push_back(expectation.text);
    const std::vector<std::size_t> all = ancestry(graph, output.node);
    json["doubts"] = doubts_about({output}, all, graph, reports);
    if (is_evidence) json["unmet"] = unmet_by(cells, graph, reports);
    for (const std::size_t each : all) {
        const RunNode& made = graph.nodes[each];
        Json entry{{"step", graph.label(made)}, {"key", made.key}};
        if (const PlannedStep* step = graph.step(made)) {
            entry["filter"] = step->spec.name;
            entry["filter-version"] = step->spec.version;
            entry["code"] = made.code;
            entry["parameters"] = to_json(reports[each].resolved);
            entry["metrics"] = metrics_json(reports[each].metrics);
        } else {
            // Scans of equal content share one node, whose leaf names only the first scan.
            const bool is_this_scan = made.is_scan && !graph.plans[cell.plan]->workflow.inputs.front().list;
            entry["file"] = is_this_scan ? graph.scan_names[cell.scan] : made.leaf.name();
            entry["content"] = made.leaf.content;
            for (const auto& [name, value] : declared_of(made.leaf)) entry[name] = value;
        }
        json["steps"].push_back(std::move(entry));
    }
    return dumped(json);
}

std::vector<std::string> added_columns(const RunGraph& graph, std::size_t node) {
    std::vector<std::string> columns;
    for (const std::size_t each : ancestry(graph, node))
        if (const PlannedStep* step = graph.step(graph.nodes[each]))
            columns.insert(columns.end(), step->spec.adds.begin(), step->spec.adds.end());
    return columns;
}

void write_description(const fs::path& file, const std::string& sha256, const std::string& how, const Value& value,
                       const Metrics& properties, const Vec3& shift) {
    Json json = Json::parse(how);
    const std::optional<Frame> frame = frame_of(value);
    json["file"] = {{"name", file.filename().string()},
                    {"bytes", fs::file_size(file)},
                    {"sha256", sha256},
                    {"kind", name_of(kind_of(value))},
                    {"unit", frame && frame->unit != LengthUnit::unknown ? Json(symbol(frame->unit)) : Json()},
                    {"frame", frame && !frame->name.empty() ? Json(frame->name) : Json()},
                    {"properties", metrics_json(properties)}};
    if (shift != Vec3::Zero()) json["file"]["shift"] = {shift.x(), shift.y(), shift.z()};
    AtomicFile description(description_of(file));
    description.write(dumped(json) + "\n");
    description.commit();
}

void move_with_description(const fs::path& file, const fs::path& to, const std::vector<std::string>& unmet) {
    std::error_code trouble;
    fs::create_directories(to.parent_path(), trouble);
    if (trouble) throw Error("the folder '{}' cannot be made: {}", to.parent_path().string(), trouble.message());
    const fs::path old_description = description_of(file), new_description = description_of(to);
    std::ifstream stream(old_description, std::ios::binary);
    const std::string text(std::istreambuf_iterator<char>(stream), {});
    Json json = Json::parse(text, nullptr, false);
    if (json.is_object()) {
        json["unmet"] = unmet;
        AtomicFile description(new_description);
        description.write(dumped(json) + "\n");
        description.commit();
    } else {  // an output with a long name has no description
        fs::remove(new_description, trouble);
    }
    fs::rename(file, to, trouble);
    if (trouble) {
        std::error_code ignored;
        fs::remove(new_description, ignored);
        throw Error("'{}' cannot be moved to '{}': {}", file.string(), to.string(), trouble.message());
    }
    fs::remove(old_description, trouble);
}

}  // namespace scanmill
