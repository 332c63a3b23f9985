// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/certificate.hpp"

#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>

#include <algorithm>
#include <boost/asio/ip/address.hpp>
#include <cctype>
#include <ctime>
#include <memory>

#include "cli/secure/secrets.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

using namespace std::chrono_literals;

constexpr auto kAuthorityTime = std::chrono::years(20);
constexpr auto kBrokerTime = std::chrono::years(10);
constexpr std::size_t kSerialBytes = 16;

template <auto Free>
struct Freed {
    template <class T>
    void operator()(T* object) const {
        Free(object);
    }
};
using Certificate = std::unique_ptr<X509, Freed<X509_free>>;
using Key = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;
using Bio = std::unique_ptr<BIO, Freed<BIO_free_all>>;
using Extension = std::unique_ptr<X509_EXTENSION, Freed<X509_EXTENSION_free>>;
using Number = std::unique_ptr<BIGNUM, Freed<BN_free>>;

Unexpected<std::string> openssl_failed(const std::string& what) {
    const char* reason = ERR_reason_error_string(ERR_peek_last_error());
    ERR_clear_error();
    return fail(what + (reason == nullptr ? "" : std::string(": ") + reason));
}

Bio bio_of(const std::string& text) {
    return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
}

std::string text_of(const Bio& bio) {
    char* data = nullptr;
    const auto length = BIO_get_mem_data(bio.get(), &data);
    return {data, static_cast<std::size_t>(length)};
}

bool is_address(const std::string& host) {
    boost::system::error_code error;
    boost::asio::ip::make_address(host, error);
    return !error;
}

bool add_extension(X509* certificate, X509* issuer, int kind, const std::string& value) {
    X509V3_CTX environment;
    X509V3_set_ctx(&environment, issuer, certificate, nullptr, nullptr, 0);
    const Extension extension(X509V3_EXT_conf_nid(nullptr, &environment, kind, value.c_str()));
    return extension && X509_add_ext(certificate, extension.get(), -1) == 1;
}

/// Numbers that no attacker foresees, 127 bits: positive in any encoding.
bool set_serial(X509* certificate) {
    auto bytes = random_bytes(kSerialBytes);
    bytes[0] = static_cast<char>(bytes[0] & 0x7f);
    const Number number(BN_bin2bn(reinterpret_cast<const unsigned char*>(bytes.data()),
                                  static_cast<int>(bytes.size()), nullptr));
    return number && BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(certificate)) != nullptr;
}

/// By days: time_t ends in 2038 where it has 32 bits.
bool set_time(ASN1_TIME* time, CertificateTime moment) {
    const auto day = std::chrono::floor<std::chrono::days>(moment);
    std::time_t epoch = 0;
    return X509_time_adj_ex(time, static_cast<int>(day.time_since_epoch().count()),
                            static_cast<long>((moment - day).count()), &epoch) != nullptr;
}

/// Everything but extensions and signature.
Certificate begin(EVP_PKEY* key, const std::string& name, CertificateTime now, CertificateTime end) {
    Certificate made(X509_new());
    if (!made) return nullptr;
    auto* const subject = X509_get_subject_name(made.get());
    const bool done = X509_set_version(made.get(), 2) == 1 && set_serial(made.get()) &&
                      set_time(X509_getm_notBefore(made.get()), now - 24h) &&
                      set_time(X509_getm_notAfter(made.get()), end) &&
                      X509_NAME_add_entry_by_txt(subject, "CN", MBSTRING_UTF8,
                                                 reinterpret_cast<const unsigned char*>(name.data()),
                                                 static_cast<int>(name.size()), -1, 0) == 1 &&
                      X509_set_pubkey(made.get(), key) == 1;
    return done ? std::move(made) : nullptr;
}

Expected<CertificateAndKey> in_pem(X509* certificate, EVP_PKEY* key) {
    const Bio certificate_text(BIO_new(BIO_s_mem()));
    const Bio key_text(BIO_new(BIO_s_mem()));
    if (PEM_write_bio_X509(certificate_text.get(), certificate) != 1 ||
        PEM_write_bio_PrivateKey(key_text.get(), key, nullptr, nullptr, 0, nullptr, nullptr) != 1)
        return openssl_failed("cannot write a certificate");
    return CertificateAndKey{text_of(certificate_text), text_of(key_text)};
}

std::string alternative_names(const std::vector<std::string>& hosts) {
    return listed(hosts, ",", [](const auto& host) { return (is_address(host) ? "IP:" : "DNS:") + host; });
}

Certificate certificate_in(const std::string& pem) {
    return Certificate(PEM_read_bio_X509(bio_of(pem).get(), nullptr, nullptr, nullptr));
}

Key key_in(const std::string& pem) {
    // Without a callback OpenSSL would ask the terminal for the password of an encrypted key.
    const auto none = [](char*, int, int, void*) { return 0; };
    return Key(PEM_read_bio_PrivateKey(bio_of(pem).get(), nullptr, none, nullptr));
}

