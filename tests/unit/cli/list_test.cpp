// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/list.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/commands/ping.hpp"
#include "cli/commands/show.hpp"
#include "cli/terminal.hpp"
#include "tests/unit/cli/boards.hpp"

namespace asip::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

bus::BoardItem uno1() {
    auto item = announced();
    item.age = 0.5;
    return item;
}

TEST(ListBoards, EachForm_SaysTheSame) {
    EXPECT_EQ(boards_text({uno1()}, Output::kTable, 0, false),
              "BOARD  STATE   CHIP        SKETCH     SERVICES             ANNOUNCED\n"
              "uno1   online  ATmega328P  AsipHello  io distance servo X  500 ms ago\n");
    EXPECT_THAT(boards_text({uno1()}, Output::kWide, 40, false), HasSubstr("serial /dev/ttyACM0"));
    EXPECT_EQ(boards_text({uno1()}, Output::kName, 0, false), "uno1\n");
    EXPECT_EQ(boards_text({}, Output::kTable, 0, false), "");
}

TEST(ListBoards, NarrowTerminal_IsNotExceeded) {
    EXPECT_EQ(boards_text({uno1()}, Output::kTable, 58, false),
              "BOARD  STATE   CHIP      SKETCH     SERVICES    ANNOUNCED\n"
              "uno1   online  ATmega3…  AsipHello  io distan…  500 ms ago\n");
}

TEST(ListBoards, NameConflict_IsMarked) {
    auto board = uno1();
    board.conflict = bus::Conflict{"a", "b", "elsewhere"};
    EXPECT_THAT(boards_text({board}, Output::kTable, 0, false), HasSubstr("online!"));
}

TEST(ListBoards, PortWhereNothingEverAnswered_IsNotLost) {
    bus::BoardItem bare;
    bare.board = "lab-usb-140-3";
    bare.state = "lost";
    bare.reason = "silent";
    bare.state_age = 60;
    const std::string amber = "\033[33mno ASIP sketch yet";
    EXPECT_THAT(boards_text({bare}, Output::kTable, 0, true), HasSubstr(amber));
    EXPECT_THAT(boards_text({bare}, Output::kWide, 0, true), HasSubstr(amber));
    auto silent = uno1();
    silent.state = "lost";
    silent.reason = "silent";
    silent.state_age = 60;
    EXPECT_THAT(boards_text({silent}, Output::kTable, 0, false),
                HasSubstr("lost 60 s ago: the board answers nothing"));
    bare.reason = "agent-gone";
    EXPECT_THAT(boards_text({bare}, Output::kTable, 0, false), HasSubstr("lost 60 s ago"));
}

TEST(ListBoards, NamesThatStrangersMade_MoveNoCursor) {
    auto board = uno1();
    board.board = "küche\033[2J";
    EXPECT_EQ(boards_text({board}, Output::kName, 0, false), "küche?[2J\n");
    bus::ServiceItem service;
    service.board = board.board;
    service.name = "ser\rvo";
    EXPECT_EQ(services_text({service}, Output::kName, 0, false), "küche?[2J/ser?vo\n");
}

TEST(ListBoards, BriefRows_SayWhatWholeItemsSay) {
    auto lost = uno1();
    lost.board = "küche\033[31m";
    lost.state = "lost";
    lost.age = -1;
    lost.conflict = bus::Conflict{"a", "b", "elsewhere"};
    const std::vector<bus::BoardItem> boards{uno1(), lost};
    const auto rows = bus::brief_of(boards);
    EXPECT_EQ(brief_text(rows, Output::kTable, 0, false),
              "BOARD       STATE   CHIP        SKETCH     SERVICES             ANNOUNCED\n"
              "uno1        online  ATmega328P  AsipHello  io distance servo X  500 ms ago\n"
              "küche?[31m  lost!   ATmega328P  AsipHello  io distance servo X  -\n");
    EXPECT_EQ(brief_text(rows, Output::kTable, 0, false), boards_text(boards, Output::kTable, 0, false));
    EXPECT_EQ(brief_text(bus::brief_of({boards.data(), 1}), Output::kName, 0, false), "uno1\n");
    EXPECT_EQ(brief_text({}, Output::kTable, 0, false), "");
}

TEST(SortList, EachKey_OrdersAndKeepsNamesWithin) {
    auto boards = [] {
        bus::BriefRows rows;
        rows.add({"b", "online", 9, "", "", "io", false});
        rows.add({"a", "online", -1, "", "", "io", false});
        rows.add({"c", "lost", 0.5, "", "", "io", false});
        return rows;
    }();
    const auto names = [&boards] {
        std::string text;
        for (const auto& board : boards.rows())
            text += board.board;
        return text;
    };
    sort_list(boards, "state", false);
    EXPECT_EQ(names(), "cab");
    sort_list(boards, "announced", false);
    EXPECT_EQ(names(), "cba") << "never announced comes last";
    sort_list(boards, "name", true);
    EXPECT_EQ(names(), "cba");
    sort_list(boards, "name", false);
    EXPECT_EQ(names(), "abc");
}

TEST(ListServices, CountPeriodAndNames_AreShown) {
    const auto services = uno1().services;
    EXPECT_THAT(services_text(services, Output::kTable, 0, false),
                HasSubstr("uno1   distance  distance  Distance           2  100 ms  online\n"));
    EXPECT_THAT(services_text(services, Output::kName, 0, false), HasSubstr("uno1/servo\n"));
}

