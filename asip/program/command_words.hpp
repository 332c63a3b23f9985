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

/// What one word of a command line is to a program and its subcommands.
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

/// Whether the option needs a value: it is not a flag.
bool takes_value(const CLI::Option& option);

/// Each word of a command line (without the program's name) as CLI11 will read it. `app` and its options
/// must outlive the result. Nothing is parsed or stored.
std::vector<CommandWord> classify(const CLI::App& app, const std::vector<std::string>& words);

/// What the word after `words` would be: a subcommand, the value of the last option, or an argument.
CommandWord next_word(const CLI::App& app, const std::vector<std::string>& words);

/// A sentence that names the first unknown option or subcommand and the nearest one there is, or all of a
/// few; nothing when all are known.
std::optional<std::string> unknown_word(const CLI::App& app, const std::vector<std::string>& words);

/// A sentence that names the first argument that the command has no place for, and those that it takes.
std::optional<std::string> word_too_many(const CLI::App& app, const std::vector<std::string>& words);

/// Gives `option` the values that it may have: others are refused, with the nearest. Help shows them as its
/// type (`auto|always|never`), which is what completion reads. Returns the option.
CLI::Option* one_of(CLI::Option* option, std::vector<std::string> words);

}  // namespace asip::program
