// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/broker_files.hpp"

#include <unistd.h>

#include <algorithm>
#include <sstream>

#include "asip/text/file_text.hpp"
#include "asip/text/wall_time.hpp"
#include "cli/secure/reload.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

namespace fs = std::filesystem;

CertificateTime now() {
    return std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
}

/// Programs on the broker's machine may call it by loopback.
std::vector<std::string> certificate_hosts(std::vector<std::string> hosts) {
    for (const char* own : {"localhost", "127.0.0.1", "::1"})
        if (std::find(hosts.begin(), hosts.end(), own) == hosts.end()) hosts.emplace_back(own);
    return hosts;
}

/// Half of the memory of this machine, in whole 64 MiB.
std::uint64_t memory_limit() {
    constexpr std::uint64_t kStep = std::uint64_t{64} << 20;
    const auto pages = ::sysconf(_SC_PHYS_PAGES);
    const auto page = ::sysconf(_SC_PAGE_SIZE);
    if (pages <= 0 || page <= 0) return BrokerPlaces().memory_limit;
    const auto half = static_cast<std::uint64_t>(pages) / 2 * static_cast<std::uint64_t>(page);
    return std::max(half / kStep, std::uint64_t{1}) * kStep;
}

std::string configuration_text(const SecureFolder& folder, const SecuredBus& bus) {
    BrokerPlaces places{folder.passwords(), folder.rules(), folder.certificate(), folder.key(), {}, {},
                        memory_limit(),     bus.port};
    if (!is_system_broker(folder.path(), bus)) {
        places.store = folder.store();
        places.pid_file = folder.pid_file();
    }
    return broker_configuration(places);
}

/// As Mosquitto reads it: words in a line, with any spaces before and between.
bool lets_in_everybody(const fs::path& file) {
    std::istringstream lines(text::file_text(file).value_or(""));
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string name, value;
        if (words >> name >> value && name == "allow_anonymous" && value == "true") return true;
    }
    return false;
}

}  // namespace

/// A machine without a clock of its own begins in 1970: what it signed then would have ended long ago.
Outcome<void> check_clock() {
    constexpr CertificateTime kEarliest = std::chrono::sys_days(std::chrono::year(2026) / 1 / 1);
    if (now() >= kEarliest) return {};
    return failure(program::kExitFailure, "this machine's clock is wrong, it says " +
                                              text::iso_time(text::wall_now()).substr(0, 10) +
                                              ": set it first, certificates begin and end by it");
}

Outcome<void> ensure_authority(const SecureFolder& folder, SecureReport& report) {
    const auto key = text::file_text(folder.authority_key());
    const bool certificate = fs::exists(folder.authority());
    if (key && certificate) {
        // Closes it to others, where it came back from a backup.
        if (auto done = folder.write(folder.authority_key(), *key, SecureFolder::Readers::kOwner); !done)
            return tl::unexpected(done.error());
        report.did("kept", "authority", folder.authority());
        return {};
    }
    if (fs::exists(folder.authority_key()) != key.has_value())
        return failure(program::kExitFailure, "cannot read " + folder.authority_key().string());
    if (!key && (certificate || folder.initialised())) {
        return failure(program::kExitFailure, "the authority's key " + folder.authority_key().string() +
                                                  " is missing; put it back for this");
    }
    // A key without its certificate is one of a run that was interrupted, or the certificate was lost: a
    // private key is never made anew where there is one.
    const auto made = make_authority(now(), key.value_or(""));
    if (!made) return failure(program::kExitFailure, made.error());
    if (!key) {
        if (auto done = folder.write(folder.authority_key(), made->key, SecureFolder::Readers::kOwner); !done)
            return tl::unexpected(done.error());
    }
    if (auto done = folder.write(folder.authority(), made->certificate, SecureFolder::Readers::kAll); !done)
        return tl::unexpected(done.error());
    report.did("made",
               key ? "certificate of the authority, for the key that was there"
                   : "authority, whose key signs the broker (back it up, never give it away)",
               key ? folder.authority() : folder.authority_key());
    return {};
}

