// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/child_process.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {

/// Certificates for a test, made by the openssl program: a CA, a server certificate for localhost and
/// 127.0.0.1, a client certificate, and a second CA that signed nothing of these.
struct Certificates {
    std::string ca, server_cert, server_key, client_cert, client_key, other_ca;
};
/// What the server certificate contains.
struct ServerCertificate {
    std::string names = "DNS:localhost,IP:127.0.0.1";  ///< subjectAltName
    std::string from{};                                ///< YYYYMMDDHHMMSSZ; empty: now
    std::string until{};                               ///< empty: in two days
};
Certificates make_certificates(const TempDir& folder, const ServerCertificate& server = {});

/// A real Mosquitto on a free port of 127.0.0.1.
class MosquittoBroker {
  public:
    struct Options {
        bool persistence = false;  ///< saved at each change
        /// User, password; none: anonymous is allowed.
        std::vector<std::pair<std::string, std::string>> users{};
        bool tls = false;
        bool require_client_certificate = false;
        ServerCertificate certificate{};
        std::string log_type = "all";            ///< what log() holds
        std::vector<std::string> extra_lines{};  ///< of the configuration file
    };

    MosquittoBroker() : MosquittoBroker(Options{}) {}
    /// Starts it and waits until it accepts. Throws std::runtime_error with its log when it does not.
    explicit MosquittoBroker(Options options);
    ~MosquittoBroker();

    std::uint16_t port() const { return port_; }
    std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
    std::string url() const { return (options_.tls ? "mqtts://" : "mqtt://") + address(); }
    const Certificates& certificates() const { return certificates_; }
    pid_t pid() const;
    std::size_t resident_bytes() const;  ///< of its memory
    std::string log() const;

    void stop();   ///< SIGTERM, waits for its end
    void kill();   ///< SIGKILL, waits for its end
    void start();  ///< again, on the same port
    void restart() { stop(), start(); }
    void freeze();  ///< SIGSTOP
    void thaw();    ///< SIGCONT

  private:
    void write_configuration();

    Options options_;
    TempDir folder_;
    Certificates certificates_;
    std::uint16_t port_;
    std::unique_ptr<ChildProcess> process_;
    std::string earlier_logs_;
};

}  // namespace asip::test
