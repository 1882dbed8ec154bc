// SPDX-License-Identifier: GPL-3.0-or-later
// The filters of this installation: their declarations, and calls in this process or in a worker process.

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <mutex>
#include <nlohmann/json.hpp>
#include <tuple>

#include "beside.hpp"
#include "module.hpp"
#include "scanmill/plugin/library.hpp"
#include "scanmill/record/json.hpp"
#include "scanmill/session/session.hpp"
#include "scanmill/worker/step_runner.hpp"
#include "scanmill/worker/worker_processes.hpp"

namespace scanmill::python {

namespace nb = nanobind;

namespace {

/// The filters. The library is not safe for several threads, so its users lock it. It is never destroyed, because
/// values may outlive everything else.
struct Library {
    std::mutex mutex;
    FilterLibrary filters{plugin_folders()};
};

Library& shared_library() {
    static Library* library = new Library;
    return *library;
}

const FilterSpec& spec_of(const FilterLibrary& filters, const std::string& name) {
    if (const FilterSpec* spec = filters.find(name)) return *spec;
    for (const UnusableModule& module : filters.unusable())
        if (module.name == name) throw Error("the filter '{}' cannot be used: {}", name, module.reason);
    throw Error("this installation does not have the filter '{}'", name);
}

using GivenParameters = std::vector<std::tuple<std::string, std::vector<std::string>, bool>>;
using GivenInputs = std::vector<std::pair<std::string, Value>>;

ParameterSet parameters_from(const FilterSpec& spec, const GivenParameters& given) {
    ParameterSet set;
    for (const ParameterSpec& parameter : spec.parameters) {
        ParameterValue value = parameter.default_value;
        for (const auto& [name, items, is_list] : given) {
            if (name != parameter.name) continue;
            try {
                value = parse(parameter, {items, is_list});
            } catch (Error& error) {
                throw error.add_frame(fmt::format("in the parameter '{}' of {}", name, spec.name));
            }
        }
        set.values.emplace_back(parameter.name, std::move(value));
    }
    return set;
}

struct Request {
    std::shared_ptr<const PlannedStep> step;
    GivenInputs inputs;
    std::uint64_t seed = 0;
    unsigned threads = 1;
    u64 memory_limit = 0;
    double seconds_limit = 0;
};

/// The values that a filter gave, with the report of the step. The failure is in the report.
struct Answer {
    std::vector<std::pair<std::string, Value>> outputs;
    NodeReport report;
};

/// Runs the filter in this process.
Answer run_here(const Request& request, Beside& beside) {
    const auto declaration = [&]() -> const FilterDeclaration& {
        Library& library = shared_library();
        const std::scoped_lock lock(library.mutex);
        return library.filters.load(request.step->spec.name);
    };
    const ScratchFolder scratch;
    ContextOptions options;
    options.threads = request.threads;
    options.seed = request.seed;
    options.scratch = scratch.folder("filter");
    options.on_progress = [&](double fraction) { beside.progress = fraction; };
    options.is_cancelled = [&] { return beside.is_cancelled.load(); };
    std::vector<StepInput> inputs;
    for (const auto& [port, value] : request.inputs) inputs.push_back({port, value});
    Answer answer;
    try {
        const Outputs outputs = run_step(
            *request.step, declaration, inputs, std::move(options),
            [](const ParameterSet&, NodeReport&) { return std::optional<Outputs>(); }, answer.report);
        answer.outputs.assign(outputs.begin(), outputs.end());
    } catch (const Error& error) {
        answer.report.failure.cause = Cause::refused;
        answer.report.failure.error = error;
    } catch (const Cancelled&) {
        // the exception that cancelled the work is thrown instead
    } catch (const std::exception& error) {
        answer.report.failure.cause = Cause::exception;
        answer.report.failure.error = Error("{}: an unexpected error: {}", request.step->label, error.what());
    } catch (...) {
        answer.report.failure.cause = Cause::exception;
        answer.report.failure.error = Error("{}: an unexpected error", request.step->label);
    }
    return answer;
}

/// Runs the filter in a process of its own. Values pass as mapped files.
Answer run_isolated(const Request& request, const std::string& program, Beside& beside) {
    const std::size_t node = request.inputs.size();
    StepWork work{request.step, {}, {}, {}, {}};
    {
        Library& library = shared_library();
        const std::scoped_lock lock(library.mutex);
        work.build = library.filters.build_id(request.step->spec.name);
    }
    WorkerProcesses workers({{program, "worker"}, 1, {}, static_cast<int>(KeepRule::Policy::never), {}});
    for (std::size_t i = 0; i < request.inputs.size(); ++i) {
        const auto& [port, value] = request.inputs[i];
        workers.values().put({i, ""}, EncodedValue(value));
        work.inputs.push_back({port, i, "", "", {}});
    }
    for (const PortSpec& port : request.step->spec.outputs) work.caching.needed.push_back(port.name);
    Job job;
    job.node = node;
    job.work = std::move(work);
    job.threads = request.threads;
    job.seed = request.seed;
    job.memory_limit = request.memory_limit;
    job.seconds_limit = request.seconds_limit;
    job.limit_text = "of the call";
    std::optional<JobReport> report;
    WorkerListener listener;
    listener.on_progress = [&](std::size_t, double fraction) { beside.progress = fraction; };
    listener.on_warning = [](std::size_t, std::string_view) {};  // the report repeats them
    listener.on_end = [&](std::size_t, JobReport ended) { report = std::move(ended); };
    workers.start(0, std::move(job));
    for (bool is_cancelled = false; !report;) {
        workers.wait(listener, std::chrono::milliseconds(20));
        if (!is_cancelled && beside.is_cancelled) {
            is_cancelled = true;
            workers.dismiss();
            return {};
        }
    }
    Answer answer;
    answer.report = std::move(report->node);
    if (!answer.report.failure)
        for (const PortSpec& port : request.step->spec.outputs)
            if (const std::optional<Value> value = workers.values().find({node, port.name}))
                answer.outputs.emplace_back(port.name, *value);
    return answer;
}

nb::dict described(const Answer& answer) {
    const NodeReport& report = answer.report;
    nb::dict outputs, parameters, result;
    for (const auto& [port, value] : answer.outputs) outputs[port.c_str()] = value;
    for (const auto& [name, value] : report.resolved.values) parameters[name.c_str()] = readable(text(value));
    nb::list metrics, doubts;
    for (const Metric& metric : report.metrics.values)
        metrics.append(nb::make_tuple(metric.name, metric.value, std::string(name_of(metric.unit))));
    for (const Doubt& doubt : report.doubts) doubts.append(nb::make_tuple(readable(doubt.text), doubt.port));
    result["outputs"] = outputs;
    result["parameters"] = parameters;
    result["metrics"] = metrics;
    result["unit"] =
        report.metrics.unit == LengthUnit::unknown ? nb::none() : nb::cast(std::string(symbol(report.metrics.unit)));
    result["warnings"] = readable(report.warnings);
    result["doubts"] = doubts;
    result["error"] = report.failure ? exception_of(report.failure.error) : nb::none();
    return result;
}

nb::dict run(const std::string& filter, const GivenInputs& inputs, const GivenParameters& parameters,
             std::uint64_t seed, unsigned threads, nb::object on_progress, const std::optional<std::string>& program,
             u64 memory_limit, double seconds_limit) {
    require_own_threads();
    auto step = std::make_shared<PlannedStep>();
    {
        Library& library = shared_library();
        const std::scoped_lock lock(library.mutex);
        step->spec = spec_of(library.filters, filter);
    }
    step->label = filter;
    step->parameters = parameters_from(step->spec, parameters);
    const Request request{step, inputs, seed, threads > 0 ? threads : usable_cores(), memory_limit, seconds_limit};
    const auto answer = std::make_shared<Answer>();
    const auto work = [request, program, answer](Beside& beside) {
        *answer = program ? run_isolated(request, *program, beside) : run_here(request, beside);
    };
    run_beside(work, on_progress);
    return described(*answer);
}

}  // namespace

void add_filters(nb::module_& module) {
    module.def("filters", [] {
        Library& library = shared_library();
        const std::scoped_lock lock(library.mutex);
        return library.filters.names();
    });
    module.def("unusable", [] {
        Library& library = shared_library();
        const std::scoped_lock lock(library.mutex);
        std::vector<std::pair<std::string, std::string>> reasons;
        for (const UnusableModule& unusable : library.filters.unusable())
            reasons.emplace_back(unusable.name, unusable.reason);
        return reasons;
    });
    module.def("declaration", [](const std::string& name) {
        Library& library = shared_library();
        const std::scoped_lock lock(library.mutex);
        return text_of(declaration_json(spec_of(library.filters, name)));
    });
    module.def("expectations", [](const std::string& name) {
        Library& library = shared_library();
        const std::scoped_lock lock(library.mutex);
        std::vector<std::pair<std::string, std::string>> texts;
        for (const ParameterSpec& parameter : spec_of(library.filters, name).parameters)
            texts.emplace_back(parameter.name, expectation(parameter));
        return texts;
    });
    module.def("run", &run, nb::arg("filter"), nb::arg("inputs"), nb::arg("parameters"), nb::arg("seed"),
               nb::arg("threads"), nb::arg("on_progress").none(), nb::arg("program").none(), nb::arg("memory_limit"),
               nb::arg("seconds_limit"));
    module.def("stop_all", &stop_all);
    module.def("core_library", [] { return core_library_file(); });
}

}  // namespace scanmill::python
