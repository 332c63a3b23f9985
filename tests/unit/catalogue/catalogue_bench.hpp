// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "asip/catalogue/catalogue.hpp"
#include "bus_messages.hpp"
#include "tests/support/catalogue_check.hpp"

namespace asip::catalogue {

class CatalogueTest : public testing::Test {
  protected:
    std::vector<Event::Kind> give(const OwnedMessage& message, Duration when = 0s) {
        auto applied = catalogue.apply(message.view(), at(when));
        refused = applied.refused;
        EXPECT_EQ(CatalogueCheck::check(catalogue), "");
        return kinds(applied.events);
    }
    std::vector<Event::Kind> expire(Duration when) {
        auto events = catalogue.expire(at(when));
        EXPECT_EQ(CatalogueCheck::check(catalogue), "");
        return kinds(events);
    }
    static std::vector<Event::Kind> kinds(const std::vector<Event>& events) {
        std::vector<Event::Kind> result;
        for (const Event& event : events)
            result.push_back(event.kind);
        return result;
    }
    bus::BoardItem board(const std::string& name, Duration when = 0s) {
        return catalogue.board(name, instant(at(when))).value_or(bus::BoardItem{});
    }
    std::string state_of(const std::string& name) { return board(name).state; }

    Catalogue catalogue;
    std::optional<Refusal> refused;
};

}  // namespace asip::catalogue
