// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/program.hpp"
#include "support/folders.hpp"

#include <fcntl.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <stdexcept>

#include "support/output_schemas.hpp"

namespace scanmill::test {

namespace {

[[noreturn]] void become(const std::vector<std::string>& arguments, const ProgramOptions& options, const char* out,
                         const char* err) {
    if (options.own_group) ::setpgid(0, 0);
    const int input = ::open("/dev/null", O_RDONLY);
    const int output = ::open(out, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int errors = ::open(err, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::dup2(input, STDIN_FILENO);
    ::dup2(output, STDOUT_FILENO);
    ::dup2(errors, STDERR_FILENO);
    if (!options.folder.empty() && ::chdir(options.folder.c_str()) != 0) ::_exit(126);
    const auto limit = [](__rlimit_resource resource, std::size_t most) {
        const rlimit both{most, most};
        if (most > 0) ::setrlimit(resource, &both);
    };
    limit(RLIMIT_AS, options.memory_limit);
    limit(RLIMIT_FSIZE, options.file_limit);
    limit(RLIMIT_CPU, options.seconds_limit);
    constexpr unsigned nobody = 65534;
    if (options.without_rights && ::geteuid() == 0 && (::setgid(nobody) != 0 || ::setuid(nobody) != 0)) ::_exit(126);
    ::setenv("XDG_CACHE_HOME", options.cache.c_str(), 1);
    for (const std::string& variable : options.environment) {
        const std::size_t equals = variable.find('=');
        ::setenv(variable.substr(0, equals).c_str(), variable.substr(equals + 1).c_str(), 1);
    }
    std::vector<char*> texts{const_cast<char*>(program_file().c_str())};
    for (const std::string& argument : arguments) texts.push_back(const_cast<char*>(argument.c_str()));
    texts.push_back(nullptr);
    ::execv(program_file().c_str(), texts.data());
    ::_exit(127);
}

}  // namespace

RunningProgram::RunningProgram(const std::vector<std::string>& arguments, const ProgramOptions& options) {
    const std::string out = (folder_ / "out").string(), err = (folder_ / "err").string();
    ProgramOptions own = options;
    if (own.cache.empty()) own.cache = folder_ / "cache";
    process_ = ::fork();
    if (process_ < 0) throw std::runtime_error("the program could not be started");
    if (process_ == 0) become(arguments, own, out.c_str(), err.c_str());
    if (own.own_group) ::setpgid(process_, process_);  // whoever comes first
}

RunningProgram::~RunningProgram() {
    signal(SIGKILL);
    wait();
}

void RunningProgram::signal(int number) const {
    if (!has_ended_) ::kill(process_, number);
}

void RunningProgram::signal_group(int number) const {
    if (!has_ended_) ::kill(-process_, number);
}

bool RunningProgram::has_ended() {
    if (!has_ended_) has_ended_ = ::waitpid(process_, &status_, WNOHANG) == process_;
    return has_ended_;
}

ProgramResult RunningProgram::wait() {
    if (!has_ended_) ::waitpid(process_, &status_, 0);
    has_ended_ = true;
    return {WIFEXITED(status_) ? WEXITSTATUS(status_) : -WTERMSIG(status_), out(), err()};
}

std::string RunningProgram::out() const { return content_of(folder_ / "out"); }
std::string RunningProgram::err() const { return content_of(folder_ / "err"); }

ProgramResult scanmill_program(const std::vector<std::string>& arguments, const ProgramOptions& options) {
    ProgramResult result = RunningProgram(arguments, options).wait();
    const bool is_json = std::find(arguments.begin(), arguments.end(), "--json") != arguments.end();
    for (const auto& [schema, document] :
         is_json ? output_documents(arguments, result.out) : std::vector<OutputDocument>())
        EXPECT_EQ(schema_errors(schema, document), "") << fmt::format("scanmill {}", fmt::join(arguments, " "));
    return result;
}

}  // namespace scanmill::test
