// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/filter/module_trial.hpp"

#include <dlfcn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <string>

#include "scanmill/filter/error.hpp"

namespace scanmill {

namespace {

constexpr unsigned patience = 30;  // seconds
constexpr int came_back = 113;  // an exit code that a module's own exit() hardly has

/// noexcept: what a static object throws must end the copy here, and not let it go on as if it were the program.
[[noreturn]] void load_and_end(const char* module, int said) noexcept {
    const rlimit no_dump{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_dump);
    ::dup2(said, STDOUT_FILENO);
    ::dup2(said, STDERR_FILENO);
    for (int signal : {SIGABRT, SIGSEGV, SIGALRM}) ::signal(signal, SIG_DFL);
    // What this program does when it ends is none of the copy's business.
    ::on_exit([](int code, void*) { ::_exit(code); }, nullptr);
    ::alarm(patience);
    ::dlopen(module, RTLD_NOW | RTLD_LOCAL);
    ::_exit(came_back);
}

std::string all_of(int descriptor) {
    constexpr std::size_t enough = 1 << 16;
    std::string text;
    char block[4096];
    for (ssize_t got; (got = ::read(descriptor, block, sizeof block)) != 0;) {
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) break;
        text.append(block, static_cast<std::size_t>(got));
        if (text.size() > enough) text.erase(0, text.size() - enough);
    }
    return text;
}

std::string last_line(std::string_view text) {
    const std::size_t end = text.find_last_not_of(" \n\r\t");
    if (end == std::string_view::npos) return {};
    text = text.substr(0, end + 1);
    const std::size_t begin = text.find_last_of('\n');
    text.remove_prefix(text.find_first_not_of(" \t", begin == std::string_view::npos ? 0 : begin + 1));
    return std::string(text);
}

}  // namespace

void require_harmless_loading(const std::filesystem::path& module) {
    int ends[2];
    if (::pipe(ends) != 0) throw Error("module '{}' was not tried: {}", module.string(), std::strerror(errno));
    std::fflush(nullptr);  // what waits there is not the copy's to write
    const pid_t child = ::fork();
    if (child == 0) load_and_end(module.c_str(), ends[1]);
    const int fork_error = errno;
    ::close(ends[1]);
    const std::string said = child < 0 ? std::string() : all_of(ends[0]);
    ::close(ends[0]);
    if (child < 0) throw Error("module '{}' was not tried: {}", module.string(), std::strerror(fork_error));
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (WIFEXITED(status) && WEXITSTATUS(status) == came_back) return;
    const std::string why = WIFEXITED(status) ? fmt::format("it calls exit({})", WEXITSTATUS(status))
                            : WTERMSIG(status) == SIGALRM
                                ? fmt::format("it has not come back after {} seconds", patience)
                                : fmt::format("signal {} ({})", WTERMSIG(status), ::strsignal(WTERMSIG(status)));
    const std::string words = last_line(said);
    throw Error("module '{}' would end this program while it is loaded: {}{}", module.string(), why,
                words.empty() ? "" : "; it said: " + words)
        .hint("take it out of its folder, or ask who built it");
}

}  // namespace scanmill
