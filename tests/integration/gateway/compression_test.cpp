// SPDX-License-Identifier: Apache-2.0
// What is compressed, for whom, and that it is the same once unpacked: curl is the judge.
#include <gmock/gmock.h>

#include "running_gateway.hpp"

namespace asip::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::string kGzip = "\x1f\x8b";

class GatewayCompression : public GatewayTest {
  protected:
    GatewayCompression() {
        for (int i = 0; i < 20; ++i) {
            const auto board = "uno" + std::to_string(i);
            probe_.publish("asip/servicebus/" + board + "/$description", described(board));
            probe_.publish("asip/servicebus/" + board + "/$state", "online");
        }
        if (!gateway_.becomes("uno19", "online")) throw std::runtime_error("no boards");
    }
    std::string url(const std::string& target) const {
        return "http://127.0.0.1:" + std::to_string(port()) + target;
    }
    HttpAnswer ask_for(const std::string& encoding, const std::string& target) const {
        return get(port(), target, {{"Accept-Encoding", encoding}});
    }
    /// Ages are of the moment at which they were asked for, and times are worked out from them.
    static std::string without_times(const std::string& text) {
        return without_matches(text, R"("(state_)?age":[0-9.e-]+|[0-9:.]+Z")");
    }
};

const std::vector<std::string> kPageFiles{"/", "/main.js", "/style.css", "/icon.svg", "/net/hub.js"};
const std::vector<std::string> kLists{"/api/boards", "/api/services", "/api/openapi.json"};

TEST_F(GatewayCompression, CurlCompressed_GetsByteForByteTheSame) {
    auto targets = kPageFiles;
    targets.insert(targets.end(), kLists.begin(), kLists.end());
    for (const auto& target : targets) {
        const auto plain = run({"curl", "-s", url(target)});
        const auto unpacked = run({"curl", "-s", "--compressed", url(target)});
        ASSERT_EQ(plain.status, 0) << target;
        ASSERT_EQ(unpacked.status, 0) << target << ": " << unpacked.errors;
        ASSERT_FALSE(plain.output.empty()) << target;
        EXPECT_TRUE(without_times(unpacked.output) == without_times(plain.output)) << target;
        const auto packed = ask_for("gzip, deflate, br", target);
        EXPECT_THAT(packed.body, StartsWith(kGzip)) << target;
        EXPECT_LT(packed.body.size(), plain.output.size()) << target;
    }
}

TEST_F(GatewayCompression, Headers_SayWhatIsInTheBody) {
    for (const std::string target : {"/main.js", "/api/boards"}) {
        const auto packed = ask_for("gzip", target);
        EXPECT_EQ(packed.headers.at("content-encoding"), "gzip") << target;
        EXPECT_THAT(packed.headers.at("vary"), HasSubstr("Accept-Encoding")) << target;
        for (const std::string encoding : {"identity", "gzip;q=0", "br", "identity;q=1, *;q=0"}) {
            const auto plain = ask_for(encoding, target);
            EXPECT_EQ(plain.headers.count("content-encoding"), 0u) << target << " " << encoding;
            EXPECT_THAT(plain.headers.at("vary"), HasSubstr("Accept-Encoding"))
                << target << ": a cache must know, too";
            EXPECT_TRUE(without_times(plain.body) == without_times(get(port(), target).body)) << target;
        }
        const auto unchanged =
            get(port(), target, {{"Accept-Encoding", "gzip"}, {"If-None-Match", packed.headers.at("etag")}});
        EXPECT_EQ(unchanged.status, 304) << target;
        EXPECT_THAT(unchanged.headers.at("vary"), HasSubstr("Accept-Encoding")) << target;
        EXPECT_THAT(packed.headers.at("etag"), StartsWith("W/")) << "the same for two forms";
    }
}

TEST_F(GatewayCompression, Streams_AreNotCompressed) {
    for (const std::string target : {"/api/events", "/api/boards/uno1/services/distance/stream"}) {
        EventStream stream(port(), target, {{"Accept-Encoding", "gzip"}});
        EXPECT_EQ(stream.head().headers.count("content-encoding"), 0u) << target;
        EXPECT_EQ(stream.next("snapshot-end").kind, "snapshot-end") << target;
    }
}

}  // namespace
}  // namespace asip::test
