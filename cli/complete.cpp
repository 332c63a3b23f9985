// SPDX-License-Identifier: Apache-2.0
#include "cli/complete.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <functional>
#include <iterator>
#include <ostream>
#include <utility>

#include "asip/bus/registry/board_match.hpp"
#include "asip/program/command_words.hpp"
#include "asip/text/printable.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/find/target.hpp"

namespace asip::cli {
namespace {

using Words = std::vector<std::string>;

Words units_of(const model::ModelSet& models) {
    Words result;
    const auto add = [&result](const std::vector<model::Field>& fields) {
        for (const auto& field : fields)
            if (!field.unit.empty()) result.push_back(field.unit);
    };
    for (const auto& name : models.names()) {
        const auto model = models.find(name);
        for (const auto& event : model->events)
            add(event.fields);
        for (const auto& command : model->commands)
            add(command.args);
    }
    return result;
}

/// From the bus while `connected` holds, and from the models of `environment`. All three must outlive the
/// result.
NameSources bus_names(const Environment& environment, BoardSource& source, std::function<bool()> connected) {
    const auto board = [&source, connected](const std::string& name) {
        return connected() ? source.retained_board(name) : std::nullopt;
    };
    const auto model = [&environment, board](const std::string& name, const std::string& service) {
        const auto found = board(name);
        const auto info = found ? find_service(*found, service) : failure(program::kExitFailure, {});
        return info ? bus::model_of(*info, environment.models()) : nullptr;
    };
    NameSources names;
    names.boards = [&source, connected] { return connected() ? source.names() : Words(); };
    names.services = [board](const std::string& name) {
        const auto found = board(name);
        return found ? found->service_names() : Words();
    };
    names.commands = [model](const std::string& name, const std::string& service) {
        Words result;
        if (const auto found = model(name, service))
            for (const auto& command : found->commands)
                result.push_back(command.name);
        return result;
    };
    names.fields = [model](const std::string& name, const std::string& service) {
        Words result;
        if (const auto found = model(name, service))
            for (const auto& event : found->events)
                result.push_back(event.name);
        return result;
    };
    names.kinds = [&environment] { return environment.models().names(); };
    names.units = [&environment] { return units_of(environment.models()); };
    names.labels = [&source, connected] {
        Words result;
        if (!connected()) return result;
        const auto boards = source.boards({});
        if (!boards) return result;
        for (const auto& each : *boards)
            for (const auto& [key, value] : each.labels.labels)
                result.push_back(key + "=" + value);
        return result;
    };
    return names;
}

using WordKind = program::CommandWord::Kind;

constexpr std::chrono::milliseconds kBusPatience{700};

Words starting_with(Words candidates, const std::string& start) {
    std::erase_if(candidates, [&start](const std::string& one) { return !one.starts_with(start); });
    std::sort(candidates.begin(), candidates.end());
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
    return candidates;
}

Words split(const std::string& text, char at) {
    Words parts;
    for (std::size_t begin = 0; begin <= text.size();) {
        const auto end = std::min(text.find(at, begin), text.size());
        parts.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return parts;
}

/// Which parts of BOARD/SERVICE/FIELD a place takes.
struct Depth {
    std::size_t least = 1;
    std::size_t most = 1;
};

Words targets(const std::string& start, const NameSources& names, Depth depth) {
    const auto parts = split(start, '/');
    const auto level = parts.size();
    if (level > depth.most) return {};
    const auto found = level == 1   ? names.boards()
                       : level == 2 ? names.services(parts[0])
                                    : names.fields(parts[0], parts[1]);
    const auto before = start.substr(0, start.rfind('/') + 1);
    Words result;
    for (const auto& name : found) {
        if (level >= depth.least) result.push_back(before + name);
        if (level < depth.most) result.push_back(before + name + "/");
    }
    return result;
}

Words commands(const Words& arguments, const NameSources& names) {
    const auto parts = split(arguments.empty() ? "" : arguments.front(), '/');
    return arguments.size() == 1 && parts.size() == 2 ? names.commands(parts[0], parts[1]) : Words();
}

Words verbs(const CLI::App& app) {
    Words result;
    for (const auto* command : app.get_subcommands([](const CLI::App*) { return true; }))
        result.push_back(command->get_name());
    return result;
}

Words offered(const CLI::App& app, const std::string& type, const std::string& start, const Words& arguments,
              const NameSources& names) {
    if (type.find('|') != std::string::npos) {
        auto words = split(type, '|');
        if (std::erase(words, "KIND") > 0) std::ranges::copy(names.kinds(), std::back_inserter(words));
        return words;
    }
    if (type == "BOARD" || type == "PATTERN") return targets(start, names, {1, 1});
    if (type == "BOARD[/SERVICE]") return targets(start, names, {1, 2});
    if (type == "BOARD/SERVICE") return targets(start, names, {2, 2});
    if (type == "BOARD[/SERVICE[/FIELD]]") return targets(start, names, {1, 3});
    if (type == "COMMAND") return commands(arguments, names);
    if (type == "KIND") return names.kinds();
    if (type == "UNIT") return names.units();
    if (type == "SELECTOR" || type == "LABEL") return names.labels();
    if (type == "VERB") return verbs(app);
    if (type == "FILE") return {kOfferFiles};
    if (type == "DIR") return {kOfferFolders};
    return {};
}

/// Type by which help shows what stands here.
std::string type_of(const CLI::Option& option) {
    return option.get_positional() ? option.get_name(true) : option.get_type_name();
}

Words values(const CLI::App& app, const CLI::Option& option, const std::string& start, const Words& arguments,
             const NameSources& names) {
    // In `distance,se` only the last part is still open.
    const bool list = option.get_delimiter() == ',' || type_of(option) == "SELECTOR";
    const auto comma = list ? start.rfind(',') : std::string::npos;
    const auto before = comma == std::string::npos ? std::string() : start.substr(0, comma + 1);
    const auto open = start.substr(before.size());
    auto found = offered(app, type_of(option), open, arguments, names);
    if (found == Words{kOfferFiles} || found == Words{kOfferFolders}) return found;
    std::erase(found, "...");
    for (auto& one : found)
        one = before + one;
    return starting_with(std::move(found), start);
}

Words option_names(const CLI::App* app) {
    Words names;
    for (; app != nullptr; app = app->get_parent()) {
        for (const auto* option : app->get_options()) {
            for (const auto& name : option->get_lnames())
                names.push_back("--" + name);
            for (const auto& name : option->get_snames())
                names.push_back("-" + name);
        }
    }
    return names;
}

std::string with_backslashes(const std::string& text) {
    std::string result;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        const bool harmless = byte >= 0x80 || std::isalnum(byte) || std::strchr("._-/=:,+@%", c) != nullptr;
        if (!harmless) result += '\\';
        result += c;
    }
    return result;
}

}  // namespace

std::vector<std::string> complete(const CLI::App& app, const std::vector<std::string>& words,
                                  const std::string& start, const NameSources& names) {
    const auto read = program::classify(app, words);
    const auto next = program::next_word(app, words);
    Words arguments;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (read[i].kind == WordKind::kUnknownSubcommand) return {};
        if (read[i].kind == WordKind::kArgument) arguments.push_back(words[i]);
    }
    if (next.kind == WordKind::kValue) return values(app, *next.option, start, arguments, names);
    if (start.starts_with("--") && start.find('=') != std::string::npos) {
        const auto name = start.substr(0, start.find('='));
        const auto option = program::classify(*next.app, {name}).front().option;
        if (option == nullptr) return {};
        auto found = values(app, *option, start.substr(name.size() + 1), arguments, names);
        for (auto& one : found)
            if (!one.starts_with(":")) one = name + "=" + one;
        return found;
    }
    if (start.starts_with("-")) return starting_with(option_names(next.app), start);
    if (next.kind == WordKind::kSubcommand) return starting_with(verbs(app), start);
    return next.option == nullptr ? Words() : values(app, *next.option, start, arguments, names);
}