Outcome<void> write_certificate(const SecureFolder& folder, const SecuredBus& bus) {
    const auto authority = folder.authority_and_key();
    if (!authority) return tl::unexpected(authority.error());
    const auto made = make_broker_certificate(*authority, certificate_hosts(bus.hosts), now());
    if (!made) return failure(program::kExitFailure, made.error());
    if (auto done = folder.write(folder.key(), made->key, SecureFolder::Readers::kOwner); !done)
        return tl::unexpected(done.error());
    if (auto done = folder.write(folder.certificate(), made->certificate, SecureFolder::Readers::kAll); !done)
        return tl::unexpected(done.error());
    return {};
}

Outcome<void> ensure_certificate(const SecureFolder& folder, const SecuredBus& bus, SecureReport& report) {
    const auto key = text::file_text(folder.key());
    const auto certificate = text::file_text(folder.certificate());
    std::string why = "there was none";
    if (key && certificate) {
        why = explain_certificate({*certificate, *key}, text::file_text(folder.authority()).value_or(""),
                                  certificate_hosts(bus.hosts));
        if (why.empty()) {
            if (auto done = folder.write(folder.key(), *key, SecureFolder::Readers::kOwner); !done)
                return tl::unexpected(done.error());
            report.did("kept", "certificate of the broker", folder.certificate());
            return {};
        }
    }
    if (auto done = write_certificate(folder, bus); !done) return done;
    report.did("made", "certificate of the broker for " + listed(bus.hosts) + " (" + why + ")",
               folder.certificate());
    return {};
}

Outcome<void> ensure_configuration(const SecureFolder& folder, const SecuredBus& bus, SecureReport& report) {
    const auto wanted = configuration_text(folder, bus);
    const auto present = text::file_text(bus.configuration);
    if (present) {
        report.did("kept", "Mosquitto's configuration", bus.configuration);
        if (*present != wanted)
            report.did("warning", "it is not as asipctl would write it: remove it and repeat this for that",
                       bus.configuration);
        return {};
    }
    if (auto done = folder.write(bus.configuration, wanted, SecureFolder::Readers::kAll); !done)
        return tl::unexpected(done.error());
    report.did("made", "Mosquitto's configuration", bus.configuration);
    return {};
}

Outcome<void> close_open_listeners(const SecuredBus& bus, SecureReport& report) {
    std::error_code error;
    const auto folder = fs::path(bus.configuration).parent_path();
    if (const auto main = folder.parent_path() / "mosquitto.conf"; lets_in_everybody(main))
        report.did("warning", "this file lets in everybody; remove that line", main);
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
        if (it->path().extension() != ".conf" || !lets_in_everybody(it->path())) continue;
        auto moved = it->path();
        moved += ".open";
        if (it->path().filename() != "asip.conf" || fs::exists(moved)) {
            report.did("warning", "this file lets in everybody; remove it", it->path());
            continue;
        }
        fs::rename(it->path(), moved, error);
        if (error)
            return failure(program::kExitFailure,
                           "cannot move " + it->path().string() + ": " + error.message());
        report.did("moved", "the configuration that lets in everybody", moved);
    }
    return {};
}

std::vector<fs::path> open_configurations(const SecuredBus& bus) {
    std::vector<fs::path> found;
    const auto ours = fs::path(bus.configuration).parent_path() / "asip.conf";
    if (lets_in_everybody(ours) && !fs::exists(ours.string() + ".open")) found.push_back(ours);
    return found;
}

Outcome<void> remove_configuration(const SecuredBus& bus, SecureReport& report) {
    std::error_code error;
    if (fs::remove(bus.configuration, error))
        report.did("removed", "Mosquitto's configuration", bus.configuration);
    if (error)
        return failure(program::kExitFailure, "cannot remove " + bus.configuration + ": " + error.message());
    const auto ours = fs::path(bus.configuration).parent_path() / "asip.conf";
    const auto moved = ours.string() + ".open";
    if (!fs::exists(moved) || fs::exists(ours)) return {};
    fs::rename(moved, ours, error);
    if (error) return failure(program::kExitFailure, "cannot move " + moved + ": " + error.message());
    report.did("moved", "the configuration that lets in everybody back", ours);
    return {};
}

}  // namespace asip::cli
