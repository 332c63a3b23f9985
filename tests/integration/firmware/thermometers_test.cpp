// SPDX-License-Identifier: Apache-2.0
// Thermometers and other devices on a 1-Wire bus: found, measured, and what happens when they fail.
#include <gtest/gtest.h>

#include <algorithm>

#include "firmware_board.hpp"
#include "sim/parts/one_wire_device.hpp"

namespace asip::firmware {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

std::string id_of(std::uint64_t number) {
    std::string text;
    for (const auto byte : sim::Ds18b20::id_of(number)) {
        char digits[3];
        std::snprintf(digits, sizeof digits, "%02X", byte);
        text += digits;
    }
    return text;
}

sim::PartConfig wire(const std::vector<std::pair<std::uint64_t, double>>& devices, bool parasite = false) {
    auto list = json::array();
    for (const auto& [number, degrees] : devices)
        list.push_back({{"number", number}, {"temperature", degrees}});
    return {"ds18b20", {{"pin", 2}, {"devices", list}, {"parasite", parasite}}, "wire"};
}

// Found in the order of their bits, the lowest first: 2 is 01.., 1 is 10.., 3 is 11...
const std::vector<std::pair<std::uint64_t, double>> kThree = {{1, 21.5}, {2, -10.125}, {3, 25.0625}};

class ThermometerBoard : public FirmwareBoard {
  public:
    explicit ThermometerBoard(std::vector<sim::PartConfig> parts = {wire(kThree)},
                              const std::string& kind = "uno", std::uint32_t frequency = 16'000'000)
        : FirmwareBoard("asip_" + kind + "_onewire", kind == "mini8" ? "uno" : kind, std::move(parts),
                        frequency) {
        sim().run_for(500ms);  // they were found
    }
    ~ThermometerBoard() {
        const auto state = sim().part("wire").state();
        EXPECT_EQ(state.find("out of time"), std::string::npos) << state;
        if (!restarts_) {
            EXPECT_EQ(state.find("cut short"), std::string::npos) << state;
        }
    }

    std::string later(const std::string& request) {
        const auto at_once = ask(request);
        return at_once.empty() ? next_line(4000ms) : at_once;
    }
    void tell(const std::string& verb, const std::string& argument = "") {
        const auto done = sim().part("wire").command(verb, argument);
        ASSERT_TRUE(done) << done.error();
    }
    /// All pins are let go, whatever their service is about: a reset of the wire may be cut short.
    void restart() {
        restarts_ = true;
        ask("#,R");
    }

