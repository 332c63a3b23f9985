// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/support/bus_probe.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {

using Words = std::vector<std::string>;

inline Words operator+(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

/// A bus made by `asipctl secure init` in an empty folder, and the real Mosquitto that reads it.
class SecuredBus : public ::testing::Test {
  protected:
    SecuredBus();

    Finished secure(const Words& words) const {
        return run(Words{ASIP_TEST_ASIPCTL, "secure"} + words + Words{"--dir", folder()});
    }
    void add(const Words& role_and_names) const;
    void start_broker();

    std::string folder() const { return place_.file("bus"); }
    std::string file(const std::string& name) const { return folder() + "/" + name; }
    std::string credentials(const std::string& user) const {
        return file("credentials/" + user + ".credentials");
    }
    Words as(const std::string& user) const { return {"--credentials", credentials(user)}; }
    std::uint16_t port() const { return port_; }

    BusProbe::Options probe_options(const std::string& user) const;
    BusProbe probe(const std::string& user, const Words& filters) const {
        return BusProbe(port_, filters, probe_options(user));
    }

    /// What the broker says to a QoS 1 message of this user.
    bool may_publish(const std::string& user, const std::string& topic) const;
    /// Whether a message on `topic` reaches this user, subscribed by this topic and by wildcards.
    bool may_read(const std::string& user, const std::string& topic) const;
    /// Whether the broker accepts a connection with these options of mosquitto_pub.
    bool may_connect(const Words& options) const;
    /// The board announces itself, as far as its labels.
    void announce(const std::string& board, const std::string& labels) const;
    Words reload() const { return {"--reload-pid", std::to_string(broker_->pid())}; }
    std::string broker_log() const { return broker_->errors(); }

    TempDir place_;
    std::uint16_t port_ = free_port();
    std::unique_ptr<ChildProcess> broker_;
};

}  // namespace asip::test
