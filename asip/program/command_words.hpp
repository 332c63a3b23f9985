// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace asip::program {

/// A word of a command line, to a program and its subcommands.
struct CommandWord {
    enum class Kind {
        kSubcommand,
        kOption,            ///< `--state`, `--state=lost`, `-w`
        kValue,             ///< of the option before it
        kArgument,          ///< positional
        kUnknownOption,     ///< no such option, here or in the program
        kUnknownSubcommand  ///< the first word that is not an option, where a subcommand must stand
    };
    Kind kind = Kind::kArgument;
    const CLI::App* app = nullptr;  ///< the subcommand that the word is for, or the program
    /// kOption, kValue, and the positional of kArgument where there is one.
    const CLI::Option* option = nullptr;
    std::size_t position = 0;  ///< kArgument: how many arguments stand before it
};

/// It is not a flag.
bool takes_value(const CLI::Option& option);

/// As CLI11 will read each word (without the program's name). `app` must outlive the result. Nothing is
/// stored.
std::vector<CommandWord> classify(const CLI::App& app, const std::vector<std::string>& words);

/// A subcommand, the last option's value, or an argument.
CommandWord next_word(const CLI::App& app, const std::vector<std::string>& words);

/// Names the first unknown option or subcommand and the nearest, or all of a few; nothing: all are known.
std::optional<std::string> unknown_word(const CLI::App& app, const std::vector<std::string>& words);

/// Names the first argument without a place, and those that the command takes.
std::optional<std::string> word_too_many(const CLI::App& app, const std::vector<std::string>& words);

/// `option` refuses other values, with the nearest. Help and completion read its type (`auto|always|never`).
CLI::Option* one_of(CLI::Option* option, std::vector<std::string> words);

}  // namespace asip::program
