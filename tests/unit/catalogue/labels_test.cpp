// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/catalogue_check.hpp"
#include "tests/unit/catalogue/bus_messages.hpp"

namespace asip::catalogue {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct LabelledCatalogue : testing::Test {
    Applied announce(const std::string& board, std::uint64_t seq, const std::string& more) {
        return catalogue.apply(description(board, {.seq = seq, .more = more}).view(), at(1s));
    }
    bus::BoardItem only_board() {
        bus::Query query;
        query.full = true;
        auto answer = catalogue.find(query, instant(at(2s)));
        EXPECT_EQ(answer->boards.size(), 1u);
        return answer->boards.at(0);
    }
    std::vector<std::string> chosen(const std::string& selector,
                                    std::optional<std::size_t>* total = nullptr) {
        bus::Query query;
        query.labels = *bus::LabelSelector::parse(selector);
        query.count = true;
        std::vector<std::string> names;
        const auto answer = catalogue.find(query, instant(at(2s)));
        for (const auto& board : answer->boards)
            names.push_back(board.board);
        if (total != nullptr) *total = answer->total;
        return names;
    }
    Catalogue catalogue{Catalogue::Options{}};
};

TEST_F(LabelledCatalogue, LabelsAndNames_AreInItemsServicesAndTheWholeDescription) {
    announce("desk", 1,
             R"("labels":{"room":"lab"},"names":{"services":{"servo":"left arm"},"pins":{"13":"lamp"}})");
    const auto board = only_board();
    EXPECT_EQ(board.labels, (model::Labels{{{"room", "lab"}}, {{"servo", "left arm"}}, {{13, "lamp"}}}));
    EXPECT_EQ(board.services.at(1).label, "left arm");
    EXPECT_EQ(board.services.at(0).label, "");
    EXPECT_THAT(board.description, HasSubstr(R"("labels":{"room":"lab"})"));
}

TEST_F(LabelledCatalogue, Change_IsAnEventAndTheNewLabelsChoose) {
    announce("desk", 1, R"("labels":{"room":"lab"})");
    announce("lamp", 1, "");
    EXPECT_THAT(chosen("room=lab"), ElementsAre("desk"));
    const auto applied = announce("desk", 2, R"("labels":{"room":"hall"})");
    ASSERT_EQ(applied.events.size(), 1u);
    EXPECT_EQ(applied.events[0].kind, Event::Kind::kDescription);
    EXPECT_THAT(announce("desk", 3, R"("labels":{"room":"hall"})").events, IsEmpty()) << "a renewal";
    EXPECT_THAT(chosen("room=lab"), IsEmpty());
    EXPECT_THAT(chosen("room=hall"), ElementsAre("desk"));
    announce("desk", 4, "");
    EXPECT_THAT(chosen("room"), IsEmpty());
    std::optional<std::size_t> total;
    EXPECT_THAT(chosen("!room", &total), ElementsAre("desk", "lamp"));
    EXPECT_EQ(total, 2u);
    announce("lamp", 2, R"("labels":{"room":"attic"})");
    chosen("room", &total);
    EXPECT_EQ(total, 1u);
    EXPECT_EQ(CatalogueCheck::check(catalogue), "");
}

TEST_F(LabelledCatalogue, BoardKnownByItsNames_HasNoLabels) {
    catalogue.apply(board_name("paper").view(), at(1s));
    EXPECT_THAT(chosen("room"), IsEmpty());
    EXPECT_THAT(chosen("!room"), ElementsAre("paper"));
}

TEST_F(LabelledCatalogue, WhatIsNotLabels_RefusesTheDescription) {
    announce("desk", 1, R"("labels":{"room":"lab"})");
    for (const char* more : {R"("labels":["room"])", R"("labels":{"room":7})", R"("labels":{"a b":"x"})",
                             R"("labels":{"room":"x\u0007"})", R"("names":{"pins":{"x":"y"}})",
                             R"("names":null)", R"("labels":{},"labels":{"room":"x"})"}) {
        EXPECT_EQ(announce("desk", 2, more).refused, Refusal::kMalformed) << more;
    }
    EXPECT_THAT(chosen("room=lab"), ElementsAre("desk"));
    EXPECT_EQ(CatalogueCheck::check(catalogue), "");
}

}  // namespace
}  // namespace asip::catalogue
