#include "cli/commands/completion.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ostream>

#include "cli/board_source.hpp"
#include "cli/command.hpp"
#include "cli/target.hpp"

namespace asip::cli {
namespace {

constexpr const char* kBashScript =
    R"script(# Completion of asipctl for bash:  source <(asipctl completion bash)
_asipctl() {
    local IFS=$'\n'
    COMPREPLY=($(asipctl __complete "$((COMP_CWORD - 1))" "${COMP_WORDS[@]:1}" 2>/dev/null))
    # A board may go on with a service: no blank after BOARD/.
    if [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == */ ]]; then compopt -o nospace; fi
}
complete -o default -F _asipctl asipctl
)script";

constexpr const char* kZshScript = R"script(#compdef asipctl
# Completion of asipctl for zsh:  source <(asipctl completion zsh)
_asipctl() {
    local -a found whole open
    found=("${(@f)$(asipctl __complete "$((CURRENT - 2))" "${(@)words[2,-1]}" 2>/dev/null)}")
    whole=(${found:#*/})
    open=(${(M)found:#*/})
    (( ${#whole} )) && compadd -a whole
    (( ${#open} )) && compadd -S '' -a open
}
compdef _asipctl asipctl
)script";

using Words = std::vector<std::string>;

Words starting_with(Words candidates, const std::string& start) {
    std::erase_if(candidates, [&start](const std::string& one) { return !one.starts_with(start); });
    std::sort(candidates.begin(), candidates.end());
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
    return candidates;
}

/// Boards, or the services of the board that `start` names; `all_boards`: a board alone is a whole argument.
Words targets(const std::string& start, const NameSources& names, bool board_alone) {
    const auto slash = start.find('/');
    if (slash == std::string::npos) {
        Words result;
        for (const auto& board : starting_with(names.boards(), start)) {
            if (board_alone) result.push_back(board);
            result.push_back(board + "/");
        }
        return result;
    }
    Words result;
    const auto board = start.substr(0, slash);
    for (const auto& service : names.services(board))
        result.push_back(board + "/" + service);
    return starting_with(std::move(result), start);
}

Words positional(const std::string& command, const Words& before, const std::string& start,
                 const NameSources& names) {
    const auto position = before.size();
    if (command == "list" && position == 0) return starting_with({"boards", "services"}, start);
    if (command == "completion" && position == 0) return starting_with({"bash", "zsh"}, start);
    if (command == "show" && position == 0) return targets(start, names, true);
    if (command == "subscribe") return targets(start, names, true);
    if (command == "send" && position == 0) return targets(start, names, false);
    if (command == "send" && position == 1) {
        const auto slash = before[0].find('/');
        if (slash == std::string::npos) return {};
        return starting_with(names.commands(before[0].substr(0, slash), before[0].substr(slash + 1)), start);
    }
    const bool takes_board = command == "pin" || command == "ping" || command == "forget" || command == "top";
    if (takes_board && position == 0) return starting_with(names.boards(), start);
    if (command == "pin" && position == 2) {
        return starting_with({"high", "low", "input", "pullup", "output", "analog", "pwm"}, start);
    }
    return {};
}

const CommandShape* find_shape(const std::vector<CommandShape>& commands, const std::string& name) {
    const auto found =
        std::find_if(commands.begin(), commands.end(), [&](const auto& one) { return one.name == name; });
    return found == commands.end() ? nullptr : &*found;
}

bool takes_value(const CommandShape& shape, const std::string& option) {
    return std::find(shape.options_of_value.begin(), shape.options_of_value.end(), option) !=
           shape.options_of_value.end();
}

Words option_values(const std::string& option) {
    if (option == "-o" || option == "--output") return {"table", "wide", "text", "json", "jsonl", "name"};
    if (option == "--state") return {"online", "offline", "lost", "sleeping", "updating"};
    if (option == "--capability") return {"digital", "analog", "pwm"};
    if (option == "--color") return {"auto", "always", "never"};
    if (option == "--only") return {"boards", "commands", "orphans", "names", "registries"};
    return {};
}

}  // namespace

std::string completion_script(const std::string& shell) {
    return shell == "zsh" ? kZshScript : kBashScript;
}

std::vector<std::string> complete(const std::vector<std::string>& words, std::size_t at,
                                  const std::vector<CommandShape>& commands, const NameSources& names) {
    const auto start = at < words.size() ? words[at] : std::string();
    if (at == 0) {
        Words all;
        for (const auto& command : commands)
            all.push_back(command.name);
        return starting_with(std::move(all), start);
    }
    const auto* shape = words.empty() ? nullptr : find_shape(commands, words[0]);
    if (shape == nullptr) return {};
    if (start.starts_with("-")) return starting_with(shape->options, start);
    if (at <= words.size() && takes_value(*shape, words[at - 1]))
        return starting_with(option_values(words[at - 1]), start);
    Words before;
    for (std::size_t i = 1; i < std::min(at, words.size()); ++i) {
        if (words[i].starts_with("-")) {
            if (takes_value(*shape, words[i])) ++i;
        } else {
            before.push_back(words[i]);
        }
    }
    return positional(shape->name, before, start, names);
}

int run_complete(const std::vector<std::string>& words, std::size_t at,
                 const std::vector<CommandShape>& commands, Context& context) {
    context.timeout = std::min(context.timeout, std::chrono::milliseconds(700));
    BusSession session(context);
    BoardSource source(context, session);
    bool tried = false;
    bool connected = false;
    const auto bus = [&] {
        if (!std::exchange(tried, true)) connected = session.connect().has_value();
        return connected;
    };
    NameSources names;
    names.boards = [&] { return bus() ? source.names() : Words(); };
    names.services = [&](const std::string& board) {
        if (!bus()) return Words();
        const auto found = source.retained_board(board);
        return found ? found->service_names() : Words();
    };
    names.commands = [&](const std::string& board, const std::string& service) {
        Words result;
        const auto found = bus() ? source.retained_board(board) : std::nullopt;
        const auto info = found ? find_service(*found, service) : failure(1, "");
        const auto model = info ? model_of(*info, context.models()) : nullptr;
        if (!model) return result;
        for (const auto& command : model->commands)
            result.push_back(command.name);
        return result;
    };
    for (const auto& candidate : complete(words, at, commands, names))
        context.out << candidate << '\n';
    context.out << std::flush;
    return program::kExitOk;
}

void setup_completion(CLI::App& app, Chosen& chosen) {
    auto* command = app.add_subcommand("completion",
                                       "Script that completes commands, boards, services and their commands");
    command->fallthrough();
    auto shell = std::make_shared<std::string>();
    command->add_option("shell", *shell, "bash or zsh")
        ->required()
        ->check(CLI::IsMember({"bash", "zsh"}))
        ->type_name("");
    command->footer(
        "Examples:\n  source <(asipctl completion bash)\n  asipctl completion zsh > ~/.zfunc/_asipctl");
    command->callback([&chosen, shell] {
        chosen = [shell](Context& context) {
            context.out << completion_script(*shell) << std::flush;
            return program::kExitOk;
        };
    });
}

}  // namespace asip::cli
