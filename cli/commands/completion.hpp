#pragma once
#include <functional>
#include <string>
#include <vector>

#include "cli/context.hpp"

namespace asip::cli {

/// The script that a shell reads: `source <(asipctl completion bash)`.
std::string completion_script(const std::string& shell);

/// Where live names come from; each is asked only when needed.
struct NameSources {
    std::function<std::vector<std::string>()> boards;
    std::function<std::vector<std::string>(const std::string& board)> services;
    std::function<std::vector<std::string>(const std::string& board, const std::string& service)> commands;
};

/// A subcommand as completion sees it.
struct CommandShape {
    std::string name;
    std::vector<std::string> options;           ///< `--watch`, `-w`
    std::vector<std::string> options_of_value;  ///< those that take a value
};

/// What may stand for `words[at]`; `words[0]` is the subcommand. Pure but for the sources.
std::vector<std::string> complete(const std::vector<std::string>& words, std::size_t at,
                                  const std::vector<CommandShape>& commands, const NameSources& names);

/// `asipctl __complete AT WORD...`, which the scripts call: candidates, one a line. Silent when there is no
/// bus.
int run_complete(const std::vector<std::string>& words, std::size_t at,
                 const std::vector<CommandShape>& commands, Context& context);

}  // namespace asip::cli
