// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/types.h>

#include <filesystem>
#include <string>

#include "asip/descriptor.hpp"
#include "cli/environment.hpp"
#include "cli/secure/bus_file.hpp"
#include "cli/secure/certificate.hpp"

namespace asip::cli {

/// The folder of a bus. Secrets are readable by their owner alone: `broker/` belongs to `mosquitto` where
/// root made it. Files are replaced whole.
class SecureFolder {
  public:
    using Path = std::filesystem::path;

    /// Made and locked; waits for other runs.
    static Outcome<SecureFolder> create(const Path& path);
    /// Fails where `init` has not been run.
    static Outcome<SecureFolder> open(const Path& path);

    const Path& path() const { return path_; }
    Path authority_key() const { return path_ / "ca.key"; }
    Path authority() const { return path_ / "ca.crt"; }
    Path configuration() const { return path_ / "mosquitto.conf"; }
    Path passwords() const { return path_ / "broker" / "passwords"; }
    Path rules() const { return path_ / "broker" / "rules.acl"; }
    Path certificate() const { return path_ / "broker" / "broker.crt"; }
    Path key() const { return path_ / "broker" / "broker.key"; }
    Path pid_file() const { return path_ / "broker" / "mosquitto.pid"; }
    Path store() const { return path_ / "broker"; }
    /// Until the broker was started with what was made.
    Path unfinished() const { return path_ / "unfinished"; }
    Path credentials(const std::string& user) const {
        return path_ / "credentials" / (user + ".credentials");
    }

    Outcome<SecuredBus> bus() const;
    bool initialised() const { return std::filesystem::exists(bus_file()); }
    /// Where this machine has its key.
    Outcome<CertificateAndKey> authority_and_key() const;

    Outcome<void> save(const SecuredBus& bus) const;
    /// True: the file was missing or different, or others could read it.
    enum class Readers { kOwner, kAll };
    Outcome<bool> write(const Path& file, const std::string& text, Readers readers) const;

  private:
    SecureFolder(Path path, Descriptor lock) : path_(std::move(path)), lock_(std::move(lock)) {}
    Path bus_file() const { return path_ / "bus.json"; }
    bool for_broker(const Path& file) const { return file.parent_path() == store(); }

    Path path_;
    Descriptor lock_;
};

}  // namespace asip::cli
