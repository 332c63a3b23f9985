// SPDX-License-Identifier: Apache-2.0
#include "asip/program/options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <iostream>

#include "asip/program/app.hpp"
#include "asip/program/command_words.hpp"
#include "asip/program/config_file.hpp"
#include "asip/program/exit_status.hpp"
#include "asip/program/log.hpp"
#include "asip/text/nearest.hpp"
#include "asip/text/printable.hpp"

namespace asip::program {
namespace {

constexpr std::size_t kMaxErrorBytes = 4000;

std::string environment_name(const std::string& option) {
    std::string name = "ASIP_";
    for (const char c : option)
        name += c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return name;
}

/// The value of an option such as `--config`, before anything else is parsed.
std::optional<std::string> early(const std::vector<std::string>& arguments, const std::string& option) {
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        if (arguments[i] == "--") break;
        if (arguments[i] == option && i + 1 < arguments.size()) return arguments[i + 1];
        if (arguments[i].starts_with(option + "=")) return arguments[i].substr(option.size() + 1);
    }
    return std::nullopt;
}

bool early_flag(const std::vector<std::string>& arguments, const std::string& flag) {
    const auto end = std::find(arguments.begin(), arguments.end(), "--");
    return std::find(arguments.begin(), end, flag) != end;
}

// An option that is given twice, in plain words.
std::string in_words(std::string what) {
    const auto counts = what.find(": At Most 1 required but received ");
    return counts == std::string::npos ? what : what.substr(0, counts) + " is given more than once";
}

}  // namespace

std::optional<std::string> environment_variable(const std::string& name) {
    const char* value = std::getenv(name.c_str());
    return value == nullptr ? std::nullopt : std::optional<std::string>(value);
}

struct Settings::State {
    CLI::App& app;
    std::string program;
    std::string config;
    std::vector<CLI::Option*> settings;
    LogOptions* log = nullptr;
    BrokerOptions* broker = nullptr;
    std::string section_kind;
    std::string file_path;
    ConfigFile file;
    std::vector<std::string> shown;      // by --help; empty: all
    std::vector<std::string> file_only;  // no options of the command line

    CLI::Option* named(const std::string& name) const {
        for (auto* option : settings)
            if (option->check_lname(name)) return option;
        return nullptr;
    }

    /// That a word of the command line is a setting of the file; empty: none is.
    std::string set_elsewhere(const std::vector<std::string>& arguments) const {
        for (const auto& word : arguments) {
            if (word == "--") break;
            for (const auto& name : file_only)
                if (word == "--" + name || word.starts_with("--" + name + "="))
                    return "--" + name + " is no option: write " + name +
                           " = VALUE into the file of --config, or set " + environment_name(name);
        }
        return {};
    }

    std::string file_only_text() const {
        std::string text = "Settings of the configuration file (or ASIP_... of the environment):\n";
        for (const auto& name : file_only) {
            const auto* option = named(name);
            const auto value = option->get_default_str();
            text += "  " + name + (value.empty() ? "" : " = " + value) + "\n        " +
                    option->get_description() + "\n";
        }
        return text;
    }

    std::vector<std::string> names() const {
        std::vector<std::string> all;
        for (const auto* option : settings)
            for (const auto& name : option->get_lnames())
                all.push_back(name);
        return all;
    }

    /// Makes `value` the default of the option, checked and converted as on the command line. What --help
    /// shows stays the built-in default: the value may be a password.
    void apply(CLI::Option* option, const std::string& value, const std::string& source) const {
        const auto before = option->get_default_str();
        try {
            option->run_callback_for_default(true);
            option->default_val(value);
            option->default_str(before);
            if (broker != nullptr && option == named("broker")) broker->brokers_given = true;
        } catch (const CLI::Error& error) {
            throw CLI::ValidationError(source, error.what());
        }
    }

    void read_file(const std::string& path) {
        auto read = read_config_file(path, program, section_kind);
        if (!read) throw CLI::FileError(read.error(), CLI::ExitCodes::FileError);
        file_path = path;
        file = std::move(*read);
    }

