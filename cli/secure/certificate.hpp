// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <string>
#include <vector>

#include "asip/expected.hpp"

namespace asip::cli {

using CertificateTime = std::chrono::sys_seconds;

/// In PEM.
struct CertificateAndKey {
    std::string certificate;
    std::string key;
};

/// P-256, for 20 years; it signs brokers alone. `key`: of an authority whose certificate is lost; empty: a
/// new one.
Expected<CertificateAndKey> make_authority(CertificateTime now, const std::string& key = {});

/// For `hosts`, names or IP addresses, for 10 years: an expired one would take every board off the bus at
/// once. Both begin a day early, for boards whose clock is late.
Expected<CertificateAndKey> make_broker_certificate(const CertificateAndKey& authority,
                                                    const std::vector<std::string>& hosts,
                                                    CertificateTime now);

/// Fails for anything else.
Expected<CertificateTime> end_of(const std::string& certificate);

/// Another key's, not of this authority, or without one of `hosts`; empty: it can.
std::string explain_certificate(const CertificateAndKey& broker, const std::string& authority,
                                const std::vector<std::string>& hosts);

/// In a certificate and in a broker's address.
bool valid_host(const std::string& host);

}  // namespace asip::cli
