// SPDX-License-Identifier: Apache-2.0
#include "cli/shell/shell_words.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "asip/program/command_words.hpp"
#include "asip/text/file_text.hpp"
#include "cli/find/target.hpp"

namespace asip::cli {
namespace {

using Words = std::vector<std::string>;

bool is_control(char c) {
    return (static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\r') || c == 0x7f;
}

const CLI::App* verb_of(const CLI::App& app, const std::string& word) {
    const auto found = app.get_subcommands([&word](const CLI::App* one) { return one->get_name() == word; });
    return found.empty() ? nullptr : found.front();
}

/// How help shows the verb's arguments.
Words argument_types(const CLI::App& verb) {
    Words result;
    for (const auto* option : verb.get_options()) {
        if (option->get_positional()) result.push_back(option->get_name(true));
    }
    return result;
}

/// Where the arguments stand among `words`.
std::vector<std::size_t> arguments_of(const CLI::App& app, const Words& words) {
    const auto read = program::classify(app, words);
    std::vector<std::size_t> result;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (read[i].kind == program::CommandWord::Kind::kArgument) result.push_back(i);
    }
    return result;
}

std::string target_on(const std::string& board, const std::string& word) {
    return word == board || word.starts_with(board + "/") ? word : board + "/" + word;
}

Words with_board(Words words, const std::string& board) {
    words.insert(words.begin() + 1, board);
    return words;
}

}  // namespace

const std::vector<std::string>& shell_commands() {
    static const Words commands{"exit", "quit", "values"};
    return commands;
}

Expected<std::vector<std::string>> shell_words(std::string_view line) {
    line = text::without_mark(line);  // as some editors begin a file
    if (line.size() > kMaxShellLine)
        return fail("a line of more than " + std::to_string(kMaxShellLine) + " bytes is not taken");
    if (std::any_of(line.begin(), line.end(), is_control))
        return fail("the line has control characters; type it again");
    return split_words(line);
}

std::vector<std::string> expand_words(const CLI::App& app, const std::vector<std::string>& words,
                                      const std::string& board) {
    if (words.empty() || words.front().starts_with("-")) return words;
    const auto* verb = verb_of(app, words.front());
    if (verb == nullptr) {
        Words result{"send", target_on(board, words.front())};
        result.insert(result.end(), words.begin() + 1, words.end());
        return result;
    }
    const auto types = argument_types(*verb);
    const auto type = types.empty() ? std::string() : types.front();
    const auto arguments = arguments_of(app, words);
    const bool everywhere = std::find(words.begin(), words.end(), "--all") != words.end();
    if (types.size() > 1 && !type.starts_with("BOARD") && types[1].starts_with("BOARD") &&
        arguments.size() == 1) {  // `record FILE`: the boards are left out
        Words result = words;
        result.push_back(board);
        return result;
    }
    if (type == "PATTERN") return arguments.empty() && !everywhere ? with_board(words, board) : words;
    if (!type.starts_with("BOARD")) return words;
    if (type == "BOARD") {
        const bool named = !arguments.empty() && words[arguments.front()] == board;
        return named || everywhere ? words : with_board(words, board);
    }
    if (arguments.empty())
        return type.starts_with("BOARD/") && type != "BOARD/SERVICE" ? words : with_board(words, board);
    // `label room=lab`: the board is left out.
    const auto& first = words[arguments.front()];
    if (type == "BOARD[/SERVICE]" && (first.find('=') != std::string::npos || first.ends_with('-')))
        return with_board(words, board);
    Words result = words;
    const bool all = program::classify(app, words)[arguments.front()].option->get_items_expected_max() > 1;
    for (std::size_t i = 0; i < (all ? arguments.size() : 1); ++i)
        result[arguments[i]] = target_on(board, result[arguments[i]]);
    return result;
}

std::vector<std::string> complete_shell(const CLI::App& app, const std::string& typed,
                                        const std::string& board, const NameSources& names) {
    const auto line = typed_line("asipctl " + typed);
    if (line.words.empty()) {
        auto found = complete(app, {}, line.start, names);
        for (auto words : {names.services(board), shell_commands()})
            std::copy_if(words.begin(), words.end(), std::back_inserter(found),
                         [&line](const std::string& word) { return word.starts_with(line.start); });
        std::sort(found.begin(), found.end());
        found.erase(std::unique(found.begin(), found.end()), found.end());
        return found;
    }
    auto all = line.words;
    all.push_back(line.start);
    if (line.words.front() == "values") {
        all.front() = "subscribe";
    }
    auto expanded = expand_words(app, all, board);
    const auto start = expanded.back();
    expanded.pop_back();
    auto found = complete(app, expanded, start, names);
    const auto added = start.size() - line.start.size();
    for (auto& one : found) {
        if (!one.starts_with(":")) one.erase(0, std::min(added, one.size()));
    }
    return found;
}

}  // namespace asip::cli
