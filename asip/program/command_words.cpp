// SPDX-License-Identifier: Apache-2.0
#include "asip/program/command_words.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>

#include "asip/text/nearest.hpp"

namespace asip::program {
namespace {

using Kind = CommandWord::Kind;

constexpr std::size_t kMostNamed = 12;

std::string name_part(const std::string& word) {
    if (word.starts_with("--")) return word.substr(0, word.find('='));
    return word.substr(0, 2);
}

bool looks_like_option(const std::string& word) {
    return word.size() > 1 && word[0] == '-' && std::isdigit(static_cast<unsigned char>(word[1])) == 0;
}

const CLI::App* parent_of(const CLI::App* app) {
    return app->get_fallthrough() ? app->get_parent() : nullptr;
}

const CLI::Option* find_option(const CLI::App* app, const std::string& name) {
    for (; app != nullptr; app = parent_of(app))
        if (const auto* option = app->get_option_no_throw(name)) return option;
    return nullptr;
}

const CLI::App* find_subcommand(const CLI::App* app, const std::string& name) {
    for (const auto* one : app->get_subcommands([](const CLI::App*) { return true; }))
        if (one->check_name(name)) return one;
    return nullptr;
}

bool has_subcommands(const CLI::App* app) {
    return !app->get_subcommands([](const CLI::App*) { return true; }).empty();
}

const CLI::Option* positional(const CLI::App* app, std::size_t position) {
    const CLI::Option* last = nullptr;
    for (const auto* option : app->get_options()) {
        if (!option->get_positional()) continue;
        if (position == 0) return option;
        --position;
        last = option;
    }
    return last != nullptr && last->get_items_expected_max() > 1 ? last : nullptr;
}

/// Reads words one after the other, as CLI11 does.
class Reader {
  public:
    explicit Reader(const CLI::App& app) : app_(&app) {}

    CommandWord read(const std::string& word) {
        if (waiting_ != nullptr) return {Kind::kValue, app_, std::exchange(waiting_, nullptr)};
        if (!only_arguments_ && word == "--") {
            only_arguments_ = true;
            return {Kind::kOption, app_, nullptr};
        }
        if (!only_arguments_ && looks_like_option(word)) return read_option(word);
        if (has_subcommands(app_)) return read_subcommand(word);
        return argument();
    }

    CommandWord next() const {
        if (waiting_ != nullptr) return {Kind::kValue, app_, waiting_};
        if (has_subcommands(app_)) return {Kind::kSubcommand, app_, nullptr};
        return {Kind::kArgument, app_, positional(app_, position_), position_};
    }

  private:
    CommandWord argument() {
        const auto at = position_++;
        return {Kind::kArgument, app_, positional(app_, at), at};
    }

    CommandWord read_subcommand(const std::string& word) {
        const auto* found = find_subcommand(app_, word);
        if (found == nullptr && positional(app_, 0) != nullptr) return argument();
        if (found == nullptr) return {Kind::kUnknownSubcommand, app_, nullptr};
        app_ = found;
        position_ = 0;
        return {Kind::kSubcommand, app_, nullptr};
    }

    CommandWord read_option(const std::string& word) {
        const auto* option = find_option(app_, name_part(word));
        if (option == nullptr) return {Kind::kUnknownOption, app_, nullptr};
        const bool carries_value =
            word.starts_with("--") ? word.find('=') != std::string::npos : word.size() > 2;
        if (takes_value(*option) && !carries_value) waiting_ = option;
        return {Kind::kOption, app_, option};
    }

    const CLI::App* app_;
    const CLI::Option* waiting_ = nullptr;
    std::size_t position_ = 0;
    bool only_arguments_ = false;
};

std::vector<std::string> option_names(const CLI::App* app) {
    std::vector<std::string> names;
    for (; app != nullptr; app = parent_of(app)) {
        for (const auto* option : app->get_options())
            for (const auto& name : option->get_lnames())
                names.push_back("--" + name);
    }
    return names;
}

std::vector<std::string> positional_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const auto* option : app.get_options())
        if (option->get_positional()) names.push_back(option->get_name());
    return names;
}

std::vector<std::string> subcommand_names(const CLI::App* app) {
    std::vector<std::string> names;
    for (const auto* one : app->get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(one->get_name());
    return names;
}

std::string joined(const std::vector<std::string>& words, const char* between) {
    std::string text;
    for (const auto& word : words)
        text += (text.empty() ? "" : between) + word;
    return text;
}

}  // namespace

bool takes_value(const CLI::Option& option) {
    return option.get_items_expected_min() > 0;
}

std::vector<CommandWord> classify(const CLI::App& app, const std::vector<std::string>& words) {
    Reader reader(app);
    std::vector<CommandWord> result;
    for (const auto& word : words)
        result.push_back(reader.read(word));
    return result;
}

CommandWord next_word(const CLI::App& app, const std::vector<std::string>& words) {
    Reader reader(app);
    for (const auto& word : words)
        reader.read(word);
    return reader.next();
}

std::optional<std::string> unknown_word(const CLI::App& app, const std::vector<std::string>& words) {
    if (app.get_allow_extras()) return std::nullopt;
    const auto read = classify(app, words);
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (read[i].kind == Kind::kUnknownOption) {
            const auto name = name_part(words[i]);
            return "there is no option \"" + name + "\"" +
                   text::did_you_mean(name, option_names(read[i].app));
        }
        if (read[i].kind == Kind::kUnknownSubcommand) {
            const auto names = subcommand_names(read[i].app);
            const auto near = text::did_you_mean(words[i], names);
            return "there is no command \"" + words[i] + "\"" +
                   (near.empty() && names.size() <= kMostNamed ? "; there are " + joined(names, ", ") : near);
        }
    }
    return std::nullopt;
}

std::optional<std::string> word_too_many(const CLI::App& app, const std::vector<std::string>& words) {
    const auto read = classify(app, words);
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (read[i].kind != Kind::kArgument || read[i].option != nullptr) continue;
        const auto wanted = joined(positional_names(*read[i].app), " ");
        return read[i].app->get_name() + " takes " + (wanted.empty() ? "no arguments" : wanted) + "; \"" +
               words[i] + "\" is one too many";
    }
    return std::nullopt;
}

CLI::Option* one_of(CLI::Option* option, std::vector<std::string> words) {
    option->type_name(joined(words, "|"));
    return option->check([words = std::move(words)](const std::string& word) {
        if (std::find(words.begin(), words.end(), word) != words.end()) return std::string();
        return "\"" + word + "\" is none of " + joined(words, ", ") + text::did_you_mean(word, words);
    });
}

}  // namespace asip::program
