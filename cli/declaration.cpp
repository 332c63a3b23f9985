// SPDX-License-Identifier: Apache-2.0
#include "cli/declaration.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "asip/program/command_words.hpp"
#include "asip/text/duration.hpp"

namespace asip::cli {
namespace {

constexpr const char* kAnyOther = "...";

std::vector<std::string> words_of(const std::string& type) {
    std::vector<std::string> words;
    for (std::size_t begin = 0; begin <= type.size();) {
        const auto end = std::min(type.find('|', begin), type.size());
        words.push_back(type.substr(begin, end - begin));
        begin = end + 1;
    }
    return words;
}

/// Help and completion read the type; its words are all that is valid.
CLI::Option* typed(CLI::Option* option, const std::string& type) {
    const auto words = words_of(type);
    const bool any = words.size() < 2 || std::find(words.begin(), words.end(), kAnyOther) != words.end();
    return any ? option->type_name(type) : program::one_of(option, words);
}

std::string refuse_empty(const std::string& word) {
    return word.empty() ? "is empty; is a variable of a script not set?" : "";
}

/// An option that is given has a value: an empty one would be as if it was not given.
auto refuse_empty_instead_of(const std::string& type) {
    return [type](const std::string& word) {
        return word.empty() ? "is empty; give " + type + " (is a variable of a script not set?)" : "";
    };
}

CLI::Option* positional(CLI::Option* option, const std::string& type, Declaration::Needed needed) {
    // The name is enough: no type beside it.
    typed(option, type)->type_name("");
    return needed == Declaration::Needed::kYes ? option->required() : option;
}

std::string shown(std::chrono::milliseconds duration) {
    const auto count = duration.count();
    return count % 1000 == 0 ? std::to_string(count / 1000) + "s" : std::to_string(count) + "ms";
}

std::chrono::milliseconds duration_from(const std::string& name, const std::string& word) {
    const auto duration = text::parse_duration(word);
    if (!duration) throw CLI::ValidationError(name, duration.error());
    return *duration;
}

constexpr auto kNoLimit = std::numeric_limits<std::size_t>::max();

/// CLI11 takes -1 for a large number.
std::function<std::string(const std::string&)> whole_number(std::size_t least, std::size_t greatest) {
    return [least, greatest](const std::string& word) {
        std::size_t number = 0;
        const bool read = CLI::detail::lexical_cast(word, number) && !word.starts_with("-");
        if (read && number >= least && number <= greatest) return std::string();
        return word + " is not a number from " + std::to_string(least) +
               (greatest == kNoLimit ? " on" : " to " + std::to_string(greatest));
    };
}

}  // namespace

void Declaration::argument(const std::string& type, std::string& value, const std::string& help,
                           Needed needed) {
    positional(command_.add_option(type, value, help), type, needed)->check(refuse_empty);
}

void Declaration::arguments(const std::string& type, std::vector<std::string>& values,
                            const std::string& help, Needed needed) {
    positional(command_.add_option(type, values, help), type, needed);
}

void Declaration::flag(const std::string& names, bool& value, const std::string& help) {
    command_.add_flag(names, value, help);
}

void Declaration::option(const std::string& names, const std::string& type, std::string& value,
                         const std::string& help) {
    auto* option = typed(command_.add_option(names, value, help), type);
    option->check(refuse_empty_instead_of(type));
    if (!value.empty()) option->default_str(value);
}

void Declaration::option(const std::string& names, const std::string& type, std::optional<std::string>& value,
                         const std::string& help) {
    command_.add_option(names, value, help)->type_name(type);
}

void Declaration::option(const std::string& names, const std::string& type, std::vector<std::string>& values,
                         const std::string& help) {
    // What follows the value is not one more of them: `list --kind servo boards`.
    typed(command_.add_option(names, values, help), type)
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(refuse_empty_instead_of(type));
}

void Declaration::option(const std::string& names, const std::string& type, std::size_t& value,
                         const std::string& help, std::size_t least, std::size_t greatest) {
    command_.add_option(names, value, help)
        ->check(whole_number(least, greatest))
        ->type_name(type)
        ->default_str(std::to_string(value));
}

void Declaration::option(const std::string& names, const std::string& type, std::optional<std::size_t>& value,
                         const std::string& help) {
    command_.add_option(names, value, help)->check(whole_number(0, kNoLimit))->type_name(type);
}

void Declaration::option(const std::string& names, const std::string& type, double& value,
                         const std::string& help, double least, double greatest) {
    command_.add_option(names, value, help)
        ->check(CLI::Range(least, greatest).description(""))
        ->check([](const std::string& text) {
            return std::isnan(std::strtod(text.c_str(), nullptr)) ? text + " is not a number" : std::string();
        })
        ->type_name(type);
}

void Declaration::option(const std::string& names, std::chrono::milliseconds& value, const std::string& help,
                         std::chrono::milliseconds least) {
    command_
        .add_option_function<std::string>(
            names,
            [&value, names, least](const std::string& word) {
                const auto duration = duration_from(names, word);
                if (duration < least) throw CLI::ValidationError(names, "at least " + shown(least));
                value = duration;
            },
            help)
        ->type_name("DURATION")
        ->default_str(shown(value));
}

void Declaration::option(const std::string& names, std::optional<std::chrono::milliseconds>& value,
                         const std::string& help) {
    command_
        .add_option_function<std::string>(
            names, [&value, names](const std::string& word) { value = duration_from(names, word); }, help)
        ->type_name("DURATION");
}

void Declaration::output(OutputOptions& options, const std::vector<Output>& forms,
                         const std::vector<std::string>& fields) {
    std::vector<std::string> names;
    for (const auto form : forms)
        names.emplace_back(name_of(form));
    for (const auto form : {Output::kJson, Output::kJsonLines})
        names.emplace_back(name_of(form));
    options.form = forms.front();
    auto* form = command_.add_option_function<std::string>(
        "-o,--output",
        [&options](const std::string& word) {
            for (const auto one : {Output::kTable, Output::kWide, Output::kText, Output::kName, Output::kCsv,
                                   Output::kJson, Output::kJsonLines}) {
                if (word == name_of(one)) options.form = one;
            }
        },
        "Form of the output");
    program::one_of(form, names)->default_str(names.front());
    std::string places;
    for (const auto& field : fields)
        places += " {" + field + "}";
    command_.add_option("--format", options.format, "Print each record by this template, of:" + places)
        ->check(refuse_empty_instead_of("TEMPLATE"))
        ->check([fields](const std::string& text) {
            const auto checked = check_template(text, fields);
            return checked ? std::string() : checked.error();
        })
        ->type_name("TEMPLATE");
}

}  // namespace asip::cli
