// SPDX-License-Identifier: Apache-2.0
// What each message of the bus is, by its topic and the members of its envelope.
#include "agent/inbound/inbound.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "agent/inbound/command_age.hpp"
#include "asip/protocol/board_info.hpp"
#include "tests/support/words.hpp"

namespace asip::agent {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr Time kReadAt{1h};
constexpr Duration kUsualDeadline = session::kDefaultDeadline;

/// A board with servos (the model has no command "renew") and a service Q that no model describes.
session::ServiceTable two_services() {
    session::Identity identity;
    identity.services = {{'S', {}}, {'Q', {}}};
    return {identity, model::ModelSet::standard()};
}

struct InboundTest : testing::Test {
    std::optional<Inbound> read(const mqtt::Message& message) const {
        return read_inbound(
            message, {.topics = topics, .board = "uno1", .services = table, .client_side = client_side}, age,
            kReadAt);
    }
    std::optional<Inbound> read(const std::string& topic, const std::string& payload,
                                bool retained = false) const {
        mqtt::Message message{.topic = topic, .payload = payload, .retain = retained};
        return read(message);
    }
    /// The message as the kind that it must be.
    template <class Kind>
    Kind as(const std::string& topic, const std::string& payload, bool retained = false) const {
        const auto inbound = read(topic, payload, retained);
        if (!inbound || !std::holds_alternative<Kind>(*inbound)) {
            ADD_FAILURE() << topic << ' ' << payload.substr(0, 100) << ": kind "
                          << (inbound ? static_cast<int>(inbound->index()) : -1);
            return Kind{};
        }
        return std::get<Kind>(*inbound);
    }

    bus::Topics topics;
    session::ServiceTable table = two_services();
    CommandAge age{[] { return std::uint64_t{7}; }};
    bool client_side = false;
};

TEST_F(InboundTest, EachTopic_IsItsKind) {
    EXPECT_EQ(as<Command>("asip/uno1/in", "I,M\n").envelope.text, "I,M\n");
    EXPECT_EQ(as<Command>("asip/uno1/servo/in", "W,0,90").service, "servo");
    EXPECT_EQ(as<Command>("asip/uno1/nothing/in", "W,0,90").service, "nothing");
    EXPECT_EQ(as<Stop>("asip/uno1/$stop", R"({"reply_to":"r","deadline_ms":700})").deadline(),
              kReadAt + 700ms);
    EXPECT_EQ(as<Stop>("asip/uno1/$stop", "").deadline(), kReadAt + kUsualDeadline);
    EXPECT_EQ(as<DemandMessage>("asip/servicebus/uno1/$demand/ann/c1", "{}").demander, "ann/c1");
    for (const std::string left : {"asip/servicebus/uno1/$demand/ann/c1", "asip/uno1/servo/set"})
        EXPECT_EQ(as<Leftover>(left, "{}", true).topic, left);
    EXPECT_EQ(as<LinkRequest>("asip/uno1/$link/ann/c1", "{}").user, "ann");
    EXPECT_FALSE(read("asip/uno1/$link/ann/c1", "{}", true)) << "its agent may not clear it";
    for (const auto* topic :
         {"asip/servicebus/$probe", "asip/servicebus/uno1/$state", "asip/servicebus/uno1/$description"})
        EXPECT_EQ(as<Announcement>(topic, "x").message.payload, "x");
}

TEST_F(InboundTest, TopicsOfOthersAndMalformedOnes_AreNothing) {
    for (const auto& topic : test::words(
             "/ asip asip/ asip/uno1 asip/uno1/ asip/uno1/in/ asip/uno2/in asip/uno1/servo/in/more "
             "asip//in other/uno1/in asip/uno2/$stop asip/uno1/$stop/ asip/uno1/servo/$stop "
             "asip/uno1/servo/out asip/uno1/servo/error asip/uno1/out asip/servicebus asip/servicebus/uno1 "
             "asip/servicebus/uno2/$state asip/servicebus/uno2/$demand/ann/c1 "
             "asip/servicebus/uno1/$demand/ann asip/servicebus/uno1/$stats asip/registry/query"))
        EXPECT_FALSE(read(topic, R"({"renew":true})")) << topic;
    for (const auto& topic :
         {std::string(), std::string("asip/uno1/se rvo/in"), std::string("asip/uno1\0/in", 13)})
        EXPECT_FALSE(read(topic, "I,M")) << topic;
    EXPECT_FALSE(read("asip/uno1/" + std::string(70'000, 'x') + "/in", "I,M"));
}

// --- by its content

TEST_F(InboundTest, Renewal_IsOfOneCommandOrOfAll) {
    EXPECT_EQ(as<Renewal>("asip/uno1/servo/in", R"({"renew":"7"})").id, "7");
    EXPECT_EQ(as<Renewal>("asip/uno1/servo/in", R"({"renew":7})").id, "7");
    const auto all =
        as<Renewal>("asip/uno1/servo/in", R"({"renew":true,"hold_ms":300,"reply_to":"r","id":"x"})");
    EXPECT_FALSE(all.id);
    EXPECT_EQ(all.envelope.hold, 300ms);
    EXPECT_EQ(all.reply().topic, "r");
    EXPECT_EQ(all.service, "servo");
    EXPECT_TRUE(all.fault.empty());
}

TEST_F(InboundTest, RenewalOfNonsense_HasAFault) {
    for (const auto* which : {"false", "null", "[]", "{}", R"(["7"])"})
        EXPECT_THAT(as<Renewal>("asip/uno1/servo/in", std::string(R"({"renew":)") + which + "}").fault,
                    HasSubstr("\"renew\" must be"))
            << which;
}

TEST_F(InboundTest, PortRequest_IsReadOrHasItsFault) {
    const auto release = as<PortRequest>("asip/uno1/in", R"({"port":"release","seconds":9,"by":"ann"})");
    ASSERT_TRUE(release.wanted);
    EXPECT_EQ(release.wanted->time, 9s);
    EXPECT_EQ(release.reply().by, "ann");
    EXPECT_FALSE(as<PortRequest>("asip/uno1/in", R"({"port":"give"})").wanted);
    EXPECT_FALSE(as<PortRequest>("asip/uno1/in", R"({"port":{"labels":{}}})").wanted);
}

TEST_F(InboundTest, LabelRequest_IsReadOrHasItsFault) {
    EXPECT_TRUE(as<LabelRequest>("asip/uno1/in", R"({"labels":{"room":"lab"}})").change);
    EXPECT_TRUE(as<LabelRequest>("asip/uno1/in", R"({"names":{"pins":{"13":"lamp"}}})").change);
    EXPECT_FALSE(as<LabelRequest>("asip/uno1/in", R"({"labels":7})").change);
}

TEST_F(InboundTest, WordsOfAnotherKindInsideACommand_ChangeNothing) {
    for (const auto* payload :
         {R"({"write":[0,90],"id":"renew"})", R"({"write":[0,90],"by":"renew"})",
          R"({"write":[0,90],"reply_to":"renew"})", R"({"write":[0,90],"clock":"renew"})",
          R"({"write":{"renew":true}})", R"({"raw":"W,0,90","renew":true})", R"({"raw":"\"renew\""})",
          R"({"write":["\"renew\":true"]})", R"(W,0,"renew")", R"({"renewal":true})", R"({"Renew":true})",
          R"([{"renew":true}])", R"("renew")", R"({"write":[0,90],"port":"release"})", R"({"labels":{}})"})
        EXPECT_TRUE(takes_turns(*read("asip/uno1/servo/in", payload)))
            << payload << as<Command>("asip/uno1/servo/in", payload).fault;
    for (const auto* payload : {R"({"raw":"I,M","by":"port"})", R"({"raw":"I,M","port":"release"})",
                                R"({"renew":true})", R"({"a":{"port":"release"}})", R"({"a":{"labels":{}}})",
                                R"({"id":"labels","raw":"I,M"})", R"(I,M "port" "labels" "names")"})
        as<Command>("asip/uno1/in", payload);
}