ShellLine typed_shell_line(const std::string& line) {
    ShellLine result;
    auto& words = result.words;
    bool inside = false;
    const auto word = [&]() -> std::string& {
        if (!std::exchange(inside, true)) words.emplace_back();
        return words.back();
    };
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        const bool last = i + 1 == line.size();
        const auto escapes = [&](const char* of) {
            return c == '\\' && !last && std::strchr(of, line[i + 1]);
        };
        if (result.quote != '\0') {
            if (c == result.quote)
                result.quote = '\0';
            else
                word() += result.quote == '"' && escapes("\"\\$`") ? line[++i] : c;
        } else if (c == ' ' || c == '\t' || c == '\n') {
            inside = false;
        } else if (c == '\'' || c == '"') {
            result.quote = c;
            result.unquoted = word().size();
        } else if (c == '\\') {
            if (!last) word() += line[++i];
        } else {
            word() += c;
        }
    }
    if (inside && words.size() > 1) {
        result.start = std::move(words.back());
        words.pop_back();
    }
    if (!words.empty()) words.erase(words.begin());
    return result;
}

std::vector<std::string> without_unshowable(std::vector<std::string> candidates) {
    std::erase_if(candidates, [](const std::string& one) { return !text::is_showable(one); });
    return candidates;
}

std::vector<std::string> for_bash(std::vector<std::string> candidates, const ShellLine& typed) {
    const bool quoted = typed.quote != '\0';
    const auto last = typed.start.find_last_of("=:");
    const auto replaced_from = quoted ? typed.unquoted : last == std::string::npos ? 0 : last + 1;
    const char* const breaks = typed.quote == '\'' ? "'" : "\"\\$`!";
    Words result;
    for (const auto& candidate : candidates) {
        if (candidate == kOfferFiles || candidate == kOfferFolders) {
            result.push_back(candidate);
            continue;
        }
        const auto part = candidate.substr(std::min(replaced_from, candidate.size()));
        if (!quoted)
            result.push_back(with_backslashes(part));
        else if (part.find_first_of(breaks) == std::string::npos)
            result.push_back(part);
    }
    return result;
}

int run_complete(const std::vector<std::string>& arguments, CommandLine& line, Environment& environment) {
    if (arguments.size() != 2) return program::kExitUsage;
    const auto typed = typed_shell_line(arguments[1]);
    Words options;
    for (const auto& [name, value] : line.typed_options(typed.words))
        options.push_back("--" + name + "=" + value);
    options.insert(options.end(), {"completion", "bash"});
    if (line.parse(std::move(options)) || !line.apply(environment)) return program::kExitOk;
    environment.timeout = std::min(environment.timeout, kBusPatience);
    BusSession session(environment);
    session.on_connection_change({});  // what it says would stand in the line that is typed
    BoardSource source(environment, session);
    std::optional<bool> there;
    const auto connected = [&] {
        if (!there) there = session.connect().has_value();
        return *there;
    };
    auto found = without_unshowable(
        complete(line.app(), typed.words, typed.start, bus_names(environment, source, connected)));
    if (arguments[0] == "bash") found = for_bash(std::move(found), typed);
    for (const auto& candidate : found)
        environment.out << candidate << '\n';
    environment.out << std::flush;
    return program::kExitOk;
}

}  // namespace asip::cli