    void apply_lines(const std::string& path, const std::vector<ConfigLine>& lines) const {
        for (const auto& line : lines) {
            const auto where = path + ":" + std::to_string(line.number);
            auto* option = named(line.name);
            if (option == nullptr) {
                throw CLI::ValidationError(where, "there is no option \"" + line.name + "\"" +
                                                      text::did_you_mean(line.name, names()));
            }
            apply_together(option, line, lines, where);
        }
    }

    /// An option that takes several values may have several lines.
    void apply_together(CLI::Option* option, const ConfigLine& line, const std::vector<ConfigLine>& lines,
                        const std::string& where) const {
        std::string value = line.value;
        if (option->get_items_expected_max() > 1) {
            value.clear();
            for (const auto& other : lines) {
                if (other.name != line.name) continue;
                if (!value.empty()) value += ',';
                value += other.value;
            }
        }
        apply(option, value, where);
    }

    void apply_environment(const Environment& environment) const {
        for (auto* option : settings) {
            const auto name = option->get_envname();
            if (const auto value = environment(name); value && !value->empty()) apply(option, *value, name);
        }
    }

    /// All or nothing: a user of the environment does not go with a password of the file.
    void apply_credentials(const std::vector<std::string>& arguments) const {
        if (broker == nullptr) return;
        const auto argument = early(arguments, "--credentials");
        auto path = argument ? *argument : broker->credentials;
        if (const auto folder = early(arguments, "--credentials-dir")) broker->credentials_dir = *folder;
        const bool other =
            early(arguments, "--broker") || early(arguments, "--user") || early(arguments, "--cert");
        if (path.empty() && !other) path = credentials_in_dir(*broker, user_of_service());
        if (path.empty()) return;
        const auto name = take_credentials(*broker, path);
        if (!name) throw CLI::FileError(name.error(), CLI::ExitCodes::FileError);
        auto* const own_name = named("name");
        if (own_name != nullptr && !name->empty()) apply(own_name, *name, path);
    }

    void apply(const std::string& path, const std::vector<ConfigLine>& lines,
               std::vector<std::string> arguments, const Environment& environment) const {
        apply_lines(path, lines);
        apply_environment(environment);
        apply_credentials(arguments);
        // The environment was read already; CLI11 must not read it again, with its own precedence.
        for (auto* option : settings)
            option->envname({});
        std::reverse(arguments.begin(), arguments.end());
        app.parse(std::move(arguments));
        const auto* brokers = named("broker");
        if (broker != nullptr && brokers != nullptr && brokers->count() > 0) broker->brokers_given = true;
    }

    /// Empty: it has none, or knows it later.
    std::string user_of_service() const {
        constexpr std::string_view kPrefix = "asip-";
        if (!program.starts_with(kPrefix) || named("name") != nullptr) return {};
        return program.substr(kPrefix.size());
    }
};

Settings::Settings(CLI::App& app, std::string program)
    : state_(new State{app, std::move(program), {}, {}, nullptr, nullptr, {}, {}, {}, {}, {}}) {
    app.set_version_flag("--version", state_->program + " " ASIP_VERSION);
    app.add_option("--config", state_->config,
                   "File with lines NAME = VALUE, named like these options [ASIP_CONFIG]")
        ->type_name("FILE");
}

Settings::Settings(const App& app, std::string program) : Settings(app.cli(), std::move(program)) {}

Settings::~Settings() = default;

CLI::Option* Settings::setting(CLI::Option* option) {
    if (option->get_lnames().empty()) throw std::logic_error("a setting needs a long name");
    // For --help only: CLI11 itself would let the file win over the environment.
    option->envname(environment_name(option->get_lnames().front()));
    state_->settings.push_back(option);
    return option;
}

const Option& Settings::setting(const Option& option) {
    setting(option.get());
    return option;
}

void Settings::never_typed(CLI::Option* option) {
    setting(option)->group("");
    state_->file_only.push_back(option->get_lnames().front());
}

void Settings::arrange(std::vector<std::string> shown, std::vector<std::string> file_only) {
    for (const auto& names : {shown, file_only})
        for (const auto& name : names)
            if (state_->named(name) == nullptr) throw std::logic_error("there is no setting " + name);
    state_->app.add_flag("--help-all")->description("Print all options and settings, and exit");
    state_->shown = std::move(shown);
    for (auto& name : file_only)
        state_->file_only.push_back(std::move(name));
}