  private:
    bool restarts_ = false;
};

TEST(ThermometersTest, AllOnTheWire_AreFoundAndNamedByTheirIds) {
    ThermometerBoard board;
    EXPECT_EQ(board.ask("#,N"), "@#,N,3,{I:ASIP core IO,K:Thermometers,O:OneWire}");
    EXPECT_EQ(board.ask("#,S"), "@#,S,20,{@,@,K,I,I,I,I,I,I,I,I,I,I,I,I,I,I,I,I,I}");
    EXPECT_EQ(board.ask("K,I"), "@K,I,3,{" + id_of(2) + "," + id_of(1) + "," + id_of(3) + "}");
    EXPECT_EQ(board.later("K,M"), "@K,e,3,{-10.12,21.50,25.06}");
}

TEST(ThermometersTest, EveryTemperature_IsReadBitForBit) {
    ThermometerBoard board;
    // Those of the table in the data sheet, and others.
    for (const double degrees :
         {125.0, 85.0, 25.0625, 10.125, 0.5, 0.0, -0.5, -10.125, -25.0625, -55.0, 0.0625}) {
        board.tell("set", "0=" + std::to_string(degrees));
        const auto line = board.later("K,M");
        double read = 999;
        ASSERT_EQ(std::sscanf(line.c_str(), "@K,e,3,{-10.12,%lf,25.06}", &read), 1) << line;
        EXPECT_NEAR(read, degrees, 0.0101) << line;
    }
    EXPECT_EQ(board.ask("K,E"), "@K,E,3,{0:0,0:0,0:0}");
}

TEST(ThermometersTest, MaximumNumber_IsFoundWhateverTheirIds) {
    std::vector<std::pair<std::uint64_t, double>> many;
    for (std::uint64_t i = 0; i < 8; ++i)
        many.emplace_back((i * 0x9E3779B97F4Au) & 0xffffffffffffu, static_cast<double>(i));
    ThermometerBoard board({wire(many)});
    const auto list = board.ask("K,I");
    for (const auto& [number, degrees] : many)
        EXPECT_NE(list.find(id_of(number)), std::string::npos) << list;
    auto line = board.later("K,M");
    for (const auto& [number, degrees] : many)
        EXPECT_NE(line.find(std::to_string(static_cast<int>(degrees)) + ".00"), std::string::npos) << line;
}

TEST(ThermometersTest, MoreThanThereIsRoomFor_AreLeftOut) {
    std::vector<std::pair<std::uint64_t, double>> many;
    for (std::uint64_t i = 0; i < 9; ++i)
        many.emplace_back(i, 20.0);
    ThermometerBoard board({wire(many)});
    EXPECT_EQ(board.ask("K,I").substr(0, 6), "@K,I,8");
    EXPECT_EQ(board.later("K,M").substr(0, 7), "@K,e,8,");
}

TEST(ThermometersTest, Reports_ComeAtTheirPeriod) {
    ThermometerBoard board;
    EXPECT_EQ(board.ask("K,A,1000"), "");
    const auto lines = board.lines_within(5500ms);
    EXPECT_NEAR(static_cast<double>(lines.size()), 5, 1);
    for (const auto& line : lines)
        EXPECT_EQ(line, "@K,e,3,{-10.12,21.50,25.06}");
}

TEST(ThermometersTest, ThermometerThatIsPulledOut_HasNoValueUntilItIsBack) {
    ThermometerBoard board;
    board.tell("detach", "0");
    EXPECT_EQ(board.later("K,M"), "@K,e,3,{-10.12,,25.06}");
    EXPECT_EQ(board.ask("K,E"), "@K,E,3,{0:0,0:1,0:0}");
    board.tell("attach", "0");
    EXPECT_EQ(board.later("K,M"), "@K,e,3,{-10.12,21.50,25.06}");
}

TEST(ThermometersTest, ThermometerThatLostItsPowerMeanwhile_DoesNotSay85) {
    ThermometerBoard board;
    board.ask("K,M");
    board->run_for(400ms);
    board.tell("detach", "1");
    board.tell("attach", "1");
    EXPECT_EQ(board.next_line(4000ms), "@K,e,3,{,21.50,25.06}");
    EXPECT_EQ(board.later("K,M"), "@K,e,3,{-10.12,21.50,25.06}");
}

TEST(ThermometersTest, DamagedAnswer_IsNoValueAndCounted) {
    ThermometerBoard board;
    board.tell("damage", "2=2");
    EXPECT_EQ(board.later("K,M"), "@K,e,3,{-10.12,21.50,}");
    EXPECT_EQ(board.later("K,M"), "@K,e,3,{-10.12,21.50,}");
    EXPECT_EQ(board.later("K,M"), "@K,e,3,{-10.12,21.50,25.06}");
    EXPECT_EQ(board.ask("K,E"), "@K,E,3,{0:0,0:0,2:0}");
}

TEST(ThermometersTest, NewThermometer_IsFoundBehindTheOthers) {
    ThermometerBoard board;
    board.tell("detach", "1");
    board.ask("#,R");
    board->run_for(500ms);
    EXPECT_EQ(board.ask("K,I"), "@K,I,2,{" + id_of(1) + "," + id_of(3) + "}");
    board.tell("attach", "1");
    EXPECT_EQ(board.later("K,S"), "@K,I,3,{" + id_of(1) + "," + id_of(3) + "," + id_of(2) + "}");
    EXPECT_EQ(board.later("K,M"), "@K,e,3,{21.50,25.06,-10.12}");
}

TEST(ThermometersTest, NoThermometer_IsAnErrorUntilOneIsThere) {
    ThermometerBoard board({wire({{7, 19}})});
    board.tell("detach", "0");
    board.ask("#,R");
    board->run_for(500ms);
    EXPECT_EQ(board.ask("K,I"), "@K,I,0,{}");
    EXPECT_EQ(board.later("K,M"), "~K,e,8{DEVICE_NOT_AVAILABLE}");
    EXPECT_EQ(board.ask("K,A,1000"), "");
    EXPECT_EQ(board.next_line(5000ms), "(none)");
    board.tell("attach", "0");
    EXPECT_EQ(board.next_line(4000ms), "@K,e,1,{19.00}");
}

TEST(ThermometersTest, SearchAndMeasurementAtOnce_AreBothAnswered) {
    ThermometerBoard board;
    const std::string ids = "@K,I,3,{" + id_of(2) + "," + id_of(1) + "," + id_of(3) + "}";
    board->send("K,S\nK,M\n");
    EXPECT_EQ(board.next_line(4000ms), ids);
    EXPECT_EQ(board.next_line(4000ms), "@K,e,3,{-10.12,21.50,25.06}");
    board->send("K,M\n");
    board->run_for(100ms);
    board->send("K,S\n");
    EXPECT_EQ(board.next_line(4000ms), "@K,e,3,{-10.12,21.50,25.06}");
    EXPECT_EQ(board.next_line(4000ms), ids);
}

TEST(ThermometersTest, PeriodThatIsSetDuringTheFirstSearch_IsKept) {
    ThermometerBoard board;
    board.ask("#,R");
    EXPECT_EQ(board.ask("K,A,1000"), "");
    EXPECT_EQ(board.next_line(4000ms), "@K,e,3,{-10.12,21.50,25.06}");
}

TEST(ThermometersTest, WireThatIsShorted_IsAnErrorAndTheBoardGoesOn) {
    ThermometerBoard board;
    board.tell("short");
    EXPECT_EQ(board.later("K,M"), "@K,e,3,{,,}");
    EXPECT_EQ(board.ask("#,E,here"), "@#,E,here");
    EXPECT_EQ(board.later("O,R"), "~O,R,8{DEVICE_NOT_AVAILABLE}");
    board.tell("unshort");
    EXPECT_EQ(board.later("K,M"), "@K,e,3,{-10.12,21.50,25.06}");
}

// The line rises after the board looked at each bit, and before its next one.
TEST(ThermometersTest, LineThatRisesTooLate_EndsTheSearchAndFreesTheWire) {
    ThermometerBoard board;
    bool weak = true, held = false;
    sim::SimTime fell{};
    board->on_pin(2, [&](sim::Level level) {
        if (!weak || held || level == sim::Level::kHigh) return;
        held = true;
        fell = board->now();
        board->drive(2, sim::Level::kLow);
    });
    const auto rises = [&] {
        if (held && board->now() - fell > 20us) {
            board->drive(2, sim::Level::kHigh);
            held = false;
        }
        return false;
    };
    board->send("K,S\n");
    board->run_until(rises, 500ms);
    EXPECT_EQ(board.next_line(0ms), "@K,I,3,{" + id_of(2) + "," + id_of(1) + "," + id_of(3) + "}");
    weak = false;
    board->drive(2, sim::Level::kHigh);
    EXPECT_EQ(board.later("O,R"), "@O,R,1");
    EXPECT_EQ(board.later("K,M"), "@K,e,3,{-10.12,21.50,25.06}");
}

TEST(ThermometersTest, ParasitePower_IsSaid) {
    ThermometerBoard board({wire(kThree, true)});
    EXPECT_EQ(board.ask("K,A,1000"), "");
    EXPECT_EQ(board.next_line(5000ms), "(none)");
    EXPECT_EQ(board.later("K,M"), "~K,e,4{MODE_UNAVAILABLE}");
    EXPECT_EQ(board.ask("K,I").substr(0, 6), "@K,I,3");
}

TEST(ThermometersTest, BadRequests_AreReported) {
    ThermometerBoard board;
    for (const char tag : {'M', 'I', 'E', 'S'}) {
        const std::string start = std::string("K,") + tag;
        EXPECT_EQ(board.ask(start + ",1"), "~" + start + ",11{BAD_ARGUMENT}");
    }
    EXPECT_EQ(board.ask("K,A"), "~K,A,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("K,x"), "~K,x,2{UNKNOWN_REQUEST}");
    EXPECT_EQ(board.later("K,M"), "@K,e,3,{-10.12,21.50,25.06}");
}

TEST(ThermometersTest, RestartInTheMiddle_BeginsAnew) {
    ThermometerBoard board;
    for (int i = 0; i < 12; ++i) {
        board.ask("K,M");
        board->run_for(i < 6 ? 1ms * i : 740ms + 3ms * i);
        board.restart();
        board->run_for(500ms);
        board->take_output();
        ASSERT_EQ(board.later("K,M"), "@K,e,3,{-10.12,21.50,25.06}") << i;
    }
}

// Devices may take what was left of the reset for a whole one, and pull the line down: the next one begins
// behind that.
TEST(ThermometersTest, RestartInTheMiddleOfAReset_LetsDevicesFinish) {
    ThermometerBoard board;
    for (int i = 0; i < 10; ++i) {
        board->send("#,R\n");
        board->run_for(100us * i);
        board.restart();
        board->run_for(500ms);
        board->take_output();
        ASSERT_EQ(board.later("K,M"), "@K,e,3,{-10.12,21.50,25.06}") << i;
    }
    EXPECT_NE(board.sim().part("wire").state().find("cut short"), std::string::npos) << "the test cut none";
}

TEST(ThermometersTest, RequestsAt1000000BaudMeanwhile_LoseNoByteAndDamageNoAnswer) {
    ThermometerBoard board;
    board.step_up(1000000);
    board.ask("K,A,1000");
    int reports = 0, answers = 0, sent = 0;
    for (int i = 0; i < 2000; ++i) {
        for (int k = 0; k < 8; ++k, ++sent)
            board->send("Z,x\n");
        for (const auto& line : board.lines_within(3ms)) {
            reports += line == "@K,e,3,{-10.12,21.50,25.06}";
            answers += line == "~Z,?,1{INVALID_SERVICE}";
        }
    }
    EXPECT_GE(reports, 5);
    EXPECT_EQ(answers, sent);
    EXPECT_EQ(board->line_errors().receive_overruns, 0u);
    EXPECT_EQ(board.ask("K,E").find("1"), std::string::npos);
}

TEST(OneWireTest, Devices_AreFoundOneByOne) {
    ThermometerBoard board;
    EXPECT_EQ(board.later("O,R"), "@O,R,1");
    EXPECT_EQ(board.later("O,S,0"), "@O,S," + id_of(2));
    EXPECT_EQ(board.later("O,S,1"), "@O,S," + id_of(1));
    EXPECT_EQ(board.later("O,S,2"), "@O,S," + id_of(3));
    EXPECT_EQ(board.later("O,S,3"), "@O,S,");
}

TEST(OneWireTest, Transfer_WritesAndReads) {
    ThermometerBoard board({wire({{7, 19}})});
    EXPECT_EQ(board.later("O,T,8,33"), "@O,T," + id_of(7));
    EXPECT_EQ(board.later("O,T,1,ccb4"), "@O,T,FF");
    EXPECT_EQ(board.later("O,T,0,CC4E0102"), "@O,T,");
    EXPECT_EQ(board.later("O,t,0,7F"), "@O,t,") << "goes on where the transfer ended";
    EXPECT_EQ(board.later("O,T,9,55" + id_of(7) + "BE").substr(0, 15), "@O,T,500501027F");
    board.tell("detach", "0");
    EXPECT_EQ(board.later("O,R"), "@O,R,0");
    EXPECT_EQ(board.later("O,T,8,33"), "~O,T,8{DEVICE_NOT_AVAILABLE}");
    EXPECT_EQ(board.later("O,S,0"), "@O,S,");
}

TEST(OneWireTest, MostBytesBothWays_AreWrittenAndRead) {
    ThermometerBoard board({wire({{7, 19}})});
    const auto read = "55" + id_of(7) + "BE";
    const auto scratchpad = board.later("O,T,9," + read).substr(5);
    ASSERT_EQ(scratchpad.size(), 18u);
    // What is read during the last six bytes that are written is not kept, and nobody sends behind the nine.
    EXPECT_EQ(board.later("O,T,16," + read + std::string(12, 'F')),
              "@O,T," + scratchpad.substr(12) + std::string(26, 'F'));
}

TEST(OneWireTest, RequestsOfTwoPrograms_AreAnsweredInTurn) {
    ThermometerBoard board({wire({{7, 19}})});
    for (int i = 0; i < 3; ++i) {
        board->send("O,R\nO,T,8,33\nO,S,0\nO,T,1,CCB4\nO,R\n");
        for (const auto& expected : {std::string("@O,R,1"), "@O,T," + id_of(7), "@O,S," + id_of(7),
                                     std::string("@O,T,FF"), std::string("@O,R,1")})
            EXPECT_EQ(board.next_line(), expected);
    }
}

TEST(OneWireTest, ThermometersBesideIt_AreNotDisturbed) {
    ThermometerBoard board;
    board.ask("K,A,1000");
    int reports = 0, ids = 0;
    for (int i = 0; i < 60; ++i) {
        board->send("O,S,1\n");
        for (const auto& line : board.lines_within(100ms)) {
            reports += line == "@K,e,3,{-10.12,21.50,25.06}";
            ids += line == "@O,S," + id_of(1);
        }
    }
    EXPECT_EQ(ids, 60);
    EXPECT_GE(reports, 4);
}

TEST(OneWireTest, BadRequests_AreReported) {
    ThermometerBoard board;
    for (const char* request : {"O,R,1", "O,S", "O,S,256", "O,T", "O,T,17,CC", "O,T,1,C", "O,T,1,CX",
                                "O,T,x,CC", "O,T,1,000102030405060708090A0B0C0D0E0F10"})
        EXPECT_EQ(board.ask(request), "~" + std::string(request).substr(0, 3) + ",11{BAD_ARGUMENT}")
            << request;
    EXPECT_EQ(board.ask("O,x"), "~O,x,2{UNKNOWN_REQUEST}");
    EXPECT_EQ(board.later("O,R"), "@O,R,1");
}

TEST(OneWireTest, OtherBoards_KeepTheTimes) {
    ThermometerBoard mega({wire(kThree)}, "mega");
    EXPECT_EQ(mega.later("K,M"), "@K,e,3,{-10.12,21.50,25.06}");
    ThermometerBoard slow({wire(kThree)}, "mini8", 8'000'000);
    EXPECT_EQ(slow.later("K,M"), "@K,e,3,{-10.12,21.50,25.06}");
}

}  // namespace
}  // namespace asip::firmware