TEST_F(InboundTest, EscapedMember_IsTheSame) {
    EXPECT_EQ(as<Renewal>("asip/uno1/servo/in", R"({"r\u0065new":"7"})").id, "7");
    as<PortRequest>("asip/uno1/in", R"({"p\u006frt":"take"})");
}

TEST_F(InboundTest, MembersThatStandTwice_TheLastCounts) {
    EXPECT_EQ(as<Renewal>("asip/uno1/servo/in", R"({"renew":"1","renew":"2"})").id, "2");
    EXPECT_EQ(as<Command>("asip/uno1/servo/in", R"({"write":[0,1],"id":"a","id":"renew"})").reply().id,
              "renew");
    const auto port = as<PortRequest>("asip/uno1/in", R"({"port":"release","port":"take"})");
    EXPECT_EQ(port.wanted->what, bus::PortRequest::What::kTake);
}

TEST_F(InboundTest, TwoKindsInOne_TheFirstOfPortAndLabels) {
    EXPECT_FALSE(as<PortRequest>("asip/uno1/in", R"({"labels":{},"port":"take"})").wanted)
        << "labels are unknown there";
    as<Renewal>("asip/uno1/servo/in", R"({"renew":true,"write":[0,90]})");
}

TEST_F(InboundTest, StoredRequests_AreCommandsToBeRefused) {
    EXPECT_TRUE(as<Command>("asip/uno1/servo/in", R"({"renew":true})", true).retained);
    EXPECT_TRUE(as<Command>("asip/uno1/in", R"({"port":"release"})", true).retained);
    EXPECT_TRUE(as<Command>("asip/uno1/in", R"({"labels":{}})", true).retained);
    EXPECT_TRUE(as<Stop>("asip/uno1/$stop", "", true).retained);
}

TEST_F(InboundTest, ServiceWithoutAModel_IsNotRenewed) {
    as<Command>("asip/uno1/Q/in", R"({"renew":true})");
    as<Command>("asip/uno1/nothing/in", R"({"renew":true})");
}

// --- the envelope

