// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/batch/plan_batch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "commands/execute.hpp"
#include "commands/load.hpp"
#include "output/error_output.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/plugin/module.hpp"
#include "scanmill/workflow/document.hpp"

namespace scanmill::runner {

namespace {

struct Options {
    std::string file;
    ExecuteOptions execute;
};

RunRequest request_for(const Batch& batch, const BatchPart& part, const ExecuteOptions& options) {
    RunRequest request;
    for (const std::size_t index : part.scans) {
        const BatchScan& scan = batch.scans[index];
        ScanFile file(scan.file);
        file.unit = scan.unit;
        file.frame = scan.frame;
        file.pose = scan.pose;
        request.scans.push_back(std::move(file));
        for (const std::filesystem::path& other : {scan.truth, scan.pose_file})
            if (!other.empty()) request.protected_files.push_back(other);
    }
    request.protected_files.emplace_back(batch.file);
    request.output_folder = options.output_folder;
    request.seed = options.seed;
    return request;
}

int run_batch(const Options& options) {
    const std::string text = read_workflow_file(options.file);
    if (!is_batch(text))
        throw Error("'{}' is no batch: it has no key `batch`", options.file)
            .hint("a workflow is run by: scanmill run WORKFLOW SCAN…");
    const Warn warn = warning_teller();
    const std::unique_ptr<Cache> cache = open_cache(options.execute.cache, warn);
    const std::unique_ptr<Session> session = open_session(options.execute, cache.get());
    FilterLibrary library = open_library();
    CheckedBatch checked = check_batch(text, options.file, library);
    nlohmann::ordered_json found = nlohmann::ordered_json::array();
    for (const Diagnostics& diagnostics : checked.diagnostics) {
        print(diagnostics);
        found.push_back(to_json(diagnostics));
    }
    if (checked.has_errors()) {
        if (options.execute.json) print_files_json(std::move(found));
        return bad_request;
    }

    std::vector<GraphPart> parts;
    for (const BatchPart& part : checked.parts)
        parts.push_back({part.plan, request_for(checked.batch, part, options.execute)});
    const auto hash = [&](const std::filesystem::path& file) {
        return cache ? cache->file_hash(file) : content_hash(file);
    };
    SessionTask task{checked.batch.name, options.file, make_graph(parts, library, hash), checked.batch.limits};
    return execute(task, true, *session, library, warn, options.execute);
}

}  // namespace

void add_batch(CLI::App& app, Action& chosen, std::vector<std::string> command_line) {
    CLI::App* command = app.add_subcommand("batch", "Runs workflows over a library of scans, as a batch file says");
    auto options = std::make_shared<Options>();
    options->execute.command_line = std::move(command_line);
    command->add_option("FILE", options->file, "The batch file")->required();
    add_execute_options(*command, options->execute);
    command->add_flag("--json", options->execute.json, "Print what happens as JSON, a line each");
    command->callback([&chosen, options] { chosen = [options] { return run_batch(*options); }; });
}

}  // namespace scanmill::runner
