// SPDX-License-Identifier: Apache-2.0
#include "asip/session/service_table.hpp"

#include <gtest/gtest.h>

namespace asip::session {
namespace {

Identity board_with(std::vector<protocol::ServiceName> services) {
    Identity board;
    board.services = std::move(services);
    return board;
}

TEST(ServiceTable, ServiceWithAModel_HasItsName) {
    const ServiceTable table(board_with({{'I', "ASIP core IO"}, {'D', "Distance"}}),
                             model::ModelSet::standard());
    ASSERT_NE(table.find("distance"), nullptr);
    EXPECT_EQ(table.find("distance")->letter, 'D');
    EXPECT_EQ(table.find("distance")->title, "Distance");
    EXPECT_EQ(table.find('D'), table.find("distance"));
}

TEST(ServiceTable, SecondOfAKind_IsReachedByItsLetter) {
    const ServiceTable table(board_with({{'D', "Distance"}, {'D', "Distance"}}), model::ModelSet::standard());
    ASSERT_EQ(table.entries().size(), 2U);
    EXPECT_EQ(table.entries()[0].name, "distance");
    EXPECT_EQ(table.entries()[1].name, "D");
    ASSERT_NE(table.find("D"), nullptr);
    EXPECT_EQ(table.find("D")->model, table.find("distance")->model);
}

TEST(ServiceTable, ServiceWithoutAModel_HasItsLetterAndNoModel) {
    const ServiceTable table(board_with({{'Z', "A thing"}}), model::ModelSet::standard());
    ASSERT_NE(table.find("Z"), nullptr);
    EXPECT_EQ(table.find("Z")->model, nullptr);
    EXPECT_EQ(table.find("thing"), nullptr);
    EXPECT_EQ(table.find('D'), nullptr);
}

}  // namespace
}  // namespace asip::session
