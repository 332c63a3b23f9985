// SPDX-License-Identifier: Apache-2.0
// What is ours in the AsipEsp example, on this computer: the library on a fake Arduino core, the bus on a
// real broker.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <deque>
#include <memory>
#include <nlohmann/json.hpp>

#include "firmware/examples/AsipEsp/BusMember.h"
#include "firmware/examples/AsipEsp/NetworkLine.h"
#include "firmware/examples/AsipEsp/NewestClient.h"
#include "socket_client.hpp"
#include "tests/support/bus_probe.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/mosquitto_broker.hpp"

namespace asip::firmware {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using test::wait_until;
using testing::ElementsAre;

constexpr const char* kServices[] = {"io", "servo"};

/// The sketch's loop, as often as a wait looks.
class NetworkBoard {
  public:
    explicit NetworkBoard(std::uint16_t broker_port)
        : port_(broker_port), member_(client_, {"esp1", kServices, 2}, networkLine::giveLines) {
        static bool begun = false;
        current_ = this;
        networkLine::sink = [](const char* line, std::uint16_t length) {
            if (current_ != nullptr) current_->member_.publishLine(line, length);
        };
        // There is one board, as on a chip.
        if (!begun) board.begin(F("AsipEsp"));
        begun = true;
        ask_quietly();
    }
    ~NetworkBoard() { current_ = nullptr; }

    void loop() {
        arduino.microseconds = static_cast<unsigned long>(
            std::chrono::duration_cast<std::chrono::microseconds>(Clock::now().time_since_epoch()).count());
        member_.poll("127.0.0.1", port_, static_cast<std::uint32_t>(millis()));
        for (int i = 0; i < 50; ++i)
            board.run();
    }
    bool until(const std::function<bool()>& done, std::chrono::milliseconds limit = test::kDeadline) {
        return wait_until(
            [&] {
                loop();
                return done();
            },
            limit);
    }
    /// As if its power went.
    void cut() { client_.stop(); }
    BusMember& member() { return member_; }

  private:
    void ask_quietly() {
        networkLine::giveLines(reinterpret_cast<const std::uint8_t*>("I,A,0"), 5);
        for (int i = 0; i < 100; ++i)
            board.run();
    }

    inline static NetworkBoard* current_ = nullptr;
    std::uint16_t port_;
    SocketClient client_;
    BusMember member_;
};

class NetworkMemberTest : public testing::Test {
  protected:
    bool online() {
        return esp.until([&] { return probe.last("asip/servicebus/esp1/$state") == "online"; });
    }
    std::vector<std::string> payloads(const std::string& topic) {
        std::vector<std::string> all;
        for (const auto& message : probe.messages(topic))
            all.push_back(message.payload);
        return all;
    }

