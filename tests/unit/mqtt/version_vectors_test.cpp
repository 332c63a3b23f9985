// SPDX-License-Identifier: Apache-2.0
// Which version of MQTT is spoken to a broker that knows no MQTT 5: tests/vectors/mqtt_version.json, which
// the tests of the Python package and of the Node-RED nodes read, too.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "asip/mqtt/quirks/knows_no_mqtt_5.hpp"

namespace asip::mqtt {
namespace {

using nlohmann::json;

ConnectionEnd end_of(const std::string& ended) {
    using Failure = ConnectionFailure::Kind;
    ConnectionEnd end;
    end.failure.kind = ended == "other" ? Failure::kUnreachable : Failure::kNoAnswer;
    end.version_refused = ended == "version";
    end.closed_unanswered = ended == "closed";
    if (end.version_refused) end.failure.kind = Failure::kRefused;
    return end;
}

TEST(MqttVersionVectors, EachAttempt_IsFollowedByOneOfTheVersionThatTheFileSays) {
    const auto vectors = json::parse(std::ifstream(ASIP_MQTT_VERSION_VECTORS));
    for (const auto& broker : vectors.at("brokers")) {
        VersionChoice choice(Version::kBest);
        for (const auto& attempt : broker.at("attempts")) {
            const std::string ended = attempt.at("ended");
            if (ended == "accepted")
                choice.accepted();
            else
                choice.failed(end_of(ended), choice.v5());
            EXPECT_EQ(choice.v5() ? 5 : 4, attempt.at("then").get<int>()) << broker.at("about") << ended;
            EXPECT_EQ(choice.suspected(), attempt.at("same").get<bool>()) << broker.at("about") << ended;
        }
    }
}

}  // namespace
}  // namespace asip::mqtt
