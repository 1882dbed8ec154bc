// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/worker/messages.hpp"

#include <sys/socket.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include "scanmill/base/error.hpp"
#include "scanmill/cache/step_result.hpp"
#include "scanmill/plan/expectation.hpp"

namespace scanmill {

using Json = nlohmann::json;

static Kind kind_from(const Json& json) {
    const std::optional<Kind> kind = kind_named(json.get<std::string>());
    if (!kind) throw Error("unknown kind {}", json.get<std::string>());
    return *kind;
}

std::string bytes_of(const Json& json) {
    std::string bytes;
    Json::to_cbor(json, bytes);
    return bytes;
}

namespace {

using MessageLength = std::uint32_t;
constexpr MessageLength longest = 64u << 20;
}  // namespace

bool send_message(int socket, std::string_view message) {
    std::string bytes(sizeof(MessageLength), '\0');
    const MessageLength length = static_cast<MessageLength>(message.size());
    std::memcpy(bytes.data(), &length, sizeof length);
    bytes += message;
    for (std::size_t sent = 0; sent < bytes.size();) {
        const ssize_t now = ::send(socket, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
        if (now < 0 && errno == EINTR) continue;
        if (now <= 0) return false;
        sent += static_cast<std::size_t>(now);
    }
    return true;
}

MessageReader::Arrival MessageReader::receive(bool waits) {
    std::array<char, 1 << 16> block;
    const ssize_t length = ::recv(socket_, block.data(), block.size(), waits ? 0 : MSG_DONTWAIT);
    if (length > 0) {
        bytes_.append(block.data(), static_cast<std::size_t>(length));
        return Arrival::something;
    }
    if (length < 0 && (errno == EINTR || errno == EAGAIN || errno == EWOULDBLOCK)) return Arrival::nothing;
    return Arrival::end;
}

std::optional<std::string> MessageReader::next() {
    MessageLength length;
    if (bytes_.size() - taken_ < sizeof length) return std::nullopt;
    std::memcpy(&length, bytes_.data() + taken_, sizeof length);
    if (length > longest) throw Error("a message between runner and worker has {} bytes", length);
    if (bytes_.size() - taken_ - sizeof length < length) return std::nullopt;
    std::string message = bytes_.substr(taken_ + sizeof length, length);
    taken_ += sizeof length + length;
    if (taken_ == bytes_.size()) {
        bytes_.clear();
        taken_ = 0;
    }
    return message;
}

namespace {

Json to_json(const WrittenParameter& value) { return {value.items, value.list}; }

/// One end of an expectation; there may be none.
Json end_of(const ParameterValue& value) {
    return std::holds_alternative<std::monostate>(value) ? Json() : to_json(written(value));
}

ParameterValue end_from(const Json& json, Unit unit) {
    if (json.is_null()) return {};
    return parse(written_as(unit), {json.at(0).get<std::vector<std::string>>(), json.at(1).get<bool>()});
}

}  // namespace

Json rows_of(const ParameterSet& parameters) {
    Json rows = Json::array();
    for (const auto& [name, value] : parameters.values) {
        if (std::holds_alternative<std::monostate>(value)) continue;
        const WrittenParameter text = written(value);
        rows.push_back({name, text.items, text.list});
    }
    return rows;
}

ParameterSet parameters_from(const Json& rows, const FilterSpec& spec) {
    ParameterSet set;
    for (const ParameterSpec& parameter : spec.parameters) {
        const auto row = std::ranges::find_if(rows, [&](const Json& each) { return each.at(0) == parameter.name; });
        set.values.emplace_back(
            parameter.name,
            row == rows.end() ? ParameterValue()
                              : parse(parameter, {row->at(1).get<std::vector<std::string>>(), row->at(2).get<bool>()}));
    }
    return set;
}

Json to_json(const PlannedStep& step) {
    Json json{{"filter", step.spec.name}, {"version", step.spec.version},
              {"label", step.label},      {"parameters", rows_of(step.parameters)},
              {"kinds", Json::array()},   {"expect", Json::array()}};
    for (const PortSpec& output : step.spec.outputs) json["kinds"].push_back(output.kind.name());
    for (const PlannedExpectation& expected : step.expectations)
        json["expect"].push_back({expected.name, static_cast<int>(expected.relation), static_cast<int>(expected.unit),
                                  end_of(expected.low), end_of(expected.high), expected.text});
    return json;
}

std::shared_ptr<const PlannedStep> step_from(const Json& json, const FilterLibrary& library) {
    const std::string name = json.at("filter");
    const FilterSpec* spec = library.find(name);
    if (!spec || spec->version != json.at("version").get<int>())
        throw Error("the filter {} changed while the run was going on", name).hint("run it again");
    auto step = std::make_shared<PlannedStep>();
    step->label = json.at("label");
    step->spec = *spec;
    for (std::size_t i = 0; i < step->spec.outputs.size(); ++i)
        step->spec.outputs[i].kind = kind_from(json.at("kinds").at(i));
    step->parameters = parameters_from(json.at("parameters"), *spec);
    for (const Json& row : json.at("expect")) {
        const Unit unit = static_cast<Unit>(row.at(2).get<int>());
        step->expectations.push_back({row.at(0),
                                      {},
                                      static_cast<Expectation::Relation>(row.at(1).get<int>()),
                                      unit,
                                      end_from(row.at(3), unit),
                                      end_from(row.at(4), unit),
                                      row.at(5)});
    }
    return step;
}

namespace {

using Json = nlohmann::json;

Json to_json(const LeafSource& leaf);
LeafSource leaf_from(const Json& json);

Json to_json(const JobInput& input) {
    return {input.port, input.node, input.from, input.content, input.leaf ? to_json(*input.leaf) : Json()};
}
JobInput input_from(const Json& row) {
    JobInput input{row.at(0), row.at(1).get<std::size_t>(), row.at(2), row.at(3), {}};
    if (!row.at(4).is_null()) input.leaf = leaf_from(row.at(4));
    return input;
}

Json to_json(const JobMemory& memory) {
    return {memory.is_used, memory.plan_key, memory.code, memory.keep_always, memory.inputs_cost, memory.needed};
}
JobMemory memory_from(const Json& row) {
    return {row.at(0), row.at(1), row.at(2), row.at(3), row.at(4), row.at(5).get<std::vector<std::string>>()};
}

Json to_json(const LeafSource& leaf) {
    Json json{{"file", leaf.file.native()},          {"content", leaf.content}, {"kind", leaf.kind.name()},
              {"unit", static_cast<int>(leaf.unit)}, {"frame", leaf.frame},     {"streamed", leaf.is_streamed}};
    if (leaf.pose) {
        const RigidTransform& pose = *leaf.pose;
        json["pose"] = {std::vector<double>(pose.rotation.data(), pose.rotation.data() + 9),
                        std::vector<double>(pose.translation.begin(), pose.translation.end()),
                        static_cast<int>(pose.unit), pose.from, pose.to};
    }
    return json;
}

LeafSource leaf_from(const Json& json) {
    LeafSource leaf{json.at("file").get<std::string>(),
                    json.at("content"),
                    kind_from(json.at("kind")),
                    static_cast<LengthUnit>(json.at("unit").get<int>()),
                    json.at("frame"),
                    {},
                    json.at("streamed").get<bool>()};
    if (json.contains("pose")) {
        const Json& row = json.at("pose");
        RigidTransform pose;
        for (int i = 0; i < 9; ++i) pose.rotation.data()[i] = row.at(0).at(static_cast<std::size_t>(i));
        for (int i = 0; i < 3; ++i) pose.translation[i] = row.at(1).at(static_cast<std::size_t>(i));
        pose.unit = static_cast<LengthUnit>(row.at(2).get<int>());
        pose.from = row.at(3);
        pose.to = row.at(4);
        leaf.pose = pose;
    }
    return leaf;
}

Json to_json(const ReadWork& work) { return {{"leaf", to_json(work.leaf)}, {"memory", to_json(work.memory)}}; }
Json to_json(const StepWork& work) {
    Json json{{"step", to_json(*work.step)},
              {"build", work.build},
              {"inputs", Json::array()},
              {"files", Json::array()},
              {"memory", to_json(work.memory)}};
    for (const JobInput& input : work.inputs) json["inputs"].push_back(to_json(input));
    for (const ParameterFile& file : work.parameter_files) json["files"].push_back({file.path.native(), file.content});
    return json;
}
Json to_json(const ExpectWork& work) {
    return {{"step", to_json(*work.step)}, {"metrics", rows_of(work.metrics)}, {"primary", to_json(work.primary)}};
}
Json to_json(const WriteWork& work) {
    return {{"file", work.file.native()}, {"how", work.made_how}, {"value", to_json(work.value)}};
}

constexpr std::array<const char*, 4> kinds_of_work{"read", "run", "expect", "write"};

std::variant<ReadWork, StepWork, ExpectWork, WriteWork> work_from(const Json& json, const FilterLibrary& library) {
    if (json.contains("read")) {
        const Json& body = json.at("read");
        return ReadWork{leaf_from(body.at("leaf")), memory_from(body.at("memory"))};
    }
    if (json.contains("write")) {
        const Json& body = json.at("write");
        return WriteWork{body.at("file").get<std::string>(), body.at("how"), input_from(body.at("value"))};
    }
    if (json.contains("expect")) {
        const Json& body = json.at("expect");
        return ExpectWork{step_from(body.at("step"), library), metrics_from(body.at("metrics")),
                          input_from(body.at("primary"))};
    }
    const Json& body = json.at("run");
    StepWork work{step_from(body.at("step"), library), body.at("build"), {}, {}, memory_from(body.at("memory"))};
    for (const Json& row : body.at("inputs")) work.inputs.push_back(input_from(row));
    for (const Json& row : body.at("files")) work.parameter_files.push_back({row.at(0).get<std::string>(), row.at(1)});
    return work;
}

Json to_json(const NodeReport& node) {
    return {{"origin", static_cast<int>(node.origin)},
            {"failure", {static_cast<int>(node.failure.cause), node.failure.number, node.failure.text}},
            {"effort", {node.effort.seconds, node.effort.cpu_seconds, node.effort.peak_memory, node.effort.threads}},
            {"resolved", rows_of(node.resolved)},
            {"metrics", rows_of(node.metrics)},
            {"properties", rows_of(node.properties)},
            {"warnings", node.warnings}};
}

NodeReport node_from(const Json& json, const PlannedStep* step) {
    NodeReport node;
    node.origin = static_cast<Origin>(json.at("origin").get<int>());
    const Json& failure = json.at("failure");
    node.failure = {static_cast<Cause>(failure.at(0).get<int>()), failure.at(1), failure.at(2)};
    const Json& effort = json.at("effort");
    node.effort = {effort.at(0), effort.at(1), effort.at(2), effort.at(3), {}};
    if (step && !json.at("resolved").empty()) node.resolved = parameters_from(json.at("resolved"), step->spec);
    node.metrics = metrics_from(json.at("metrics"));
    node.properties = metrics_from(json.at("properties"));
    node.warnings = json.at("warnings").get<std::vector<std::string>>();
    return node;
}

Json to_json(const OutputReport& output) {
    return {{"file", output.file.native()},
            {"outcome", static_cast<int>(output.outcome)},
            {"kind", output.kind.name()},
            {"properties", rows_of(output.properties)},
            {"warnings", output.warnings}};
}

OutputReport output_from(const Json& json) {
    return {json.at("file").get<std::string>(), static_cast<Outcome>(json.at("outcome").get<int>()),
            kind_from(json.at("kind")), metrics_from(json.at("properties")),
            json.at("warnings").get<std::vector<std::string>>()};
}

Json to_json(const JobReport& report) {
    Json json{{"outcome", static_cast<int>(report.outcome)},
              {"node", to_json(report.node)},
              {"kept", report.kept},
              {"output", to_json(report.output)},
              {"whole", report.was_read_whole},
              {"worn", report.worn},
              {"lost", Json::array()}};
    const std::string result = to_bytes(report.result);
    json["result"] = Json::binary({result.begin(), result.end()});
    for (const JobInput& input : report.lost) json["lost"].push_back(to_json(input));
    return json;
}

JobReport report_from(const Json& json, const PlannedStep* step) {
    JobReport report;
    report.outcome = static_cast<Outcome>(json.at("outcome").get<int>());
    report.node = node_from(json.at("node"), step);
    report.node.outcome = report.outcome;
    report.node.attempts = 1;
    report.kept = json.at("kept").get<std::vector<std::string>>();
    report.output = output_from(json.at("output"));
    report.was_read_whole = json.at("whole");
    report.worn = json.at("worn");
    const Json::binary_t& result = json.at("result").get_binary();
    report.result = step_result_from({reinterpret_cast<const char*>(result.data()), result.size()});
    for (const Json& row : json.at("lost")) report.lost.push_back(input_from(row));
    return report;
}

}  // namespace

std::string to_message(const WorkerStart& start) {
    return bytes_of({start.cache_folder, start.keep_policy, start.parent, start.core_build, start.scratch});
}

WorkerStart start_from(std::string_view message) {
    return read_message(message, [](const Json& row) {
        return WorkerStart{row.at(0), row.at(1), row.at(2), row.at(3), row.at(4)};
    });
}

std::string to_message(const Job& job, const std::vector<std::size_t>& forgotten) {
    Json json{{"node", job.node},      {"frames", job.frames},       {"threads", job.threads},
              {"seed", job.seed},      {"memory", job.memory_limit}, {"seconds", job.seconds_limit},
              {"forgotten", forgotten}};
    std::visit([&](const auto& work) { json[kinds_of_work[job.work.index()]] = to_json(work); }, job.work);
    return bytes_of(json);
}

std::string to_message(const std::vector<std::size_t>& forgotten) { return bytes_of({{"forgotten", forgotten}}); }

ReceivedJob job_from(std::string_view message, const FilterLibrary& library) {
    return read_message(message, [&](const Json& json) {
        ReceivedJob received;
        received.forgotten = json.at("forgotten").get<std::vector<std::size_t>>();
        if (!json.contains("node")) return received;
        Job& job = received.job.emplace();
        job.node = json.at("node");
        job.frames = json.at("frames").get<std::vector<std::string>>();
        job.threads = json.at("threads");
        job.seed = json.at("seed");
        job.memory_limit = json.at("memory");
        job.seconds_limit = json.at("seconds");
        job.work = work_from(json, library);
        return received;
    });
}

std::string to_message(const WorkerMessage& message) {
    Json json = Json::object();
    if (message.is_ready) json["ready"] = true;
    if (message.progress) json["progress"] = *message.progress;
    if (message.warning) json["warning"] = *message.warning;
    if (message.note) json["note"] = *message.note;
    if (message.report) json["report"] = to_json(*message.report);
    return bytes_of(json);
}

WorkerMessage worker_message_from(std::string_view bytes, const PlannedStep* step) {
    return read_message(bytes, [&](const Json& json) {
        WorkerMessage message;
        message.is_ready = json.contains("ready");
        if (json.contains("progress")) message.progress = json.at("progress").get<double>();
        if (json.contains("warning")) message.warning = json.at("warning").get<std::string>();
        if (json.contains("note")) message.note = json.at("note").get<std::string>();
        if (json.contains("report")) message.report = report_from(json.at("report"), step);
        if (!message.is_ready && !message.progress && !message.warning && !message.note && !message.report)
            throw Error("a message between runner and worker says nothing");
        return message;
    });
}

}  // namespace scanmill
