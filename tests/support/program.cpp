// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/program.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <stdexcept>

#include "support/temporary_folder.hpp"

namespace scanmill::test {

namespace {

[[noreturn]] void become(const std::vector<std::string>& arguments, const ProgramOptions& options, const char* out,
                         const char* err) {
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
    std::vector<char*> texts{const_cast<char*>(SCANMILL_PROGRAM)};
    for (const std::string& argument : arguments) texts.push_back(const_cast<char*>(argument.c_str()));
    texts.push_back(nullptr);
    ::execv(SCANMILL_PROGRAM, texts.data());
    ::_exit(127);
}

}  // namespace

ProgramResult scanmill_program(const std::vector<std::string>& arguments, const ProgramOptions& options) {
    const TemporaryFolder folder;
    const std::string out = (folder / "out").string(), err = (folder / "err").string();
    ProgramOptions own = options;
    if (own.cache.empty()) own.cache = folder / "cache";
    const pid_t child = ::fork();
    if (child < 0) throw std::runtime_error("the program could not be started");
    if (child == 0) become(arguments, own, out.c_str(), err.c_str());
    int status = 0;
    ::waitpid(child, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), content_of(out), content_of(err)};
}

}  // namespace scanmill::test
