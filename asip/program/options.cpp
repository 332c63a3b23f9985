#include "asip/program/options.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>

#include "asip/bus/topics.hpp"
#include "asip/program/exit_status.hpp"
#include "asip/program/log.hpp"
#include "asip/program/nearest.hpp"
#include "asip/random.hpp"

namespace asip::program {
namespace {

constexpr std::size_t kMaxConfigBytes = 1u << 20;

std::string environment_name(const std::string& option) {
    std::string name = "ASIP_";
    for (const char c : option)
        name += c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return name;
}

std::string trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return {};
    return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

struct FileLine {
    int number;
    std::string name;
    std::string value;
};

/// Lines `name = value` of a file: those before any section, and those of the section named like the program.
Expected<std::vector<FileLine>> read_config(const std::string& path, const std::string& program) {
    std::ifstream file(path);
    if (!file) return fail("cannot read the configuration file " + path);
    std::vector<FileLine> lines;
    bool ours = true;
    int number = 0;
    std::size_t bytes = 0;
    for (std::string raw; std::getline(file, raw);) {
        ++number;
        if ((bytes += raw.size() + 1) > kMaxConfigBytes)
            return fail(path + " is too long for a configuration file");
        const auto line = trimmed(raw);
        const auto where = path + ":" + std::to_string(number) + ": ";
        if (line.empty() || line.front() == '#' || line.front() == ';') continue;
        if (line.front() == '[') {
            if (line.back() != ']') return fail(where + "the ] is missing");
            ours = trimmed(std::string_view(line).substr(1, line.size() - 2)) == program;
            continue;
        }
        if (!ours) continue;
        const auto equals = line.find('=');
        if (equals == std::string::npos) return fail(where + "expected NAME = VALUE");
        auto value = trimmed(std::string_view(line).substr(equals + 1));
        if (value.size() >= 2 && value.front() == '"' && value.back() == '"')
            value = value.substr(1, value.size() - 2);
        auto name = trimmed(std::string_view(line).substr(0, equals));
        std::replace(name.begin(), name.end(), '_', '-');
        lines.push_back({number, std::move(name), std::move(value)});
    }
    return lines;
}

std::optional<std::string> system_environment(const std::string& name) {
    const char* value = std::getenv(name.c_str());
    return value == nullptr ? std::nullopt : std::optional<std::string>(value);
}

/// The value of `--config`, before anything else is parsed.
std::optional<std::string> config_argument(const std::vector<std::string>& arguments) {
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        if (arguments[i] == "--") break;
        if (arguments[i] == "--config" && i + 1 < arguments.size()) return arguments[i + 1];
        if (arguments[i].starts_with("--config=")) return arguments[i].substr(9);
    }
    return std::nullopt;
}

}  // namespace

struct Settings::State {
    CLI::App& app;
    std::string program;
    std::string config;
    std::vector<CLI::Option*> settings;
    LogOptions* log = nullptr;

    CLI::Option* named(const std::string& name) const {
        for (auto* option : settings) {
            if (option->check_lname(name)) return option;
        }
        return nullptr;
    }

    std::vector<std::string> names() const {
        std::vector<std::string> all;
        for (const auto* option : settings) {
            for (const auto& name : option->get_lnames())
                all.push_back(name);
        }
        return all;
    }

    /// Makes `value` the default of the option, checked and converted as on the command line. What --help
    /// shows stays the built-in default: the value may be a password.
    void apply(CLI::Option* option, const std::string& value, const std::string& source) const {
        const auto shown = option->get_default_str();
        try {
            option->run_callback_for_default(true);
            option->default_val(value);
            option->default_str(shown);
        } catch (const CLI::Error& error) {
            throw CLI::ValidationError(source, error.what());
        }
    }

    void apply_file(const std::string& path) const {
        const auto lines = read_config(path, program);
        if (!lines) throw CLI::FileError(lines.error(), CLI::ExitCodes::FileError);
        for (const auto& line : *lines) {
            const auto where = path + ":" + std::to_string(line.number);
            auto* option = named(line.name);
            if (option == nullptr) {
                throw CLI::ValidationError(
                    where, "no option \"" + line.name + "\"" + did_you_mean(line.name, names()));
            }
            apply_together(option, line, *lines, where);
        }
    }

