// SPDX-License-Identifier: GPL-3.0-or-later
#include "export/scripts.hpp"

#include <fmt/format.h>

#include <cassert>

#include "scanmill/base/text.hpp"

namespace scanmill::runner {

std::string filled(std::string_view pattern, const std::map<std::string, std::string, std::less<>>& values) {
    std::string text;
    while (true) {
        const std::size_t begin = pattern.find('@');
        text += pattern.substr(0, begin);
        if (begin == std::string_view::npos) return text;
        const std::size_t end = pattern.find('@', begin + 1);
        const auto value = values.find(pattern.substr(begin + 1, end - begin - 1));
        assert(value != values.end());
        text += value->second;
        pattern.remove_prefix(end + 1);
    }
}

std::string batch_command(const ExportPlan& plan, const std::string& chunk, const std::string& jobs) {
    const std::string folder = shell_word(plan.folder);
    return fmt::format("{} batch {} --cells {}/chunks/{}.json -o {}/parts/{} -j {} -q{}", plan.program,
                       shell_word(plan.batch), folder, chunk, folder, chunk, jobs,
                       plan.cache.empty() ? "" : " --cache " + shell_word(plan.cache));
}

std::string merge_command(const ExportPlan& plan) {
    return fmt::format("{} runs merge {}/parts/* -o {}", plan.program, shell_word(plan.folder),
                       shell_word(plan.result));
}

std::string page_command(const ExportPlan& plan) {
    if (!plan.has_page) return "true";
    return fmt::format("{} report {} --html {}", plan.program, shell_word(plan.result),
                       shell_word(plan.result / "report.html"));
}

std::string missing_program(const ExportPlan& plan, const std::string& node) {
    const std::string sentence =
        fmt::format("cannot run {}; install Scanmill there, or export the batch with --program PATH", plan.program);
    return fmt::format("[ $code -eq 126 ] || [ $code -eq 127 ] && echo \"error: {} \"{}", node, shell_word(sentence));
}

}  // namespace scanmill::runner