CertificateTime after(CertificateTime now, std::chrono::years length) {
    return now + std::chrono::duration_cast<std::chrono::seconds>(length);
}

}  // namespace

Expected<CertificateAndKey> make_authority(CertificateTime now, const std::string& known_key) {
    const Key key = known_key.empty() ? Key(EVP_EC_gen("P-256")) : key_in(known_key);
    if (!key)
        return openssl_failed(known_key.empty() ? "cannot make a key" : "cannot read the authority's key");
    const auto made = begin(key.get(), "ASIP authority", now, after(now, kAuthorityTime));
    if (!made) return openssl_failed("cannot make the authority's certificate");
    X509_set_issuer_name(made.get(), X509_get_subject_name(made.get()));
    const bool done =
        add_extension(made.get(), made.get(), NID_basic_constraints, "critical,CA:TRUE,pathlen:0") &&
        add_extension(made.get(), made.get(), NID_key_usage, "critical,keyCertSign,cRLSign") &&
        add_extension(made.get(), made.get(), NID_subject_key_identifier, "hash") &&
        X509_sign(made.get(), key.get(), EVP_sha256()) > 0;
    return done ? in_pem(made.get(), key.get()) : openssl_failed("cannot sign the authority's certificate");
}

Expected<CertificateAndKey> make_broker_certificate(const CertificateAndKey& authority,
                                                    const std::vector<std::string>& hosts,
                                                    CertificateTime now) {
    const auto issuer = certificate_in(authority.certificate);
    const auto issuer_key = key_in(authority.key);
    if (!issuer || !issuer_key) return openssl_failed("cannot read the authority's certificate and key");
    if (X509_check_private_key(issuer.get(), issuer_key.get()) != 1)
        return openssl_failed("the authority's certificate and key do not belong together");
    const auto end = end_of(authority.certificate);
    if (!end) return fail(end.error());
    if (*end <= now) return fail("the authority's certificate has ended; begin anew in another folder");
    const Key key(EVP_EC_gen("P-256"));
    if (!key) return openssl_failed("cannot make a key");
    const auto made = begin(key.get(), "ASIP broker", now, std::min(*end, after(now, kBrokerTime)));
    if (!made) return openssl_failed("cannot make the broker's certificate");
    X509_set_issuer_name(made.get(), X509_get_subject_name(issuer.get()));
    const bool done =
        add_extension(made.get(), issuer.get(), NID_basic_constraints, "critical,CA:FALSE") &&
        add_extension(made.get(), issuer.get(), NID_key_usage, "critical,digitalSignature") &&
        add_extension(made.get(), issuer.get(), NID_ext_key_usage, "serverAuth") &&
        add_extension(made.get(), issuer.get(), NID_subject_key_identifier, "hash") &&
        add_extension(made.get(), issuer.get(), NID_authority_key_identifier, "keyid") &&
        add_extension(made.get(), issuer.get(), NID_subject_alt_name, alternative_names(hosts)) &&
        X509_sign(made.get(), issuer_key.get(), EVP_sha256()) > 0;
    return done ? in_pem(made.get(), key.get()) : openssl_failed("cannot sign the broker's certificate");
}

Expected<CertificateTime> end_of(const std::string& certificate) {
    const auto read = certificate_in(certificate);
    if (!read) return openssl_failed("not a certificate");
    std::tm time{};
    if (ASN1_TIME_to_tm(X509_get0_notAfter(read.get()), &time) != 1)
        return openssl_failed("a certificate without an end");
    using namespace std::chrono;
    const sys_days day = year(time.tm_year + 1900) / (time.tm_mon + 1) / time.tm_mday;
    return day + hours(time.tm_hour) + minutes(time.tm_min) + seconds(time.tm_sec);
}

std::string explain_certificate(const CertificateAndKey& broker, const std::string& authority,
                                const std::vector<std::string>& hosts) {
    const auto own = certificate_in(broker.certificate);
    const auto key = key_in(broker.key);
    const auto issuer = certificate_in(authority);
    const bool read = own && key && issuer;
    const bool fits = read && X509_check_private_key(own.get(), key.get()) == 1;
    const bool signed_by = read && X509_verify(own.get(), X509_get0_pubkey(issuer.get())) == 1;
    ERR_clear_error();
    if (!read) return "it cannot be read";
    if (!fits) return "it belongs to another key";
    if (!signed_by) return "it is not signed by the authority";
    for (const auto& host : hosts) {
        const bool named = is_address(host) ? X509_check_ip_asc(own.get(), host.c_str(), 0) == 1
                                            : X509_check_host(own.get(), host.c_str(), 0, 0, nullptr) == 1;
        if (!named) return "it does not name " + host;
    }
    return {};
}

bool valid_host(const std::string& host) {
    if (is_address(host)) return host.find('%') == std::string::npos;
    if (host.empty() || host.size() > 253 || host.front() == '.' || host.front() == '-') return false;
    return std::all_of(host.begin(), host.end(), [](unsigned char c) {
        return std::isalnum(c) != 0 || c == '-' || c == '.' || c == '_';
    });
}

}  // namespace asip::cli