    /// An option that takes several values may have several lines.
    void apply_together(CLI::Option* option, const FileLine& line, const std::vector<FileLine>& lines,
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
};

Settings::Settings(CLI::App& app, std::string program)
    : state_(new State{app, std::move(program), {}, {}, nullptr}) {
    app.set_version_flag("--version", state_->program + " " ASIP_VERSION);
    app.add_option("--config", state_->config,
                   "File with lines NAME = VALUE, named like these options [ASIP_CONFIG]")
        ->type_name("FILE");
}

Settings::~Settings() = default;

CLI::Option* Settings::setting(CLI::Option* option) {
    if (option->get_lnames().empty()) throw std::logic_error("a setting needs a long name");
    // For --help only: CLI11 itself would let the file win over the environment.
    option->envname(environment_name(option->get_lnames().front()));
    state_->settings.push_back(option);
    return option;
}

void Settings::add_broker_options(BrokerOptions& options) {
    auto& app = state_->app;
    const char* group = "Broker";
    setting(app.add_option("--broker", options.brokers,
                           "Broker: HOST, HOST:PORT, mqtt://HOST or mqtts://HOST; several are tried in turn"))
        ->delimiter(',')
        ->type_name("ADDRESS")
        ->default_str("127.0.0.1:1883")
        ->group(group);
    setting(app.add_option("--user", options.user, "User name for the broker"))
        ->type_name("NAME")
        ->group(group);
    setting(app.add_option("--password", options.password,
                           "Password (others on this machine can see it: prefer a file)"))
        ->type_name("TEXT")
        ->group(group);
    setting(app.add_option("--password-file", options.password_file, "File whose first line is the password"))
        ->type_name("FILE")
        ->group(group);
    setting(app.add_option("--ca", options.ca, "Certificates (PEM) that the broker's must be signed by"))
        ->type_name("FILE")
        ->group(group);
    setting(app.add_option("--cert", options.cert, "Certificate (PEM) to show to the broker"))
        ->type_name("FILE")
        ->group(group);
    setting(app.add_option("--key", options.key, "Its private key (PEM)"))->type_name("FILE")->group(group);
    setting(app.add_flag("--insecure", options.insecure, "Accept any certificate of the broker"))
        ->group(group);
    setting(app.add_option("--mqtt-version", options.mqtt_version, "best, 5 or 3.1.1"))
        ->check(CLI::IsMember({"best", "5", "3.1.1"}))
        ->type_name("VERSION")
        ->default_str("best")
        ->group(group);
    setting(app.add_option("--topic-root", options.topic_root, "What all topics begin with"))
        ->type_name("TOPIC")
        ->default_str("asip")
        ->group(group);
}

void Settings::add_log_options(LogOptions& options) {
    state_->log = &options;
    setting(state_->app.add_option("--log-level", options.level, "trace, debug, info, warning, error or off"))
        ->check([](const std::string& text) {
            const auto level = log::parse_level(text);
            return level ? std::string{} : level.error();
        })
        ->type_name("LEVEL")
        ->default_str(options.level)
        ->group("Log");
    setting(state_->app.add_option("--log-format", options.format, "text or json"))
        ->check([](const std::string& text) {
            const auto format = log::parse_format(text);
            return format ? std::string{} : format.error();
        })
        ->type_name("FORMAT")
        ->default_str("text")
        ->group("Log");
}

std::optional<int> Settings::parse(int argc, const char* const* argv) {
    return parse(std::vector<std::string>(argv + std::min(argc, 1), argv + argc), system_environment);
}

std::optional<int> Settings::parse(std::vector<std::string> arguments, const Environment& environment) {
    auto& app = state_->app;
    if (app.get_name().empty()) app.name(state_->program);
    try {
        auto config = config_argument(arguments);
        if (!config) config = environment("ASIP_CONFIG");
        if (config && !config->empty()) state_->apply_file(*config);
        state_->apply_environment(environment);
        // The environment has had its turn; CLI11 must not look again, with its own precedence.
        for (auto* option : state_->settings)
            option->envname({});
        std::reverse(arguments.begin(), arguments.end());
        app.parse(std::move(arguments));
    } catch (const CLI::Success& asked_for_help) {
        for (auto* option : state_->settings)
            option->envname(environment_name(option->get_lnames().front()));
        return app.exit(asked_for_help);
    } catch (const CLI::ParseError& error) {
        std::cerr << state_->program << ": " << error.what() << "\nTry " << state_->program << " --help\n";
        return kExitUsage;
    }
    if (state_->log != nullptr) {
        log::configure(*log::parse_level(state_->log->level), *log::parse_format(state_->log->format),
                       state_->program);
    }
    return std::nullopt;
}

namespace {

Expected<std::string> read_password(const BrokerOptions& options) {
    if (options.password_file.empty()) return options.password;
    std::ifstream file(options.password_file);
    std::string password;
    if (!std::getline(file, password)) return fail("cannot read a password from " + options.password_file);
    if (password.ends_with('\r')) password.pop_back();
    return password;
}

Expected<void> check_tls_files(const BrokerOptions& options) {
    for (const auto& path : {options.ca, options.cert, options.key}) {
        if (!path.empty() && !std::ifstream(path)) return fail("cannot read " + path);
    }
    if (options.cert.empty() != options.key.empty()) return fail("--cert and --key are needed together");
    return {};
}

std::string id_safe(std::string text) {
    for (auto& c : text) {
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '.' && c != '_') c = '-';
    }
    return text.substr(0, 40);
}

}  // namespace

std::string host_name() {
    char name[256] = {};
    return gethostname(name, sizeof name - 1) == 0 ? name : "localhost";
}

Expected<bus::MqttOptions> mqtt_options(const BrokerOptions& options, std::string_view program) {
    bus::MqttOptions made;
    made.brokers.clear();
    const bool tls_files = !options.ca.empty() || !options.cert.empty();
    for (const auto& text : options.brokers) {
        auto address = bus::parse_broker(text);
        if (!address) return fail(address.error());
        // Whoever gives certificates means TLS, unless the address says otherwise.
        if (tls_files && text.find("://") == std::string::npos) address->tls = true;
        made.brokers.push_back(*address);
    }
    if (made.brokers.empty()) return fail("no broker given");
    if (!bus::Topics::legal_root(options.topic_root)) {
        return fail("--topic-root \"" + options.topic_root +
                    "\": levels joined by /, without wildcards, spaces at most inside, not beginning with $");
    }
    auto password = read_password(options);
    if (!password) return fail(password.error());
    if (const auto files = check_tls_files(options); !files) return fail(files.error());
    made.user = options.user;
    made.password = *password;
    if (made.user.empty() && !made.password.empty()) return fail("a password needs a --user");
    made.ca_file = options.ca;
    made.cert_file = options.cert;
    made.key_file = options.key;
    made.insecure = options.insecure;
    made.version = options.mqtt_version == "5"       ? bus::MqttVersion::kV5
                   : options.mqtt_version == "3.1.1" ? bus::MqttVersion::kV311
                                                     : bus::MqttVersion::kBest;
    made.random = system_random();
    made.client_id = std::string(program) + "-" + id_safe(host_name()) + "-" + random_hex(made.random, 8);
    return made;
}

}  // namespace asip::program
