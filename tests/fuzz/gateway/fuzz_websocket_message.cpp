// SPDX-License-Identifier: Apache-2.0
// Messages of a WebSocket, one a line, with values in between: each message is answered, every answer is
// JSON, and what was unsubscribed stays silent.
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "gateway/stream/channel.hpp"
#include "gateway/stream/value_feed.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace asip::gateway;

Instant now() {
    return {asip::Time{} + std::chrono::hours(1), {}};
}

std::size_t read_all(StreamChannel& channel) {
    std::size_t messages = 0;
    for (std::string message; channel.take(message); message.clear()) {
        REQUIRE(nlohmann::json::accept(message));
        REQUIRE(++messages < 10'000);
    }
    return messages;
}

StreamChannel::Dependencies dependencies(Values& values) {
    StreamChannel::Dependencies result;
    result.now = now;
    result.subscribe = [&values](const nlohmann::json& request) -> asip::Expected<std::unique_ptr<Feed>> {
        if (!request["subscribe"].is_string()) return asip::fail("subscribe: must be a string");
        ValueFeed::Options options;
        options.service = request["subscribe"].get<std::string>();
        if (const auto after = request.find("after"); after != request.end() && after->is_string())
            options.after = parse_place(after->get_ref<const std::string&>());
        return std::make_unique<ValueFeed>(values, std::move(options));
    };
    result.command = [](const nlohmann::json&, const std::function<void(std::string)>& answer) {
        answer("{}");
    };
    result.max_subscriptions = 8;
    return result;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::string_view rest(reinterpret_cast<const char*>(data), size);
    Values values("e1");
    Streams streams(4);
    StreamChannel channel(streams, dependencies(values), Principal{}, "fuzz");
    while (!rest.empty()) {
        const auto line = rest.substr(0, rest.find('\n'));
        rest.remove_prefix(std::min(rest.size(), line.size() + 1));
        if (line.starts_with("=")) {
            values.value("uno1", line.size() % 2 == 0 ? "a" : "b", line.substr(1), false, now());
            continue;
        }
        if (!channel.received(line)) return 0;
        REQUIRE(channel.close_code() != 0 || read_all(channel) > 0);
        if (channel.close_code() != 0) return 0;
    }
    read_all(channel);
    return 0;
}
