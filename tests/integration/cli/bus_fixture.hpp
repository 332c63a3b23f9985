// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/bus_probe.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/mosquitto_broker.hpp"
#include "tests/unit/cli/boards.hpp"

namespace asip::test {

/// A broker, a probe that sees everything, and asipctl.
class BusTest : public ::testing::Test {
  protected:
    using Words = std::vector<std::string>;

    static Words program(Words arguments) {
        arguments.insert(arguments.begin(), ASIP_PROGRAMS "/asipctl");
        return arguments;
    }
    std::map<std::string, std::string> environment() const { return {{"ASIP_BROKER", broker_.address()}}; }
    Finished asipctl(const Words& arguments) const { return run(program(arguments), environment()); }

    /// As an agent retains it.
    void announce(const std::string& board, const std::string& state = "online") {
        std::string description = cli::kUno1;
        description.replace(description.find("uno1"), 4, board);
        probe_.publish("asip/servicebus/" + board + "/$description", description, true);
        probe_.publish("asip/servicebus/" + board + "/$state", state, true);
        ASSERT_TRUE(wait_until([this] { return probe_.all_acknowledged(); }));
    }

    void answer(const mqtt::Message& request, const std::string& reply) {
        probe_.publish(mqtt::Message{
            .topic = request.response_topic, .payload = reply, .correlation = request.correlation});
    }

    // A reader that is not run for a moment loses nothing.
    MosquittoBroker broker_{{.extra_lines = {"max_queued_messages 0"}}};
    BusProbe probe_{broker_.port()};
};

}  // namespace asip::test
