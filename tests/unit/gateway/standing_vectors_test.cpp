// SPDX-License-Identifier: Apache-2.0
// Which documents of a board count, and what they tell of buttons: tests/vectors/properties.json, which the
// tests of the Python package and of the Node-RED nodes read, too.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "gateway/mirror/standing.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;

json vectors(const char* name) {
    return json::parse(std::ifstream(ASIP_SOURCE_DIR "/tests/vectors/properties.json")).at(name);
}

std::string document(const std::string& session, int seq, const json& events = json::object()) {
    json values = json::object();
    for (const auto& [id, each] : events.items())
        values[id] = {{"value", true}, {"how", "reported"}, {"age", 0}, {"events", each}};
    return json{{"version", 1}, {"board", "desk"},  {"session", session},
                {"seq", seq},   {"values", values}, {"properties", json::array()}}
        .dump();
}

TEST(StandingVectors, DocumentsThatCount_AreThoseOfTheFile) {
    for (const auto& each : vectors("order"))
        for (const bool list : {true, false}) {
            Standing standing;
            for (const auto& one : each.at("documents")) {
                const auto text = one.is_null() ? std::string() : document(one.at(0), one.at(1));
                const auto holder = each.at("holder").get<std::string>();
                const auto outdated = standing.counters().outdated;
                if (list)
                    standing.take_list("desk", text, holder);
                else
                    standing.take_values("desk", text, holder, Time());
                EXPECT_EQ(standing.counters().damaged, 0U);
                const bool counts = one.is_null() || one.at(2).get<bool>();
                EXPECT_EQ(standing.counters().outdated == outdated, counts) << each.at("about") << " " << one;
            }
        }
}

TEST(StandingVectors, WhatWasReportedBefore_CountsUntilADocumentThatTheFileNames) {
    for (const auto& each : vectors("begins")) {
        Standing standing;
        for (const auto& one : each.at("documents")) {
            auto text = one.is_null() ? std::string() : document(one.at(0), one.at(1));
            if (!one.is_null()) text.insert(1, "\"restarts\":" + one.at(2).dump() + ",");
            const auto change = standing.take_values("desk", text, "", Time());
            EXPECT_EQ(change.anew, !one.is_null() && one.at(3).get<bool>()) << each.at("about") << " " << one;
        }
    }
}

TEST(StandingVectors, WhatIsToldOfButtons_IsWhatTheFileSays) {
    for (const auto& each : vectors("acts")) {
        Standing standing;
        for (const auto& one : each.at("documents")) {
            const auto text =
                one.is_null() ? std::string() : document(one.at("session"), one.at("seq"), one.at("events"));
            const bool stored = !one.is_null() && one.value("stored", false);
            const auto change = standing.take_values("desk", text, "", Time(), stored);
            auto acts = json::array();
            for (const auto& [id, act] : change.acts)
                acts.push_back({id, property::to_text(act)});
            EXPECT_EQ(acts, one.is_null() ? json::array() : one.at("acts")) << each.at("about");
        }
    }
}

}  // namespace
}  // namespace asip::gateway
