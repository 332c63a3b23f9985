// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "asip/program/options.hpp"
#include "cli/environment.hpp"
#include "cli/terminal.hpp"
#include "cli/verb.hpp"

namespace asip::cli {

/// The options of every command, and the verbs with theirs.
class CommandLine {
  public:
    explicit CommandLine(const std::vector<Verb>& verbs);
    /// For these arguments only (without the program's name): other verbs are left out, or known by name
    /// alone.
    CommandLine(const std::vector<Verb>& verbs, const std::vector<std::string>& arguments);
    CommandLine(const CommandLine&) = delete;
    CommandLine& operator=(const CommandLine&) = delete;

    const CLI::App& app() const { return app_; }

    /// Reads arguments, environment and configuration file. Nothing: continue with apply() and run().
    /// Otherwise the exit status; all has been printed.
    std::optional<int> parse(std::vector<std::string> arguments);

    /// Among `words`, with their values (of flags `true`): they name the bus.
    OptionValues typed_options(const std::vector<std::string>& words) const;

    /// Fails with kExitUsage.
    Outcome<void> apply(Environment& environment) const;
    /// For verbs on the bus, where no broker is configured or on this machine: takes the one that the network
    /// announces, and says so. Fails with kExitBroker where there are several.
    Outcome<void> find_broker(Environment& environment) const;
    ColourChoice colour() const;

    int run(Environment& environment) const { return chosen_(environment); }

    /// `asipctl VERB --help`; with "", `asipctl --help`; with "all", all verbs. Fails with kExitUsage and the
    /// nearest verb.
    Outcome<std::string> help(const std::string& verb) const;

  private:
    CommandLine();
    std::string other_commands() const;
    /// The word that should be a verb, before any verb was added.
    std::string first_argument(const std::vector<std::string>& words) const;
    /// Where `--` is among them, with the options before it and all arguments behind it.
    std::vector<std::string> arguments_last(std::vector<std::string> words) const;
    std::optional<std::string> usual_name(const std::vector<std::string>& words) const;
    void add_common_options();
    void add_verb(const Verb& verb, bool with_options);

    CLI::App app_;
    program::Settings settings_;
    program::BrokerOptions broker_;
    program::LogOptions log_{.level = "warning", .format = "text"};
    std::string timeout_ = "5s";
    std::string services_;
    std::string colour_ = "auto";
    bool from_bus_ = false;
    bool no_mdns_ = false;
    bool uses_bus_ = false;
    OptionValues typed_;
    Run chosen_;
};

}  // namespace asip::cli
