// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/worker/job.hpp"

#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include "scanmill/base/hash.hpp"
#include "scanmill/kinds/document.hpp"
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
        const std::string file = reading->leaf.name();
        if (cause != Cause::refused)
            error.add_frame(fmt::format("while reading '{}'", file));
        else if (file == job.scan)
            scan.clear();  // the reader's sentence begins with the file's name
    }
    if (!job.frame.empty()) error.add_frame(job.frame);
    return {cause, number, std::move(error), std::move(scan), {}};
}

template <>
struct JsonForm<Error> {
    static Json write(const Error& error) {
        return {error.sentence(), error.frames(), error.hint(), static_cast<int>(error.remedy())};
    }
    static void read(const Json& json, Error& error) {
        require_size(json, 4);
        std::string sentence, hint;
        std::vector<std::string> frames;
        int remedy = 0;
        JsonForm<std::string>::read(json[0], sentence);
        JsonForm<std::vector<std::string>>::read(json[1], frames);
        JsonForm<std::string>::read(json[2], hint);
        JsonForm<int>::read(json[3], remedy);
        error = Error(std::move(sentence)).hint(std::move(hint)).remedy(static_cast<Remedy>(remedy));
        for (std::string& frame : frames) error.add_frame(std::move(frame));
    }
};

/// A planned step in a message, without the filter's declaration. job_from() adds the declaration from the library.
struct StepMessage {
    std::string filter;
    int version = 0;
    std::string label;
    ParameterSet parameters;
    std::vector<Kind> kinds;  ///< kinds of the outputs
    std::vector<PlannedExpectation> expectations;
};
constexpr auto fields(const StepMessage*) {
    using R = StepMessage;
    return std::tuple{field("filter", &R::filter), field("version", &R::version),
                      field("label", &R::label),   field("parameters", &R::parameters),
                      field("kinds", &R::kinds),   field("expectations", &R::expectations)};
}

template <>
struct JsonForm<PlannedStep> {
    static Json write(const PlannedStep& step) {
        StepMessage message{step.spec.name, step.spec.version, step.label, step.parameters, {}, step.expectations};
        for (const PortSpec& output : step.spec.outputs) message.kinds.push_back(output.kind);
        return json_of(message);
    }
    static void read(const Json& json, PlannedStep& step) {
        StepMessage message;
        JsonForm<StepMessage>::read(json, message);
        step.spec.name = std::move(message.filter);
        step.spec.version = message.version;
        step.label = std::move(message.label);
        step.parameters = std::move(message.parameters);
        for (const Kind kind : message.kinds) step.spec.outputs.push_back({{}, kind, {}});
        step.expectations = std::move(message.expectations);
    }
};

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

static constexpr std::string_view subject = "a message between runner and worker";

template <class Message>
static Message message_from(std::string_view bytes) {
    return from_json<Message>(json_from_cbor(bytes, subject), subject);
}

std::string to_message(const WorkerStart& start) { return cbor_of(json_of(start)); }
std::string to_message(const Job& job) { return cbor_of(json_of(job)); }
std::string to_message(const WorkerMessage& message) { return cbor_of(json_of(message)); }

WorkerStart start_from(std::string_view message) { return message_from<WorkerStart>(message); }
WorkerMessage worker_message_from(std::string_view message) { return message_from<WorkerMessage>(message); }

Job job_from(std::string_view message, const FilterLibrary& library) {
    Job job = message_from<Job>(message);
    if (auto* work = std::get_if<StepWork>(&job.work)) declare(work->step, library);
    if (auto* work = std::get_if<ExpectWork>(&job.work)) declare(work->step, library);
    return job;
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
