// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <openssl/ssl.h>

#include <memory>
#include <string>

#include "asip/expected.hpp"
#include "asip/mqtt/options.hpp"

namespace asip::mqtt {

/// The TLS settings of one connection, and what its handshake found wrong with the broker's certificate. We
/// verify ourselves instead of letting libmosquitto do it: then the name that is verified (and sent as SNI)
/// may differ from the address that is connected to, so that names can be resolved without blocking.
///
/// Trusts the certificates of `ca_file`, else those of the system (SSL_CERT_FILE and SSL_CERT_DIR in the
/// environment replace them, as for every program that uses OpenSSL).
class Tls {
  public:
    /// `host`: name or address that the certificate must be for. Error: the file that cannot be used, and
    /// why.
    static Expected<std::unique_ptr<Tls>> make(const Options& options, std::string host);

    /// Has pointers to this object: this must outlive every use of it.
    SSL_CTX* context() const { return context_.get(); }

    /// Why the certificate was refused, in words; empty: it was not, or not yet.
    const std::string& refusal() const { return refusal_; }
    /// The certificate is refused for a reason that time may change: it is not valid yet, by our clock.
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
