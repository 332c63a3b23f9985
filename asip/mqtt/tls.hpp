// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <openssl/ssl.h>

#include <memory>
#include <string>

#include "asip/expected.hpp"
#include "asip/mqtt/options.hpp"

namespace asip::mqtt {

/// TLS of one connection, and what was wrong with the broker's certificate. We verify instead of
/// libmosquitto, so that the verified name (and SNI) may differ from the address. Trusts `ca_file`, else the
/// system's certificates (or SSL_CERT_FILE and SSL_CERT_DIR).
class Tls {
  public:
    /// `host`: whom the certificate must be for. Error: the unusable file, and why.
    static Expected<std::unique_ptr<Tls>> make(const Options& options, std::string host);

    /// It points to this object.
    SSL_CTX* context() const { return context_.get(); }

    /// Why the certificate was refused; empty: it was not.
    const std::string& refusal() const { return refusal_; }
    /// The certificate is not valid yet, by our clock.
    bool may_pass() const { return may_pass_; }

  private:
    struct Free {
        void operator()(SSL_CTX* context) const { SSL_CTX_free(context); }
    };

    Tls(std::string host);
    Expected<void> configure(const Options& options);
    static int verified(int ok, X509_STORE_CTX* store);
    static void handshake_begins(const SSL* ssl, int where, int result);

    std::string host_;
    bool is_address_ = false;
    std::unique_ptr<SSL_CTX, Free> context_;
    std::string refusal_;
    bool may_pass_ = false;
};

}  // namespace asip::mqtt
