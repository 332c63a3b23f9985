// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <string>
#include <vector>

#include "asip/expected.hpp"

namespace asip::cli {

using CertificateTime = std::chrono::sys_seconds;

/// A certificate and its private key, in PEM.
struct CertificateAndKey {
    std::string certificate;
    std::string key;
};

/// An authority of its own (P-256), valid for 20 years. It signs brokers, and no further authorities. `key`:
/// in PEM, of an authority whose certificate is lost; empty: a new one.
Expected<CertificateAndKey> make_authority(CertificateTime now, const std::string& key = {});

/// A certificate for a broker that is called by `hosts`, each a host name or an IP address (at least one),
/// valid for 10 years (at most as long as the authority): an expired one would take every board off the bus
/// at once, and a broker whose key is lost gets a new one. Both begin a day early, for boards whose clock is
/// late.
Expected<CertificateAndKey> make_broker_certificate(const CertificateAndKey& authority,
                                                    const std::vector<std::string>& hosts,
                                                    CertificateTime now);

/// When the certificate ends. Fails for anything that is not a certificate in PEM.
Expected<CertificateTime> end_of(const std::string& certificate);

/// Why the broker cannot use this certificate: another key's, not of this authority, or without one of
/// `hosts`; empty: it can.
std::string explain_certificate(const CertificateAndKey& broker, const std::string& authority,
                                const std::vector<std::string>& hosts);

/// Whether `host` may stand in a certificate and in a broker's address.
bool valid_host(const std::string& host);

}  // namespace asip::cli
