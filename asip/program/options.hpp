// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "asip/mqtt/options.hpp"
#include "asip/program/config_file.hpp"

namespace CLI {
class App;
class Option;
class Success;
}  // namespace CLI

namespace asip::program {

class App;
class Option;

struct BrokerOptions {
    std::vector<std::string> brokers{"127.0.0.1:1883"};
    bool brokers_given = false;  ///< Settings: not the default, though it may be the same
    std::string user;
    std::string password;
    std::string password_file;  ///< first line is the password
    std::string ca;
    std::string cert;
    std::string key;
    bool insecure = false;
    std::string credentials;            ///< file of `asipctl secure`: broker, CA, user, password
    std::string credentials_dir;        ///< see credentials_in_dir()
    std::string mqtt_version = "best";  ///< best, 5, 3.1.1
    std::string topic_root = "asip";
};

struct LogOptions {
    std::string level = "info";
    std::string format = "text";
};

/// Reads options from, in order of precedence: the command line, the environment, a configuration file,
/// defaults.
///
///     App app{"..."};
///     Settings settings(app, "asip-agent");
///     BrokerOptions broker; LogOptions log; std::string serial;
///     settings.add_broker_options(broker);
///     settings.add_log_options(log);
///     settings.setting(app.add_option("--serial", serial, "Serial port of the board"));
///     if (auto status = settings.parse(argc, argv)) return *status;
///
/// `--serial` is then also `ASIP_SERIAL` in the environment and `serial = ...` in the file named by
/// `--config` or `ASIP_CONFIG`: lines `name = value`, `#` comments; lines below `[asip-agent]` are for that
/// program only and those below other programs' names are skipped. A name in the file that no option has is
/// an error, with a suggestion. The values of file and environment are checked like those of the command
/// line.
class Settings {
  public:
    Settings(CLI::App& app, std::string program);
    Settings(const App& app, std::string program);
    ~Settings();

    /// Makes an option of the app settable in environment and file, by its long name. Returns it.
    CLI::Option* setting(CLI::Option* option);
    const Option& setting(const Option& option);

    /// For secrets: only file and environment set it.
    void never_typed(CLI::Option* option);

    /// By long names, once all are declared. --help shows `shown`, --help-all the others, and at its end
    /// `file_only`, which are no options of the command line.
    void arrange(std::vector<std::string> shown, std::vector<std::string> file_only);

    void add_broker_options(BrokerOptions& options);
    /// `--credentials-dir`, after add_broker_options(): a service asip-NAME takes NAME.credentials there, an
    /// agent those of its board.
    void add_credentials_dir(BrokerOptions& options);
    void add_log_options(LogOptions& options);
    CLI::App& app();

    /// Nothing: continue. Otherwise the exit status; all has been printed. An unknown option or subcommand is
    /// an error that names the nearest. Applies the log options.
    std::optional<int> parse(int argc, const char* const* argv);
    /// Without the program's name.
    std::optional<int> parse(std::vector<std::string> arguments);

    /// For tests: environment by function.
    using Environment = std::function<std::optional<std::string>(const std::string& name)>;
    std::optional<int> parse(const std::vector<std::string>& arguments, const Environment& environment);

    /// The configuration file may have sections `[KIND TITLE]`, which parse() reads and does not apply.
    void allow_sections(std::string kind);
    /// Empty: no file.
    const std::string& config_path() const;
    const ConfigFile& config_file() const;
    /// For one section: `lines` count as those of the file at `path`. The error is returned, not printed.
    Expected<void> parse_section(std::vector<std::string> arguments, const std::string& path,
                                 const std::vector<ConfigLine>& lines);

    /// Prints `PROGRAM: TEXT` and where to find help; returns kExitUsage.
    int usage_error(const std::string& text) const;

  private:
    void use_credentials_for(BrokerOptions& options);
    int print_help(const CLI::Success& asked, bool all);

    struct State;
    std::unique_ptr<State> state_;
};

/// Nothing: it is not set.
std::optional<std::string> environment_variable(const std::string& name);

/// `user`.credentials in --credentials-dir. Empty: there is none, or broker, user, certificate or credentials
/// were given.
std::string credentials_in_dir(const BrokerOptions& options, const std::string& user);

/// The file replaces broker, user, certificates and topic root of `options`. Returns the board that the
/// credentials are for, if any.
Expected<std::string> take_credentials(BrokerOptions& options, const std::string& path);

/// Checked, with the password read and a client id unique to this process: `PROGRAM-HOST-RANDOM`.
Expected<mqtt::Options> mqtt_options(const BrokerOptions& options, std::string_view program);

std::string host_name();

}  // namespace asip::program
