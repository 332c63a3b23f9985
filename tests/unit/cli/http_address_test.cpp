// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "cli/ask/http_request.hpp"

namespace asip::cli {
namespace {

TEST(HttpAddress, WithPortOrPathOrNeither_IsTakenApartAndBecomesItselfAgain) {
    for (const char* text : {"http://127.0.0.1:8080", "https://gateway.example",
                             "https://gateway.example:8443/asip", "http://[::1]:8080"}) {
        const auto address = parse_http_address(text);
        ASSERT_TRUE(address) << text;
        EXPECT_EQ(address->text(), text);
    }
    EXPECT_EQ(parse_http_address("https://a/b/")->path, "/b");
    EXPECT_EQ(parse_http_address("http://[::1]:8080")->host, "::1");
    EXPECT_EQ(parse_http_address("https://a")->port, "443");
}

TEST(HttpAddress, NoAddress_IsRefused) {
    for (const char* text :
         {"", "127.0.0.1:8080", "ftp://a", "http://", "http://:80", "http://a:x", "http://a:99999",
          "http://a:0", "http://a b", "http://a/?x", "http://a\r\nX: y"}) {
        EXPECT_FALSE(parse_http_address(text)) << text;
    }
}

}  // namespace
}  // namespace asip::cli
