// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/options.hpp"

#include <gtest/gtest.h>

namespace asip::mqtt {
namespace {

TEST(ParseBroker, EachForm_IsRead) {
    EXPECT_EQ(parse_broker("pi"), (BrokerAddress{"pi", 1883, false}));
    EXPECT_EQ(parse_broker("pi:1884"), (BrokerAddress{"pi", 1884, false}));
    EXPECT_EQ(parse_broker("mqtt://pi"), (BrokerAddress{"pi", 1883, false}));
    EXPECT_EQ(parse_broker("mqtt://pi:99/"), (BrokerAddress{"pi", 99, false}));
    EXPECT_EQ(parse_broker("mqtts://pi"), (BrokerAddress{"pi", 8883, true}));
    EXPECT_EQ(parse_broker("mqtts://10.0.0.1:8884"), (BrokerAddress{"10.0.0.1", 8884, true}));
    EXPECT_EQ(parse_broker("[::1]:1885"), (BrokerAddress{"::1", 1885, false}));
    EXPECT_EQ(parse_broker("mqtts://[::1]"), (BrokerAddress{"::1", 8883, true}));
}

TEST(ParseBroker, WhatDescribeSays_ReadsBack) {
    for (const char* text : {"pi:1", "mqtts://[fe80::1]:70", "127.0.0.1"}) {
        const auto address = parse_broker(text);
        ASSERT_TRUE(address);
        EXPECT_EQ(parse_broker(address->describe()), *address);
    }
}

TEST(ParseBroker, Malformed_SaysWhatIsWrong) {
    for (const char* text : {"", ":1883", "pi:", "pi:0", "pi:65536", "pi:x", "http://pi", "[::1", "[::1]x",
                             "[::1]:", "mqtt://", "user@pi", "a b", "pi/topic", "::1"}) {
        const auto address = parse_broker(text);
        ASSERT_FALSE(address) << text;
        EXPECT_NE(address.error().find(std::string("\"") + text), std::string::npos) << address.error();
    }
}

}  // namespace
}  // namespace asip::mqtt
