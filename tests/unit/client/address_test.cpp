// SPDX-License-Identifier: Apache-2.0
#include "asip/client/address.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace asip::client {
namespace {

using ::testing::HasSubstr;

std::string reason(std::string_view text) {
    const auto address = parse_address(text);
    return address ? "accepted" : address.error();
}

TEST(AddressTest, PathOrSerialPrefix_IsASerialPort) {
    for (const char* text : {"/dev/ttyACM0", "serial:/dev/ttyACM0"}) {
        const auto address = parse_address(text);
        ASSERT_TRUE(address) << text;
        EXPECT_EQ(address->kind, Address::Kind::kSerial);
        EXPECT_EQ(address->path, "/dev/ttyACM0");
    }
}

TEST(AddressTest, TcpUrl_NeedsAPort) {
    const auto address = parse_address("tcp://192.168.1.7:6789");
    ASSERT_TRUE(address);
    EXPECT_EQ(address->kind, Address::Kind::kTcp);
    EXPECT_EQ(address->host, "192.168.1.7");
    EXPECT_EQ(address->port, 6789);
    EXPECT_THAT(reason("tcp://192.168.1.7"), HasSubstr("the port is missing"));
}

TEST(AddressTest, Ipv6_IsWrittenInBrackets) {
    const auto address = parse_address("tcp://[::1]:6789");
    ASSERT_TRUE(address);
    EXPECT_EQ(address->host, "::1");
    EXPECT_EQ(address->port, 6789);
    EXPECT_EQ(parse_address("mqtt://[::1]/uno1")->port, 1883);
    EXPECT_THAT(reason("tcp://::1:6789"), HasSubstr("in brackets"));
    EXPECT_THAT(reason("tcp://[::1"), HasSubstr("never closed"));
    EXPECT_THAT(reason("tcp://[::1]x"), HasSubstr("only :PORT"));
}

TEST(AddressTest, MqttUrl_HasBrokerUserAndBoard) {
    const auto address = parse_address("mqtts://ann@broker.example/uno1");
    ASSERT_TRUE(address);
    EXPECT_EQ(address->kind, Address::Kind::kMqtt);
    EXPECT_TRUE(address->tls);
    EXPECT_EQ(address->user, "ann");
    EXPECT_EQ(address->host, "broker.example");
    EXPECT_EQ(address->port, 8883);
    EXPECT_EQ(address->board, "uno1");
    EXPECT_EQ(parse_address("mqtt://broker:1884/uno1")->port, 1884);
}

TEST(AddressTest, BareName_IsABoardOnTheLocalBroker) {
    const auto address = parse_address("uno1");
    ASSERT_TRUE(address);
    EXPECT_EQ(address->kind, Address::Kind::kMqtt);
    EXPECT_EQ(address->host, "127.0.0.1");
    EXPECT_EQ(address->port, 1883);
    EXPECT_EQ(address->board, "uno1");
}

TEST(AddressTest, PasswordInTheAddress_IsRefused) {
    EXPECT_THAT(reason("mqtt://ann:secret@broker/uno1"), HasSubstr("no password"));
}

TEST(AddressTest, WhatCannotBeMeant_IsRefusedWithTheReason) {
    EXPECT_THAT(reason(""), HasSubstr("empty"));
    EXPECT_THAT(reason("serial:"), HasSubstr("serial port is missing"));
    EXPECT_THAT(reason("mqtt://broker"), HasSubstr("board's name is missing"));
    EXPECT_THAT(reason("mqtt://broker/"), HasSubstr("board's name is missing"));
    EXPECT_THAT(reason("mqtt:///uno1"), HasSubstr("host is missing"));
    EXPECT_THAT(reason("mqtt://broker/a/b"), HasSubstr("board name"));
    EXPECT_THAT(reason("mqtt://broker:0/uno1"), HasSubstr("not a port"));
    EXPECT_THAT(reason("tcp://host:70000"), HasSubstr("not a port"));
    EXPECT_THAT(reason("http://host/uno1"), HasSubstr("begins with"));
    EXPECT_THAT(reason("servicebus"), HasSubstr("board name"));
}

}  // namespace
}  // namespace asip::client
