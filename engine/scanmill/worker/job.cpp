// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/worker/job.hpp"

#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include "scanmill/base/hash.hpp"
#include "scanmill/kinds/kind_traits.hpp"
#include "scanmill/plan/step_parameters.hpp"

namespace scanmill {

std::string work_key(const PlannedStep& step, const std::string& code, const ParameterSet& parameters,
                     const std::vector<JobInput>& inputs) {
    KeyBuilder key;
    key.field("code", code);  // contains the content of files that parameters name
    for (const auto& [name, value] : parameters.values)
        if (!names_files(step.spec, name)) key.field("parameter " + name, canonical_text(value));
    for (const JobInput& input : inputs) key.field("port " + input.port, input.content);
    return key.key();
}

Failure failure_of(const Job& job, Cause cause, Error error, int number) {
    std::string scan = job.scan;
    if (const auto* reading = std::get_if<ReadWork>(&job.work)) {
        const std::string file = reading->leaf.file.string();
        if (cause != Cause::refused)
            error.add_frame(fmt::format("while reading '{}'", file));
        else if (file == job.scan)
            scan.clear();  // the reader's sentence begins with the file's name
    }
    if (!job.frame.empty()) error.add_frame(job.frame);
    return {cause, number, std::move(error), std::move(scan), {}};
}

static void to_json(nlohmann::json& json, const Error& error) {
    json = {error.sentence(), error.frames(), error.hint(), error.remedy()};
}

static void from_json(const nlohmann::json& json, Error& error) {
    error = Error(json.at(0).get<std::string>()).hint(json.at(2)).remedy(json.at(3).get<Remedy>());
    for (const std::string& frame : json.at(1).get<std::vector<std::string>>()) error.add_frame(frame);
}

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PlannedExpectation, name, relation, unit, low, high, text)

/// The filter's declaration is not sent: job_from() takes it from the library.
static void to_json(nlohmann::json& json, const PlannedStep& step) {
    std::vector<Kind> kinds;
    for (const PortSpec& output : step.spec.outputs) kinds.push_back(output.kind);
    json = {step.spec.name, step.spec.version, step.label, step.parameters, kinds, step.expectations};
}

static void from_json(const nlohmann::json& json, PlannedStep& step) {
    json.at(0).get_to(step.spec.name);
    json.at(1).get_to(step.spec.version);
    json.at(2).get_to(step.label);
    json.at(3).get_to(step.parameters);
    for (const Kind& kind : json.at(4).get<std::vector<Kind>>()) step.spec.outputs.push_back({{}, kind, {}});
    json.at(5).get_to(step.expectations);
}

static void declare(std::shared_ptr<const PlannedStep>& step, const FilterLibrary& library) {
    const FilterSpec* spec = library.find(step->spec.name);
    if (!spec || spec->version != step->spec.version)
        throw Error("the filter {} changed during the run", step->spec.name).hint("run it again");
    PlannedStep declared = *step;
    declared.spec = *spec;
    for (std::size_t i = 0; i < spec->outputs.size(); ++i)
        declared.spec.outputs[i].kind = step->spec.outputs.at(i).kind;
    step = std::make_shared<const PlannedStep>(std::move(declared));
}

}  // namespace scanmill

template <>
struct nlohmann::adl_serializer<std::shared_ptr<const scanmill::PlannedStep>> {
    static void to_json(json& value, const std::shared_ptr<const scanmill::PlannedStep>& step) { value = *step; }
    static void from_json(const json& value, std::shared_ptr<const scanmill::PlannedStep>& step) {
        step = std::make_shared<const scanmill::PlannedStep>(value.get<scanmill::PlannedStep>());
    }
};

namespace scanmill {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RigidTransform, rotation, translation, unit, from, to)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(LeafSource, file, content, kind, unit, frame, pose, invalid, is_streamed, also)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ParameterFile, path, content)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(JobInput, port, node, from, content, leaf)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(JobCaching, is_used, plan_key, code, keep_always, inputs_cost, needed)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ReadWork, leaf, caching)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(StepWork, step, build, inputs, parameter_files, caching)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ExpectWork, step, metrics, primary)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(WriteWork, file, made_how, added_columns, must_be_closed, value)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Job, node, work, frame, scan, threads, seed, memory_limit, seconds_limit, limit_text)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Failure, cause, number, error, scan, equal_scan)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Effort, seconds, cpu_seconds, peak_memory, threads, log)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(NodeReport, outcome, origin, why, failure, effort, attempts, resolved, metrics,
                                   properties, warnings, doubts)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(OutputReport, file, outcome, kind, properties, warnings, doubts, sha256, bytes)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(JobReport, outcome, lost, node, result, kept, output, was_read_whole, wear)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(WorkerStart, cache_folder, keep_policy, parent, core_build, scratch)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(JobMessage, job, forgotten)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(WorkerMessage, is_ready, loading, progress, warning, note, report)

template <class Message>
static Message message_from(std::string_view bytes) {
    try {
        return nlohmann::json::from_cbor(bytes).get<Message>();
    } catch (const nlohmann::json::exception& error) {
        throw Error("a message between runner and worker cannot be read: {}", error.what());
    }
}

std::string to_message(const WorkerStart& start) { return to_bytes(start); }
std::string to_message(const JobMessage& message) { return to_bytes(message); }
std::string to_message(const WorkerMessage& message) { return to_bytes(message); }

WorkerStart start_from(std::string_view message) { return message_from<WorkerStart>(message); }
WorkerMessage worker_message_from(std::string_view message) { return message_from<WorkerMessage>(message); }

JobMessage job_from(std::string_view bytes, const FilterLibrary& library) {
    JobMessage message = message_from<JobMessage>(bytes);
    if (!message.job) return message;
    if (auto* work = std::get_if<StepWork>(&message.job->work)) declare(work->step, library);
    if (auto* work = std::get_if<ExpectWork>(&message.job->work)) declare(work->step, library);
    return message;
}

namespace {

using MessageLength = std::uint32_t;
constexpr MessageLength longest_message = 64u << 20;

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
    if (length > longest_message) throw Error("a message between runner and worker has {} bytes", length);
    if (bytes_.size() - taken_ - sizeof length < length) return std::nullopt;
    std::string message = bytes_.substr(taken_ + sizeof length, length);
    taken_ += sizeof length + length;
    if (taken_ == bytes_.size()) {
        bytes_.clear();
        taken_ = 0;
    }
    return message;
}

}  // namespace scanmill
