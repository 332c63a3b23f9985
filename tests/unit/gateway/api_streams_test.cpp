// SPDX-License-Identifier: Apache-2.0
// What a request for a stream must not be.
#include "api_bench.hpp"

namespace asip::gateway {
namespace {

using testing::HasSubstr;

constexpr const char* kStreams[] = {"/api/events", "/api/boards/uno1/services/distance/stream"};

TEST_F(ApiTest, LastEventIdThatIsNone_Is400_AndOneOfAnotherLifeIsAReset) {
    announce();
    for (const char* stream : kStreams) {
        for (const std::string id : {"x", "-", "-1", "e1-", "1f2e3d4c-", "1f2e3d4c-1.5", "1f2e3d4c-0x10",
                                     "1f2e3d4c-99999999999999999999999"})
            EXPECT_EQ(ask("GET", stream, {}, {{"last-event-id", id}})->status(), 400) << stream << " " << id;
        for (const std::string id : {"1f2e3d4c-18446744073709551615", "1f2e3d4c--1"}) {
            const auto other = ask("GET", stream, {}, {{"last-event-id", id}});
            ASSERT_TRUE(other->source) << stream << " " << id;
            std::string text;
            other->source->take(text, 100'000);
            EXPECT_THAT(text, HasSubstr("event: reset\n")) << stream << " " << id;
        }
    }
}

TEST_F(ApiTest, MaxHzOutOfItsRange_IsRefused) {
    announce();
    for (const char* wrong : {"1e-300", "1e-10", "0.009", "-1", "1001", "1e308", "nan", "inf", ""})
        EXPECT_EQ(get(std::string(kStreams[1]) + "?max_hz=" + wrong)->status(), 400) << wrong;
    for (const char* right : {"0", "0.01", "1000"})
        EXPECT_TRUE(get(std::string(kStreams[1]) + "?max_hz=" + right)->source) << right;
}

TEST_F(ApiTest, UpgradeThatIsNone_Is426) {
    using Fields = std::vector<std::pair<std::string, std::string>>;
    const Fields whole{{"upgrade", "websocket"},
                       {"connection", "Upgrade"},
                       {"sec-websocket-version", "13"},
                       {"sec-websocket-key", "dGhlIHNhbXBsZSBub25jZQ=="}};
    EXPECT_EQ(ask("GET", "/api/stream", {}, whole)->status(), 101);
    for (std::size_t i = 0; i < whole.size(); ++i) {
        auto without = whole;
        without.erase(without.begin() + static_cast<std::ptrdiff_t>(i));
        EXPECT_EQ(ask("GET", "/api/stream", {}, without)->status(), 426) << whole[i].first;
    }
    auto older = whole;
    older[2].second = "8";
    EXPECT_EQ(ask("GET", "/api/stream", {}, older)->status(), 426);
}

}  // namespace
}  // namespace asip::gateway
