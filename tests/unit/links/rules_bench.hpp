// SPDX-License-Identifier: Apache-2.0
// A target that obeys, and the links that set it.
#pragma once
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "asip/links/rules.hpp"

namespace asip::links {

using namespace std::chrono_literals;
using nlohmann::json;
using property::ButtonAct;

/// A lamp that obeys, with the links that set it.
class RulesTest : public testing::Test {
  protected:
    Rules rules{
        {.value = [this](const std::string& id) { return target.contains(id) ? target[id] : std::nullopt; },
         .ready = [this] { return ready; },
         .second_of_day = [this] { return second_of_day; },
         .dangerous = [](const Link& link) { return link.target.starts_with("motors"); }}};
    std::map<std::string, std::optional<json>> target{{"io/13", json(false)}};
    bool ready = true;
    int second_of_day = 12 * 3600;
    Time now{};
    std::vector<json> sent;  // values in order; "safe" and commands by their kind
    std::vector<Order> orders;

    static Link link(When when = When::kFollows) {
        Link made;
        made.name = "l";
        made.board = "desk";
        made.source = "io/2";
        made.target = "io/13";
        made.when = when;
        return made;
    }
    void add(const Link& made, Kept kept = {}) { rules.set(made, std::move(kept), now); }
    void run() {
        for (const auto& order : rules.run(now)) {
            orders.push_back(order);
            sent.push_back(order.kind == Order::Kind::kSafe ? json("safe") : order.value);
            if (executes) {
                const auto& of = rules.links().at(order.link).link.target;
                target[of] = order.kind == Order::Kind::kSafe ? json(0) : order.value;
                rules.executed(of, order.link);
            }
            if (answers) rules.finished(order.link, executes, "no answer");
        }
    }
    void source(const std::optional<json>& value) {
        rules.source("desk", "io/2", value, now);
        run();
    }
    void press(ButtonAct act = ButtonAct::kPress) {
        rules.act("desk", "io/2", act, now);
        run();
    }
    void person(const json& value) {
        target["io/13"] = value;
        rules.executed("io/13", "");
        run();
    }
    void pass(Duration time) {
        const auto end = now + time;
        int wakes = 0;
        while (const auto due = rules.next_deadline()) {
            if (*due > end) break;
            ASSERT_LT(++wakes, 5000) << "it wakes for nothing";
            second_of_day = (second_of_day + static_cast<int>((std::max(*due, now) - now) / 1s)) % 86400;
            now = std::max(*due, now) + 1us;
            run();
        }
        now = end;
    }
    /// The agent ends, and another one begins with what was kept.
    void restart() {
        const auto kept = rules.links();
        auto world = Rules::World{
            [this](const std::string& id) { return target.contains(id) ? target[id] : std::nullopt; },
            [this] { return ready; }, [this] { return second_of_day; }, [](const Link&) { return false; }};
        rules = Rules(std::move(world));
        for (const auto& [name, entry] : kept)
            rules.set(entry.link, entry.kept, now);
        target["io/13"] = std::nullopt;
        rules.target_back();
        run();
    }
    std::string cause() const { return rules.links().at("l").cause; }
    bool executes = true, answers = true;
};

}  // namespace asip::links
