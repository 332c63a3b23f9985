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
///     CLI::App app{"..."};
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
    ~Settings();

    /// Makes an option (or flag) of the app settable in environment and file. Its long name gives both names.
    /// Returns it.
    CLI::Option* setting(CLI::Option* option);

    /// The same for what others on this machine must not see among the arguments: file and environment set
    /// it.
    void never_typed(CLI::Option* option);

    /// For a program with many settings, once all are declared, by their long names. `shown`: the options
    /// that
    /// --help shows; --help-all shows the others, too. `file_only`: those that are no options of the command
    /// line: file and environment set them. --help-all tells them at its end.
    void arrange(std::vector<std::string> shown, std::vector<std::string> file_only);

    void add_broker_options(BrokerOptions& options);
    /// `--credentials-dir`, for a program that runs as a service: after add_broker_options(). A program
    /// asip-NAME takes NAME.credentials there; an agent does that itself, as soon as it knows its board.
    void add_credentials_dir(BrokerOptions& options);
    void add_log_options(LogOptions& options);
    CLI::App& app();

    /// Nothing: continue. Otherwise the exit status to end with; help, version or the error has been printed.
    /// An option or subcommand that does not exist is an error that names the nearest one.
    /// Applies the log options, where added, to the log.
    std::optional<int> parse(int argc, const char* const* argv);
    /// Same, without the program's name.
    std::optional<int> parse(std::vector<std::string> arguments);

    /// Same for tests: arguments without the program name, environment by function.
    using Environment = std::function<std::optional<std::string>(const std::string& name)>;
    std::optional<int> parse(const std::vector<std::string>& arguments, const Environment& environment);

    /// The configuration file may have sections `[KIND TITLE]`, one for each of several things that the
    /// program serves. parse() reads them and applies none.
    void allow_sections(std::string kind);
    /// What parse() read; an empty path: no file.
    const std::string& config_path() const;
    const ConfigFile& config_file() const;
    /// In place of parse(), for the options of one section: `lines` count as those of the file at `path`. The
    /// error is returned, not printed; the log stays as it is.
    Expected<void> parse_section(std::vector<std::string> arguments, const std::string& path,
                                 const std::vector<ConfigLine>& lines);

    /// Prints `PROGRAM: TEXT` and where to find help on standard error; returns kExitUsage.
    int usage_error(const std::string& text) const;

  private:
    void use_credentials_for(BrokerOptions& options);
    int print_help(const CLI::Success& asked, bool all);

    struct State;
    std::unique_ptr<State> state_;
};

/// A variable of this process's environment; nothing when it is not set.
std::optional<std::string> environment_variable(const std::string& name);

/// The file `user`.credentials in the folder of --credentials-dir. Empty where there is none, and where
/// broker, user, certificate or credentials were given: then these count.
std::string credentials_in_dir(const BrokerOptions& options, const std::string& user);

/// Replaces all that `options` says of broker, user, certificates and topic root by what the file says.
/// Returns the name of the board that the credentials are for, else an empty text.
Expected<std::string> take_credentials(BrokerOptions& options, const std::string& path);

/// What the MQTT client needs, from the options: addresses parsed, password file read, files checked to be
/// readable, topic root checked, a client id unique to this process: `PROGRAM-HOST-RANDOM`.
Expected<mqtt::Options> mqtt_options(const BrokerOptions& options, std::string_view program);

/// This machine's name, for descriptions and client ids.
std::string host_name();

}  // namespace asip::program
