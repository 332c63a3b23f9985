// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cctype>
#include <filesystem>
#include <fstream>

#include "asip/bus/topics.hpp"
#include "asip/program/command_words.hpp"
#include "asip/program/credentials.hpp"
#include "asip/program/options.hpp"
#include "asip/random.hpp"

namespace asip::program {

namespace {

Expected<void> check_tls_files(const BrokerOptions& options) {
    for (const auto& path : {options.ca, options.cert, options.key})
        if (!path.empty() && !std::ifstream(path)) return fail("cannot read " + path);
    if (options.cert.empty() != options.key.empty()) return fail("--cert and --key are needed together");
    return {};
}

std::string id_safe(std::string text) {
    for (auto& c : text)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '.' && c != '_') c = '-';
    return text.substr(0, 40);
}

}  // namespace

void Settings::add_broker_options(BrokerOptions& options) {
    use_credentials_for(options);
    const char* group = "Broker";
    auto& app = this->app();
    setting(app.add_option("--broker", options.brokers,
                           "Broker: HOST, HOST:PORT, mqtt://HOST or mqtts://HOST; several: the next is used "
                           "while one does not answer"))
        ->delimiter(',')
        ->type_name("ADDRESS")
        ->default_str("127.0.0.1:1883")
        ->group(group);
    setting(
        app.add_option("--credentials", options.credentials,
                       "File made by asipctl secure: broker, its authority's certificate, user, password"))
        ->type_name("FILE")
        ->group(group);
    setting(app.add_option("--user", options.user, "User name for the broker"))
        ->type_name("NAME")
        ->group(group);
    never_typed(app.add_option("--password", options.password, "Password"));
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
    one_of(setting(app.add_option("--mqtt-version", options.mqtt_version,
                                  "Version of MQTT; best: 5, and 3.1.1 where the broker knows no 5")),
           {"best", "5", "3.1.1"})
        ->default_str("best")
        ->group(group);
    setting(app.add_option("--topic-root", options.topic_root, "What all topics begin with"))
        ->type_name("TOPIC")
        ->default_str("asip")
        ->group(group);
}

void Settings::add_credentials_dir(BrokerOptions& options) {
    setting(app().add_option("--credentials-dir", options.credentials_dir,
                             "Folder in which asipctl secure keeps the credentials of this machine's "
                             "services; used where neither broker nor user is given"))
        ->type_name("DIR")
        ->group("Broker");
}

std::string credentials_in_dir(const BrokerOptions& options, const std::string& user) {
    const bool given = options.brokers != BrokerOptions{}.brokers || !options.user.empty() ||
                       !options.cert.empty() || !options.credentials.empty();
    if (given || options.credentials_dir.empty() || user.empty()) return {};
    const auto file = std::filesystem::path(options.credentials_dir) / (user + ".credentials");
    std::error_code error;
    const bool absent = std::filesystem::status(file, error).type() == std::filesystem::file_type::not_found;
    return absent ? std::string() : file.string();
}

Expected<std::string> take_credentials(BrokerOptions& options, const std::string& path) {
    const auto read = read_credentials(path);
    if (!read) return fail(read.error());
    BrokerOptions replaced;
    replaced.brokers = read->brokers;
    replaced.user = read->user;
    replaced.password = read->password;
    if (read->certificate) replaced.ca = path;
    if (!read->topic_root.empty()) replaced.topic_root = read->topic_root;
    replaced.credentials = path;
    replaced.credentials_dir = options.credentials_dir;
    replaced.mqtt_version = options.mqtt_version;
    options = std::move(replaced);
    return read->name;
}

std::string host_name() {
    char name[256] = {};
    return gethostname(name, sizeof name - 1) == 0 ? name : "localhost";
}

Expected<mqtt::Options> mqtt_options(const BrokerOptions& options, std::string_view program) {
    mqtt::Options made;
    made.brokers.clear();
    const bool tls_files = !options.ca.empty() || !options.cert.empty();
    // A comma in a password has cut the address in two: no part of it is shown.
    for (const auto& text : options.brokers)
        if (text.find('@') != std::string::npos) return fail(mqtt::parse_broker(text).error());
    for (const auto& text : options.brokers) {
        auto address = mqtt::parse_broker(text);
        if (!address) return fail(address.error());
        // Certificates mean TLS, unless the address names another scheme.
        if (tls_files && text.find("://") == std::string::npos) address->tls = true;
        made.brokers.push_back(*address);
    }
    if (made.brokers.empty()) return fail("no broker given");
    if (!bus::Topics::valid_root(options.topic_root)) {
        return fail("--topic-root \"" + options.topic_root +
                    "\": levels joined by /, without wildcards, spaces at most inside, not beginning with $");
    }
    made.password = options.password;
    if (!options.password_file.empty()) {
        auto password = mqtt::read_password_file(options.password_file);
        if (!password) return fail(password.error());
        made.password = std::move(*password);
    }
    if (const auto files = check_tls_files(options); !files) return fail(files.error());
    made.user = options.user;
    if (made.user.empty() && !made.password.empty()) return fail("a password needs a --user");
    made.ca_file = options.ca;
    made.cert_file = options.cert;
    made.key_file = options.key;
    made.insecure = options.insecure;
    made.version = options.mqtt_version == "5"       ? mqtt::Version::kV5
                   : options.mqtt_version == "3.1.1" ? mqtt::Version::kV311
                                                     : mqtt::Version::kBest;
    made.random = system_random();
    made.client_id = std::string(program) + "-" + id_safe(host_name()) + "-" + random_hex(made.random, 8);
    made.longest_payload = [topics = bus::Topics(options.topic_root)](std::string_view topic) {
        return topics.longest_payload(topic);
    };
    return made;
}

}  // namespace asip::program
