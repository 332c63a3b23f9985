// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/options.hpp"
#include "asip/mqtt/failure.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/temp_dir.hpp"

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
                             "[::1]:", "mqtt://", "a b", "pi/topic", "::1"}) {
        const auto address = parse_broker(text);
        ASSERT_FALSE(address) << text;
        EXPECT_NE(address.error().find(std::string("\"") + text), std::string::npos) << address.error();
    }
}

TEST(ParseBroker, UserAndPassword_AreNotShownAndTheirOptionsNamed) {
    for (const char* text :
         {"mqtt://ann:secret@host", "ann:secret@host", "mqtts://ann:se@cret@host:1", "secret@host",
          "ftp://ann:secret@host", "mqtt://ann:secret@", "@secret@host", "secret/ secret@host"}) {
        const auto address = parse_broker(text);
        ASSERT_FALSE(address) << text;
        for (const char* part : {"ann", "secret", "cret"})
            EXPECT_EQ(address.error().find(part), std::string::npos) << address.error();
        EXPECT_NE(address.error().find("--user and --password-file"), std::string::npos) << address.error();
    }
}

TEST(ParseBroker, SixthVersionOfAnAddressWithoutBrackets_NamesThem) {
    for (const char* text : {"2001:db8::1", "mqtt://2001:db8::1", "::1"})
        EXPECT_NE(parse_broker(text).error().find("in brackets"), std::string::npos)
            << parse_broker(text).error();
}

TEST(ParseBroker, SlashesAtTheEnd_AreNothing) {
    EXPECT_EQ(parse_broker("mqtt://pi//"), (BrokerAddress{"pi", 1883, false}));
}

TEST(PasswordFile, OddOnes_HaveAHint) {
    const test::TempDir folder;
    EXPECT_EQ(read_password_file(folder.write("bom", "\xef\xbb\xbfsecret\r\n")).value(), "secret");
    EXPECT_EQ(read_password_file(folder.write("plain", " with blanks \nand more")).value(), " with blanks ");
    const auto fault = [&](const char* content) {
        return read_password_file(folder.write("odd", content)).error();
    };
    EXPECT_NE(fault("").find("no password in its first line"), std::string::npos);
    EXPECT_NE(fault("\nsecret").find("no password in its first line"), std::string::npos);
    EXPECT_NE(fault("ann:$7$101$abc==$def==\n").find("password alone"), std::string::npos);
    EXPECT_NE(
        read_password_file(folder.write("wide", std::string("\xff\xfes\0e\0", 6))).error().find("UTF-8"),
        std::string::npos);
    EXPECT_NE(read_password_file(folder.file("none")).error().find("No such file"), std::string::npos);
    EXPECT_FALSE(read_password_file(folder.path().string()));
}

std::string from_hex(const std::string& hex) {
    std::string bytes;
    for (std::size_t i = 0; i < hex.size(); i += 2)
        bytes += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
    return bytes;
}

// tests/vectors/passwords.json, which the tests of the Python package and of the Node-RED nodes read, too.
TEST(RefusedPassword, OddOnes_HaveAHint) {
    constexpr int kBadUserOrPassword = 0x86;
    const auto vectors = nlohmann::json::parse(std::ifstream(ASIP_PASSWORD_VECTORS));
    for (const auto& each : vectors.at("passwords")) {
        Options options;
        options.user = "ann";
        options.password = from_hex(each.at("hex").get<std::string>());
        const auto text = refused_by({"pi", 1883, false}, kBadUserOrPassword, options).text;
        EXPECT_NE(text.find("refused user \"ann\"" + each.at("hint").get<std::string>() + "; check"),
                  std::string::npos)
            << each.at("about") << text;
        EXPECT_EQ(text.find("secret"), std::string::npos) << text;
    }
}

}  // namespace
}  // namespace asip::mqtt
