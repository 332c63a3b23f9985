// SPDX-License-Identifier: Apache-2.0
// What the bus shows of a board after each message: tests/vectors/presence.json, which the tests of the
// Python package and of the Node-RED nodes read, too. What it expects is what BusView says:
// ASIP_WRITE_VECTORS=1 writes it anew.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "asip/catalogue/bus_view.hpp"
#include "asip/model/board_state.hpp"

namespace asip::catalogue {
namespace {

using json = nlohmann::ordered_json;

constexpr Time kStart{std::chrono::hours(10'000)};
const std::string kBoard = "desk";

Time at(const json& step) {
    return kStart +
           std::chrono::duration_cast<Duration>(std::chrono::duration<double>(step.at("at").get<double>()));
}

std::string payload_of(const json& step) {
    if (step.contains("state")) return step.at("state");
    if (step.contains("text")) return step.at("text");
    json document = {{"board", kBoard}, {"services", json::array()}};
    document.update(step.at("say"));
    return document.dump();
}

void take(BusView& view, const json& step) {
    if (step.contains("heard")) return step.at("heard") ? view.connected(at(step)) : view.disconnected();
    if (!step.contains("state") && !step.contains("text") && !step.contains("say")) return;
    mqtt::Message message{
        .topic = "asip/servicebus/" + kBoard + (step.contains("state") ? "/$state" : "/$description"),
        .payload = payload_of(step),
        .retain = step.value("kept", false)};
    if (step.contains("expiry")) message.expiry_seconds = step.at("expiry").get<std::uint32_t>();
    view.apply(message, at(step));
}

/// State, reason, and the seconds that it is in it: null where they are not known. Null: there is no such
/// board.
json shown(BusView& view, const json& step) {
    const auto item = view.board(kBoard, {at(step), text::WallTime{}});
    if (!item) return nullptr;
    return {item->state, item->reason, item->state_age < 0 ? json() : json(item->state_age)};
}

bool is_same(const json& told, const json& expected) {
    if (told.is_null() || expected.is_null() || told[2].is_null() || expected[2].is_null())
        return told == expected;
    return told[0] == expected[0] && told[1] == expected[1] &&
           std::abs(told[2].get<double>() - expected[2].get<double>()) < 0.001;
}

/// The words of all reasons.
json reasons() {
    json all;
    for (int i = 0; i <= static_cast<int>(model::StateReason::kLatched); ++i) {
        const auto reason = static_cast<model::StateReason>(i);
        all[std::string(to_text(reason))] = words_of(reason);
    }
    return all;
}

/// One line a step, so that a change shows what it changes.
std::string written(const json& vectors) {
    std::string text = "{\n\"about\": " + vectors.at("about").dump() + ",\n\"histories\": [";
    for (const auto& history : vectors.at("histories")) {
        text += (text.back() == '[' ? "\n{\"about\": " : ",\n{\"about\": ") + history.at("about").dump() +
                ", \"steps\": [";
        for (const auto& step : history.at("steps"))
            text += (text.back() == '[' ? "\n  " : ",\n  ") + step.dump();
        text += "]}";
    }
    return text + "\n]\n}\n";
}

TEST(PresenceVectors, WhatIsShownAfterEachMessage_IsWhatTheFileSays) {
    auto vectors = json::parse(std::ifstream(ASIP_PRESENCE_VECTORS));
    const bool writes = std::getenv("ASIP_WRITE_VECTORS") != nullptr;
    std::size_t steps = 0;
    for (auto& history : vectors.at("histories")) {
        BusView view{bus::Topics("asip")};
        view.connected(kStart);
        for (auto& step : history.at("steps")) {
            take(view, step);
            const auto told = shown(view, step);
            if (writes) step["then"] = told;
            EXPECT_TRUE(is_same(told, step.at("then")))
                << history.at("about") << ": " << step << "\nis " << told;
            ++steps;
        }
    }
    EXPECT_GT(steps, 1000U);
    if (writes) std::ofstream(ASIP_PRESENCE_VECTORS) << written(vectors);
}

TEST(PresenceVectors, WordsOfEachReason_AreWhatTheFileSays) {
    EXPECT_EQ(json::parse(std::ifstream(ASIP_REASON_VECTORS)).at("states"), reasons());
}

}  // namespace
}  // namespace asip::catalogue