    test::MosquittoBroker broker;
    test::BusProbe probe{broker.port()};
    NetworkBoard esp{broker.port()};
};

TEST_F(NetworkMemberTest, Start_AnnouncesNamesAndState) {
    ASSERT_TRUE(online());
    ASSERT_TRUE(esp.until([&] { return probe.count("asip/servicebus/esp1") == 2; }));
    EXPECT_THAT(payloads("asip/servicebus"), ElementsAre("esp1"));
    EXPECT_THAT(payloads("asip/servicebus/esp1"), ElementsAre("io", "servo"));
    test::BusProbe late(broker.port());
    EXPECT_TRUE(esp.until([&] { return late.last("asip/servicebus/esp1/$state") == "online"; }))
        << "retained";
}

TEST_F(NetworkMemberTest, Probe_IsAnsweredByTheNamesAtMostTwiceASecond) {
    ASSERT_TRUE(online());
    probe.clear();
    probe.publish("asip/servicebus/$probe", "somebody-else");
    for (int i = 0; i < 50; ++i)
        probe.publish("asip/servicebus/$probe", i % 2 == 0 ? "" : "esp1");
    ASSERT_TRUE(esp.until([&] { return probe.count("asip/servicebus") >= 1; }));
    const auto end = Clock::now() + 600ms;
    esp.until([&] { return Clock::now() >= end; });
    EXPECT_LE(probe.count("asip/servicebus"), 2u);
}

TEST_F(NetworkMemberTest, RequestsOfAMessage_AreAnsweredOneLineAMessage) {
    ASSERT_TRUE(online());
    probe.publish("asip/esp1/in", "#,?\r\nI,P,13,3\n#,E,abc");
    ASSERT_TRUE(esp.until([&] { return probe.count("asip/esp1/out") >= 2; }));
    EXPECT_THAT(payloads("asip/esp1/out"), ElementsAre("@#,?,0,4,Arduino,22,AsipEsp", "@#,E,abc"));
    probe.publish("asip/esp1/in", "I,d,13,1");
    EXPECT_TRUE(esp.until([&] { return arduino.levels[13]; }));
    probe.publish("asip/esp1/in", "Z,x");
    EXPECT_TRUE(esp.until([&] { return probe.last("asip/esp1/out") == "~Z,?,1{INVALID_SERVICE}"; }));
    probe.publish("asip/esp1/in", "I,M");
    EXPECT_TRUE(esp.until([&] { return probe.last("asip/esp1/out")->starts_with("@I,M,22,{0:1,"); }))
        << "a long line";
}

TEST_F(NetworkMemberTest, WhatCannotBeTaken_ChangesNothingAndTheNextWorks) {
    ASSERT_TRUE(online());
    probe.publish("asip/esp1/in", std::string(5000, 'x'));
    probe.publish("asip/esp1/in", "");
    probe.publish("asip/esp1/in", std::string(300, 'y'));
    probe.publish("asip/esp1/in", "#,E,next");
    EXPECT_TRUE(esp.until([&] { return probe.last("asip/esp1/out") == "@#,E,next"; }));
    EXPECT_TRUE(esp.member().isOnline());
}

TEST(NetworkMemberStartTest, StoredRequest_IsNotExecuted) {
    test::MosquittoBroker broker;
    test::BusProbe probe(broker.port());
    probe.publish("asip/esp1/in", "#,E,stored", true);
    ASSERT_TRUE(wait_until([&] { return probe.all_acknowledged(); }));
    NetworkBoard esp(broker.port());
    ASSERT_TRUE(esp.until([&] { return esp.member().refused() == 1; }));
    probe.publish("asip/esp1/in", "#,E,fresh");
    ASSERT_TRUE(esp.until([&] { return probe.count("asip/esp1/out") >= 1; }));
    EXPECT_EQ(probe.last("asip/esp1/out"), "@#,E,fresh");
}

TEST_F(NetworkMemberTest, ConnectionThatIsCut_LeavesTheWillAndComesBack) {
    ASSERT_TRUE(online());
    esp.cut();
    EXPECT_TRUE(wait_until([&] { return probe.last("asip/servicebus/esp1/$state") == "lost"; }));
    EXPECT_TRUE(online());
}

TEST(NetworkMemberBrokerTest, BrokerThatComesLate_IsFound) {
    test::MosquittoBroker broker;
    broker.stop();
    NetworkBoard esp(broker.port());
    esp.loop();
    EXPECT_FALSE(esp.member().isOnline());
    broker.start();
    EXPECT_TRUE(esp.until([&] { return esp.member().isOnline(); }, 20s));
}

TEST_F(NetworkMemberTest, RegistryAndAsipctl_ListTheBoardAndItsServices) {
    test::ChildProcess registry({ASIP_PROGRAMS "/asip-registry", "--broker", broker.url(), "--id", "r1"});
    ASSERT_TRUE(online());
    nlohmann::json found;
    std::optional<std::string> reply;
    const auto listed = [&] {
        probe.publish("asip/registry/query",
                      R"({"find":"boards","board":"esp1","full":true,"id":"1","reply_to":"me/answers"})");
        const auto last = probe.last("me/answers");
        if (!last) return false;
        found = nlohmann::json::parse(*last);
        return found["items"].size() == 1 && found["items"][0].value("state", "") == "online" &&
               found["items"][0].dump().find("servo") != std::string::npos;
    };
    ASSERT_TRUE(esp.until(listed)) << found;
    test::ChildProcess list({ASIP_PROGRAMS "/asipctl", "--broker", broker.url(), "list"});
    EXPECT_TRUE(esp.until([&] { return !list.running(); }));
    EXPECT_EQ(list.wait_exit(), 0);  // all of its output is read
    EXPECT_THAT(list.output(), testing::AllOf(testing::HasSubstr("esp1"), testing::HasSubstr("online")))
        << list.errors();
}

TEST(NewestClientTest, NewerClient_TakesThePlaceOfTheOlderAndSilenceEndsIt) {
    /// As the classes of the cores, which share what they copy.
    struct Tcp {
        std::shared_ptr<std::deque<char>> in = std::make_shared<std::deque<char>>();
        std::shared_ptr<std::string> out = std::make_shared<std::string>();
        std::shared_ptr<bool> open = std::make_shared<bool>(false);
        int available() { return *open ? static_cast<int>(in->size()) : 0; }
        int read() {
            const char c = in->front();
            in->pop_front();
            return static_cast<unsigned char>(c);
        }
        void stop() { *open = false; }
        bool connected() { return *open; }
        std::size_t write(const std::uint8_t* bytes, std::size_t size) {
            out->append(reinterpret_cast<const char*>(bytes), size);
            return size;
        }
    };
    std::string given;
    bool room = true;
    const auto taker = [&](const std::uint8_t* bytes, std::uint16_t size) {
        if (room) given.append(reinterpret_cast<const char*>(bytes), size);
        return room;
    };
    NewestClient<Tcp> tcp;
    Tcp first, second;
    *first.open = *second.open = true;
    tcp.take(first, 0);
    first.in->assign({'a', 'b'});
    tcp.poll(taker, 10);
    EXPECT_EQ(given, "ab");
    tcp.take(second, 20);
    EXPECT_FALSE(*first.open);
    room = false;
    second.in->assign({'c', 'd'});
    tcp.poll(taker, 30);
    room = true;
    tcp.poll(taker, 40);
    EXPECT_EQ(given, "abcd") << "what found no room waited";
    tcp.write("@x\n", 3);
    EXPECT_EQ(*second.out, "@x\n");
    tcp.poll(taker, 30'029);
    EXPECT_TRUE(*second.open);
    tcp.poll(taker, 30'040);
    EXPECT_FALSE(*second.open);
}

}  // namespace
}  // namespace asip::firmware