TEST_F(InboundTest, UnreadableEnvelope_IsACommandWithItsFaultAndWhereToAnswer) {
    const auto broken = as<Command>("asip/uno1/servo/in", R"({"reply_to":"r","id":"7","renew":true)");
    EXPECT_THAT(broken.fault, HasSubstr("JSON"));
    EXPECT_EQ(broken.reply().topic, "r");
    EXPECT_EQ(broken.reply().id, "7");
    EXPECT_EQ(broken.shown(), broken.payload);
    for (const auto* payload :
         {"{", R"({"renew":true,"id":[]})", R"({"renew":true,"hold_ms":1})", R"({"renew":true,"clock":7})",
          R"({"port":"take","reply_to":"#"})", "{\"labels\":\"\xff\"}", R"({"renew":1e400})"}) {
        EXPECT_FALSE(as<Command>("asip/uno1/servo/in", payload).fault.empty()) << payload;
        EXPECT_FALSE(as<Command>("asip/uno1/in", payload).fault.empty()) << payload;
    }
    EXPECT_FALSE(as<Stop>("asip/uno1/$stop", "{").fault.empty()) << "a stop all the same";
}

TEST_F(InboundTest, SizeBounds) {
    const auto of_size = [](std::size_t size) {
        const std::string head = R"({"renew":")";
        return head + std::string(size - head.size() - 2, '7') + "\"}";
    };
    EXPECT_TRUE(as<Renewal>("asip/uno1/servo/in", of_size(bus::kMaxRequestBytes)).fault.empty());
    EXPECT_THAT(as<Command>("asip/uno1/servo/in", of_size(bus::kMaxRequestBytes + 1)).fault,
                HasSubstr("longer than"));
    EXPECT_THAT(as<Command>("asip/uno1/servo/in", std::string(1'000'000, '[')).fault,
                HasSubstr("longer than"));
    const auto nested = [](int depth) {
        return R"({"renew":)" + std::string(static_cast<std::size_t>(depth - 1), '[') +
               std::string(static_cast<std::size_t>(depth - 1), ']') + "}";
    };
    as<Renewal>("asip/uno1/servo/in", nested(bus::kMaxJsonDepth));
    EXPECT_THAT(as<Command>("asip/uno1/servo/in", nested(bus::kMaxJsonDepth + 1)).fault, HasSubstr("deep"));
}

TEST_F(InboundTest, Arrival_IsByClockDeliveryAndExpiry) {
    mqtt::Message message{.topic = "asip/uno1/servo/in",
                          .payload = R"({"write":[0,90],"deadline_ms":4000})",
                          .user_properties = {{"clock", age.clock(kReadAt - 3s)}}};
    auto command = std::get<Command>(*read(message));
    EXPECT_EQ(command.arrival.received, kReadAt);
    EXPECT_LE(command.arrival.sent(), kReadAt - 3s + 1ms);
    EXPECT_EQ(command.deadline(), command.arrival.sent() + 4s);
    message.user_properties.clear();
    message.expiry_seconds = 2;
    EXPECT_EQ(std::get<Command>(*read(message)).deadline(), kReadAt + 3s) << "brokers cut off up to a second";
    message.payload = "W,0,90";
    EXPECT_EQ(std::get<Command>(*read(message)).deadline(), kReadAt + 2s);
    message.expiry_seconds.reset();
    age.runs(kReadAt - 8s, {}, 0);
    age.runs(kReadAt, {}, 1);
    EXPECT_EQ(std::get<Command>(*read(message)).deadline(), kReadAt - 8s + kUsualDeadline)
        << "the process was stopped";
    age.connection_changed();
    EXPECT_EQ(std::get<Command>(*read(message)).deadline(), kReadAt + kUsualDeadline);
}

// --- raw lines as a client names them

TEST_F(InboundTest, ClientSide_RequestsComeOnOutAndOnInWhereAnAnswerIsWanted) {
    client_side = true;
    as<Command>("asip/uno1/out", "I,M");
    as<Command>("asip/uno1/in", R"({"raw":"I,M","reply_to":"r"})");
    EXPECT_FALSE(read("asip/uno1/in", "@I,M,1,{0}")) << "a line of the board, which this agent published";
    EXPECT_FALSE(read("asip/uno1/in", "{"));
    as<PortRequest>("asip/uno1/in", R"({"port":"release"})");
    as<LabelRequest>("asip/uno1/in", R"({"labels":{}})");
}

TEST_F(InboundTest, TurnsAreForCommandsPortsLabelsAndLinks) {
    EXPECT_TRUE(takes_turns(*read("asip/uno1/servo/in", "W,0,90")));
    EXPECT_TRUE(takes_turns(*read("asip/uno1/in", R"({"port":"take"})")));
    EXPECT_TRUE(takes_turns(*read("asip/uno1/in", R"({"labels":{}})")));
    EXPECT_TRUE(takes_turns(*read("asip/uno1/$link/ann/c", R"({"remove":"l"})")));
    EXPECT_FALSE(takes_turns(*read("asip/uno1/servo/in", R"({"renew":true})")));
    EXPECT_FALSE(takes_turns(*read("asip/uno1/$stop", "")));
    EXPECT_FALSE(takes_turns(*read("asip/servicebus/$probe", "")));
}

}  // namespace
}  // namespace asip::agent