int Settings::print_help(const CLI::Success& asked, bool all) {
    const auto holds = [](const std::vector<std::string>& names, const CLI::Option& option) {
        return std::find(names.begin(), names.end(), option.get_lnames().front()) != names.end();
    };
    for (auto* option : state_->settings) {
        option->envname(environment_name(option->get_lnames().front()));
        const bool hidden = holds(state_->file_only, *option) ||
                            (!all && !state_->shown.empty() && !holds(state_->shown, *option));
        if (hidden) option->group("");
    }
    if (all) state_->app.footer(state_->file_only_text() + "\n" + state_->app.get_footer());
    return state_->app.exit(asked);
}

void Settings::use_credentials_for(BrokerOptions& options) {
    state_->broker = &options;
}

void Settings::add_log_options(LogOptions& options) {
    state_->log = &options;
    setting(state_->app.add_option("--log-level", options.level, "From which level on something is logged"))
        ->check([](const std::string& text) {
            const auto level = log::parse_level(text);
            return level ? std::string{} : level.error();
        })
        ->type_name("trace|debug|info|warning|error|off")
        ->default_str(options.level)
        ->group("Log");
    one_of(setting(state_->app.add_option("--log-format", options.format, "Form of a log line")),
           {"text", "json"})
        ->default_str("text")
        ->group("Log");
}

CLI::App& Settings::app() {
    return state_->app;
}

int Settings::usage_error(const std::string& text) const {
    // A word of the command line may hold anything.
    auto shown = text::escape_controls(std::string_view(text).substr(0, kMaxErrorBytes));
    if (text.size() > kMaxErrorBytes) shown += "...";
    std::cerr << state_->program << ": " << shown << "\nTry " << state_->program << " --help\n";
    return kExitUsage;
}

std::optional<int> Settings::parse(int argc, const char* const* argv) {
    return parse(std::vector<std::string>(argv + std::min(argc, 1), argv + argc));
}

std::optional<int> Settings::parse(std::vector<std::string> arguments) {
    return parse(std::move(arguments), environment_variable);
}

std::optional<int> Settings::parse(const std::vector<std::string>& arguments,
                                   const Environment& environment) {
    auto& app = state_->app;
    if (app.get_name().empty()) app.name(state_->program);
    if (const auto elsewhere = state_->set_elsewhere(arguments); !elsewhere.empty())
        return usage_error(elsewhere);
    if (const auto unknown = unknown_word(app, arguments)) return usage_error(*unknown);
    const bool all = !state_->file_only.empty() && early_flag(arguments, "--help-all");
    if (all) return print_help(CLI::CallForHelp(), true);
    try {
        auto config = early(arguments, "--config");
        if (!config) config = environment("ASIP_CONFIG");
        if (config && !config->empty()) state_->read_file(*config);
        state_->apply(state_->file_path, state_->file.lines, arguments, environment);
    } catch (const CLI::ExtrasError& error) {
        return usage_error(word_too_many(app, arguments).value_or(error.what()));
    } catch (const CLI::Success& asked_for_help) {
        return print_help(asked_for_help, false);
    } catch (const CLI::ParseError& error) {
        return usage_error(in_words(error.what()));
    }
    if (state_->log != nullptr) {
        log::configure(*log::parse_level(state_->log->level), *log::parse_format(state_->log->format),
                       state_->program);
    }
    return std::nullopt;
}

Expected<void> Settings::parse_section(std::vector<std::string> arguments, const std::string& path,
                                       const std::vector<ConfigLine>& lines) {
    try {
        state_->apply(path, lines, std::move(arguments), environment_variable);
    } catch (const CLI::Error& error) {
        return fail(error.what());
    }
    return {};
}

void Settings::allow_sections(std::string kind) {
    state_->section_kind = std::move(kind);
}

const std::string& Settings::config_path() const {
    return state_->file_path;
}

const ConfigFile& Settings::config_file() const {
    return state_->file;
}

}  // namespace asip::program
