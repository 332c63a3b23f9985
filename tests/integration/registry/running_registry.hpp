// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "asip/bus/registry/answer.hpp"
#include "tests/support/bus_probe.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/mosquitto_broker.hpp"

namespace asip::test {

/// The program as users start it.
class RunningRegistry {
  public:
    explicit RunningRegistry(const std::string& broker, const std::string& id = "r1",
                             const std::vector<std::string>& more = {})
        : process_(arguments(broker, id, more)) {}

    /// Once it has read everything the broker retains.
    bool complete() { return process_.wait_for_errors("catalogue is complete").has_value(); }
    ChildProcess& process() { return process_; }

  private:
    static std::vector<std::string> arguments(const std::string& broker, const std::string& id,
                                              const std::vector<std::string>& more) {
        std::vector<std::string> all{ASIP_REGISTRY_PROGRAM, "--broker", broker, "--id", id};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }
    ChildProcess process_;
};

inline std::string description_text(const std::string& board, const std::string& session, int seq,
                                    int lease = 60, const std::string& kind = "distance") {
    return R"({"board":")" + board + R"(","session":")" + session + R"(","seq":)" + std::to_string(seq) +
           R"(,"lease":)" + std::to_string(lease) +
           R"(,"firmware":{"protocol":"0.4","chip":"ATmega328P","sketch":"AsipHello"},"services":[{"name":")" +
           kind + R"(","id":"D","model":")" + kind + R"(@1","title":"A thing"}]})";
}

inline mqtt::Message announcement(const std::string& board, const std::string& payload,
                                  std::optional<std::uint32_t> expiry = std::nullopt) {
    return mqtt::Message{.topic = "asip/servicebus/" + board + "/$description",
                         .payload = payload,
                         .qos = 1,
                         .retain = true,
                         .expiry_seconds = expiry};
}

/// The answer of whichever registry, or of one.
inline std::optional<bus::Answer> ask(BusProbe& probe, const std::string& query,
                                      const std::string& registry = {}) {
    const auto text = probe.request(
        registry.empty() ? "asip/registry/query" : "asip/registry/" + registry + "/query", query);
    if (!text) return std::nullopt;
    auto answer = bus::parse_answer(*text);
    EXPECT_TRUE(answer) << *text;
    return answer ? std::optional(*answer) : std::nullopt;
}

/// What the registry says to a request to forget `board`, on the topic that access rules can guard.
inline std::optional<bus::Answer> ask_to_forget(BusProbe& probe, const std::string& board,
                                                const std::string& registry) {
    const auto text =
        probe.request("asip/registry/" + registry + "/forget", R"({"forget":")" + board + R"("})");
    if (!text) return std::nullopt;
    auto answer = bus::parse_answer(*text);
    EXPECT_TRUE(answer) << *text;
    return answer ? std::optional(*answer) : std::nullopt;
}

/// Effective state of a board by a registry; "unknown" if it has none of that name.
inline std::string state_of(BusProbe& probe, const std::string& board, const std::string& registry = "r1") {
    const auto answer = ask(probe, R"({"find":"boards","board":")" + board + R"("})", registry);
    if (!answer) return "no answer";
    return answer->boards.empty() ? "unknown" : answer->boards.front().state;
}

inline bool becomes(BusProbe& probe, const std::string& board, const std::string& state,
                    const std::string& registry = "r1") {
    return wait_until([&] { return state_of(probe, board, registry) == state; });
}

/// Events of one registry that a probe has seen, in order, without the resets: whether the first one is
/// heard depends on which program was connected first.
inline std::vector<bus::ChangeEvent> events_of(const BusProbe& probe, const std::string& registry = "r1") {
    std::vector<bus::ChangeEvent> events;
    for (const auto& message : probe.messages("asip/registry/" + registry + "/events")) {
        auto event = bus::parse_change_event(message.payload);
        EXPECT_TRUE(event) << message.payload;
        if (event && event->kind != bus::ChangeEvent::Kind::kReset) events.push_back(*event);
    }
    return events;
}

}  // namespace asip::test