TEST(ShowBoard, DescribedBoard_ShowsChipPinsServicesAndUnits) {
    const KnownBoard board{uno1(), *model::parse_description(kUno1)};
    const auto text = board_text(board, model::ModelSet::standard(), 0, false);
    EXPECT_THAT(text, HasSubstr("serial /dev/ttyACM0 at 500000 baud"));
    EXPECT_THAT(text, HasSubstr("14 (A0)  analog"));
    EXPECT_THAT(text, HasSubstr("write    servo 0..255, angle 0..180 degrees  Turn a servo to an angle"));
    EXPECT_THAT(text, HasSubstr("distance 0..400 cm"));
    EXPECT_THAT(text, HasSubstr("2 sensors"));
    EXPECT_THAT(text, HasSubstr("none known: events come as tag and body"));
}

TEST(ShowBoard, WithoutFirmware_HasNoExtensionsToSpeakOf) {
    auto description = *model::parse_description(kUno1);
    EXPECT_THAT(board_text({uno1(), description}, model::ModelSet::standard(), 0, false),
                HasSubstr("extensions "));
    description.firmware = {};
    description.link = {"world", "track.json", 0};
    const auto text = board_text({uno1(), description}, model::ModelSet::standard(), 0, false);
    EXPECT_THAT(text, Not(HasSubstr("extensions")));
    EXPECT_THAT(text, HasSubstr("firmware   none: it is no board"));
    EXPECT_THAT(text, HasSubstr("link       world track.json"));
}

TEST(ShowBoard, NeverHeardWhileARegistryLooked_HasNoGapInItsTimes) {
    auto item = uno1();
    item.age = -1;
    item.first_seen = item.since = text::WallTime(std::chrono::milliseconds(1000));
    const auto text = board_text({item, std::nullopt}, model::ModelSet::standard(), 0, false);
    EXPECT_THAT(text, HasSubstr("announced  first 1970-01-01T00:00:01.000Z, online since 1970"));
}

TEST(ShowBoard, AnswerOfAHostileRegistry_CannotMoveTheCursor) {
    bus::BoardItem item;
    item.board = "\x1b[2Jesp";
    item.state = "on\x1bline";
    item.services.resize(1);
    item.services.front().name = "\x1b]0;title\x07";
    const auto text = board_text({item, std::nullopt}, model::ModelSet::standard(), 0, false);
    EXPECT_EQ(text.find_first_of("\x1b\x07"), std::string::npos) << text;
    EXPECT_THAT(text, HasSubstr("?[2Jesp/?]0;title?"));
}

TEST(ShowBoard, NamesOnly_IsShown) {
    bus::BoardItem item;
    item.board = "esp";
    item.state = "online";
    item.names_only = true;
    EXPECT_THAT(board_text({item, std::nullopt}, model::ModelSet::standard(), 0, false),
                HasSubstr("its names only"));
}

TEST(PingSummary, LossAndPercentiles_AreCounted) {
    PingSummary summary;
    summary.board = "uno1";
    summary.sent = 4;
    for (const double ms : {1.0, 2.0, 3.0})
        summary.milliseconds.add(ms);
    EXPECT_EQ(summary.text(),
              "\nuno1: 4 sent, 3 answered, 25 % lost\n"
              "round trip: minimum 1.00, p50 2.00, p99 3.00, maximum 3.00 ms\n");
    EXPECT_EQ(summary.json()["loss_percent"], 25.0);
}

TEST(PinRecords, OwnersAndCapabilities_AreWords) {
    const auto records = pin_records(*model::parse_description(kUno1));
    ASSERT_EQ(records.size(), 20U);
    EXPECT_EQ(records[9]["owner"], "servo");
    EXPECT_EQ(records[9]["mode"], "other-service");
    EXPECT_EQ(records[14]["channel"], 0);
    EXPECT_EQ(records[3]["can"].dump(), R"(["digital","pwm"])");
}

TEST(UseColour, TerminalNoColorAndChoice_Decide) {
    const auto none = [](const std::string&) { return std::optional<std::string>(); };
    const auto no_color = [](const std::string& name) {
        return std::optional<std::string>(name == "NO_COLOR" ? "1" : "xterm");
    };
    const auto of = [](const std::string& term) {
        return
            [term](const std::string& name) { return name == "TERM" ? std::optional(term) : std::nullopt; };
    };
    EXPECT_TRUE(use_colour(ColourChoice::kAuto, true, of("xterm")));
    EXPECT_FALSE(use_colour(ColourChoice::kAuto, false, of("xterm")));
    EXPECT_FALSE(use_colour(ColourChoice::kAuto, true, no_color));
    EXPECT_FALSE(use_colour(ColourChoice::kAuto, true, of("dumb")));
    EXPECT_FALSE(use_colour(ColourChoice::kAuto, true, of("")));
    EXPECT_FALSE(use_colour(ColourChoice::kAuto, true, none)) << "nothing says what it can";
    EXPECT_TRUE(use_colour(ColourChoice::kAlways, false, no_color));
    EXPECT_FALSE(use_colour(ColourChoice::kNever, true, of("xterm")));
}

}  // namespace
}  // namespace asip::cli
