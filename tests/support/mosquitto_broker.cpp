// SPDX-License-Identifier: Apache-2.0
#include "tests/support/mosquitto_broker.hpp"

#include <unistd.h>

#include <csignal>
#include <stdexcept>

#include "tests/support/wait.hpp"

namespace asip::test {
namespace {

void must_succeed(std::vector<std::string> command) {
    const auto name = command[0] + " " + command[1];
    const auto finished = run(std::move(command), {}, 60s);
    if (finished.status != 0) throw std::runtime_error(name + ": " + finished.errors);
}

/// Elliptic curve keys, because they take milliseconds to make.
void make_key(const std::string& file) {
    must_succeed({"openssl", "ecparam", "-name", "prime256v1", "-genkey", "-noout", "-out", file});
}

std::string make_ca(const TempDir& folder, const std::string& name) {
    const auto key = folder.file(name + ".key");
    make_key(key);
    must_succeed({"openssl", "req", "-x509", "-new", "-key", key, "-days", "2", "-subj", "/CN=" + name,
                  "-addext", "basicConstraints=critical,CA:TRUE", "-addext",
                  "keyUsage=critical,keyCertSign,cRLSign", "-out", folder.file(name + ".crt")});
    return folder.file(name + ".crt");
}

// "openssl ca", because "openssl x509" of Debian 12 cannot say from when a certificate is valid.
std::string make_signed(const TempDir& folder, const std::string& name, const std::string& common_name,
                        const ServerCertificate& content) {
    make_key(folder.file(name + ".key"));
    must_succeed({"openssl", "req", "-new", "-key", folder.file(name + ".key"), "-subj", "/CN=" + common_name,
                  "-out", folder.file(name + ".csr")});
    const auto extensions = folder.write(name + ".ext", "subjectAltName=" + content.names + "\n");
    const auto settings =
        folder.write("ca.cnf", "[ca]\ndefault_ca=only\n[only]\ndatabase=" + folder.write("ca.index", "") +
                                   "\nnew_certs_dir=" + folder.path().string() +
                                   "\ndefault_md=sha256\npolicy=any\nrand_serial=yes\n"
                                   "[any]\ncommonName=supplied\n");
    std::vector<std::string> command{"openssl",  "ca",
                                     "-batch",   "-notext",
                                     "-config",  settings,
                                     "-cert",    folder.file("ca.crt"),
                                     "-keyfile", folder.file("ca.key"),
                                     "-in",      folder.file(name + ".csr"),
                                     "-out",     folder.file(name + ".crt"),
                                     "-extfile", extensions};
    if (!content.from.empty()) command.insert(command.end(), {"-startdate", content.from});
    if (content.until.empty())
        command.insert(command.end(), {"-days", "2"});
    else
        command.insert(command.end(), {"-enddate", content.until});
    must_succeed(std::move(command));
    return folder.file(name + ".crt");
}

}  // namespace

Certificates make_certificates(const TempDir& folder, const ServerCertificate& server) {
    Certificates made;
    made.ca = make_ca(folder, "ca");
    made.other_ca = make_ca(folder, "other-ca");
    made.server_cert = make_signed(folder, "server", "localhost", server);
    made.server_key = folder.file("server.key");
    made.client_cert = make_signed(folder, "client", "test-client", {});
    made.client_key = folder.file("client.key");
    return made;
}

MosquittoBroker::MosquittoBroker(Options options) : options_(std::move(options)), port_(free_port()) {
    if (options_.tls) certificates_ = make_certificates(folder_, options_.certificate);
    write_configuration();
    start();
}

MosquittoBroker::~MosquittoBroker() {
    if (process_) process_->signal(SIGCONT);
}

void MosquittoBroker::write_configuration() {
    std::string text = "listener " + std::to_string(port_) + " 127.0.0.1\nset_tcp_nodelay true\n";
    // Started by root it would drop to its own user, who may not read the test's folder.
    text += "user root\nlog_dest stderr\nconnection_messages true\nlog_type " + options_.log_type + "\n";
    text += options_.users.empty() ? "allow_anonymous true\n" : "allow_anonymous false\n";
    if (options_.persistence) {
        text += "persistence true\npersistence_location " + folder_.path().string() +
                "/\nautosave_on_changes true\nautosave_interval 1\n";
    }
    if (!options_.users.empty()) {
        const auto file = folder_.write("passwords", "");
        for (const auto& [user, password] : options_.users)
            must_succeed({"mosquitto_passwd", "-b", file, user, password});
        text += "password_file " + file + "\n";
    }
    if (options_.tls) {
        text += "cafile " + certificates_.ca + "\ncertfile " + certificates_.server_cert + "\nkeyfile " +
                certificates_.server_key + "\n";
        if (options_.require_client_certificate) text += "require_certificate true\n";
    }
    for (const auto& line : options_.extra_lines)
        text += line + "\n";
    folder_.write("mosquitto.conf", text);
}

void MosquittoBroker::start() {
    process_.reset();  // one that runs would still hold the port
    // /usr/sbin is not in everyone's PATH.
    const auto program = access("/usr/sbin/mosquitto", X_OK) == 0 ? "/usr/sbin/mosquitto" : "mosquitto";
    process_ = std::make_unique<ChildProcess>(
        std::vector<std::string>{program, "-c", folder_.file("mosquitto.conf")});
    if (!wait_until([&] { return accepts(port_) || !process_->running(); }) || !process_->running())
        throw std::runtime_error("mosquitto does not start: " + process_->errors());
}

void MosquittoBroker::stop() {
    // Mosquitto forgets the signal if it comes just before its main loop begins.
    const bool gone = wait_until([&] {
        process_->signal(SIGTERM);
        return process_->wait_exit(500ms).has_value();
    });
    if (!gone) throw std::runtime_error("mosquitto does not stop");
    earlier_logs_ += process_->errors();
}

void MosquittoBroker::kill() {
    process_->signal(SIGKILL);
    process_->wait_exit();
    earlier_logs_ += process_->errors();
}

void MosquittoBroker::freeze() {
    process_->signal(SIGSTOP);
}
void MosquittoBroker::thaw() {
    process_->signal(SIGCONT);
}
pid_t MosquittoBroker::pid() const {
    return process_->pid();
}

std::size_t MosquittoBroker::resident_bytes() const {
    return process_->resident_bytes();
}

std::string MosquittoBroker::log() const {
    return earlier_logs_ + (process_ && process_->running() ? process_->errors() : "");
}

}  // namespace asip::test
