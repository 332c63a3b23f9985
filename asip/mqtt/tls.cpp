// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/tls.hpp"

#include <openssl/err.h>
#include <openssl/x509v3.h>

#include <boost/asio/ip/address.hpp>

namespace asip::mqtt {
namespace {

std::string last_openssl_error() {
    const auto code = ERR_peek_last_error();
    ERR_clear_error();
    const char* reason = ERR_reason_error_string(code);
    return reason == nullptr ? "unknown reason" : reason;
}

Unexpected<std::string> cannot_use(const char* what, const std::string& file) {
    return fail(std::string("cannot use the ") + what + " " + file + ": " + last_openssl_error());
}

/// OpenSSL would ask on the terminal.
int no_passphrase(char*, int, int, void*) {
    return -1;
}

}  // namespace

Tls::Tls(std::string host) : host_(std::move(host)), context_(SSL_CTX_new(TLS_client_method())) {
    boost::system::error_code not_numeric;
    boost::asio::ip::make_address(host_, not_numeric);
    is_address_ = !not_numeric;
}

Expected<std::unique_ptr<Tls>> Tls::make(const Options& options, std::string host) {
    std::unique_ptr<Tls> tls(new Tls(std::move(host)));
    if (!tls->context_) return fail("no TLS: " + last_openssl_error());
    if (auto done = tls->configure(options); !done) return fail(done.error());
    return tls;
}

Expected<void> Tls::configure(const Options& options) {
    auto* const context = context_.get();
    SSL_CTX_set_app_data(context, this);
    SSL_CTX_set_min_proto_version(context, TLS1_2_VERSION);
    SSL_CTX_set_mode(context, SSL_MODE_RELEASE_BUFFERS | SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER);
    // A small message is a record of its own: without this it takes two system calls.
    SSL_CTX_set_read_ahead(context, 1);
    SSL_CTX_set_default_passwd_cb(context, no_passphrase);
    SSL_CTX_set_info_callback(context, handshake_begins);
    if (options.insecure) {
        SSL_CTX_set_verify(context, SSL_VERIFY_NONE, nullptr);
    } else {
        SSL_CTX_set_verify(context, SSL_VERIFY_PEER, verified);
        auto* const param = SSL_CTX_get0_param(context);
        if (is_address_)
            X509_VERIFY_PARAM_set1_ip_asc(param, host_.c_str());
        else
            X509_VERIFY_PARAM_set1_host(param, host_.c_str(), host_.size());
    }
    if (options.ca_file.empty())
        SSL_CTX_set_default_verify_paths(context);
    else if (SSL_CTX_load_verify_locations(context, options.ca_file.c_str(), nullptr) != 1)
        return cannot_use("certificates", options.ca_file);
    if (options.cert_file.empty()) return {};
    if (SSL_CTX_use_certificate_chain_file(context, options.cert_file.c_str()) != 1)
        return cannot_use("certificate", options.cert_file);
    if (SSL_CTX_use_PrivateKey_file(context, options.key_file.c_str(), SSL_FILETYPE_PEM) != 1)
        return cannot_use("key", options.key_file);
    if (SSL_CTX_check_private_key(context) != 1)
        return fail("the key " + options.key_file + " is not that of " + options.cert_file);
    return {};
}

int Tls::verified(int ok, X509_STORE_CTX* store) {
    if (ok == 1) return 1;
    const auto* ssl =
        static_cast<SSL*>(X509_STORE_CTX_get_ex_data(store, SSL_get_ex_data_X509_STORE_CTX_idx()));
    auto& self = *static_cast<Tls*>(SSL_CTX_get_app_data(SSL_get_SSL_CTX(ssl)));
    const int error = X509_STORE_CTX_get_error(store);
    self.may_pass_ = error == X509_V_ERR_CERT_NOT_YET_VALID;
    self.refusal_ = X509_verify_cert_error_string(error);
    if (error == X509_V_ERR_HOSTNAME_MISMATCH || error == X509_V_ERR_IP_ADDRESS_MISMATCH)
        self.refusal_ = "the certificate is not for " + self.host_;
    if (self.may_pass_) self.refusal_ += "; is the clock right?";
    return 0;
}

/// libmosquitto has asked for the address as server name, which no broker with several names can use.
void Tls::handshake_begins(const SSL* ssl, int where, int) {
    if ((where & SSL_CB_HANDSHAKE_START) == 0) return;
    const auto& self = *static_cast<const Tls*>(SSL_CTX_get_app_data(SSL_get_SSL_CTX(ssl)));
    SSL_set_tlsext_host_name(const_cast<SSL*>(ssl),
                             self.is_address_ ? nullptr : const_cast<char*>(self.host_.c_str()));
}

}  // namespace asip::mqtt
