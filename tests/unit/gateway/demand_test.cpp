// SPDX-License-Identifier: Apache-2.0
// What a gateway demands of boards that report on demand, for clients that read its streams.
#include "api_bench.hpp"
#include "gateway/api/limits.hpp"

namespace asip::gateway {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class DemandingApi : public ApiTest {
  protected:
    DemandingApi() {
        time_ = 1000s;
        announce("uno1");
        bus("asip/servicebus/uno1/$description",
            R"({"board":"uno1","session":"s1","seq":2,"lease":60,"on_demand":{"fastest":20,"resting":0},)"
            R"("services":[{"name":"distance","id":"D","model":"distance@1"},{"name":"io","id":"I"}]})");
        said(1s);
    }
    /// Payloads of the demands within `time`.
    std::vector<std::string> said(std::chrono::milliseconds time) {
        for (std::chrono::milliseconds past{0}; past < time; past += 100ms)
            pass(100ms);
        std::vector<std::string> payloads;
        for (const auto& message : published_)
            if (message.topic == "asip/servicebus/uno1/$demand/gate/gw") payloads.push_back(message.payload);
        published_.clear();
        return payloads;
    }
    static std::string demand(const std::string& services) {
        return R"({"lease":15,"services":)" + services + "}";
    }
};

TEST_F(DemandingApi, StreamIsOpen_ItsRateIsDemanded_AndNoLongerWhenItIsClosed) {
    EXPECT_THAT(said(20s), IsEmpty()) << "nobody reads";
    auto fast = get("/api/boards/uno1/services/distance/stream?max_hz=20");
    ASSERT_TRUE(fast->source);
    EXPECT_THAT(said(1s), ElementsAre(demand(R"({"distance":20.0})")));
    const auto slow = get("/api/boards/uno1/services/distance/stream?max_hz=2");
    EXPECT_THAT(said(1s), IsEmpty());
    fast.reset();
    EXPECT_THAT(said(1s), ElementsAre(demand(R"({"distance":2.0})")));
    slow->source.reset();
    EXPECT_THAT(said(1s), ElementsAre(demand("{}")));
    EXPECT_THAT(said(1min), IsEmpty());
}

TEST_F(DemandingApi, WaitForAValue_DemandsItUntilItCame) {
    const auto waiting = get("/api/boards/uno1/services/io/value?wait=5");
    EXPECT_THAT(said(1s), ElementsAre(demand(R"({"io":10.0})")));
    bus("asip/uno1/io/out", R"({"analog":{"0":1}})");
    EXPECT_EQ(waiting->status(), 200);
    EXPECT_THAT(said(1s), ElementsAre(demand("{}")));
}

TEST_F(DemandingApi, EndOfTheProgram_DemandsNothingAnyMore) {
    const auto stream = get("/api/boards/uno1/services/io/stream");
    said(1s);
    gateway_->leave();
    EXPECT_THAT(said(100ms), ElementsAre(demand("{}")));
}

TEST_F(DemandingApi, LimitedToken_DemandsOnlyWhatItMayRead) {
    Rights kiosk;
    kiosk.boards = {"uno1", "lab?"};
    kiosk.services = {"distance", "io*"};
    const auto demanded = [&](const std::string& board, const std::string& service) {
        std::string text;
        caller::Caller::Port port;
        port.publish = [&](const mqtt::Message& message) {
            text += std::string(bus::Topics().parse(message.topic)->board) + message.payload + "\n";
            return true;
        };
        port.subscribe = [](const std::string&, mqtt::SubscribeOptions) {};
        caller::Caller caller({bus::Topics(), "gate", "gw"}, [] { return std::uint64_t{0}; }, port);
        std::size_t count = 0;
        const auto want = api::demand_within(kiosk, caller, board, service, 5, count);
        const Time now{1s};
        caller.connected(now);
        for (const std::string name : {"lab1", "uno1", "uno2"}) {
            mqtt::Message description{
                .topic = "asip/servicebus/" + name + "/$description",
                .payload =
                    R"({"board":")" + name +
                    R"(","session":"s","seq":1,"lease":60,"on_demand":{"fastest":20,"resting":0},"services":[]})"};
            caller.message(description, now);
        }
        return text;
    };
    EXPECT_EQ(demanded("uno1", "distance"), "uno1" + demand(R"({"distance":5.0})") + "\n");
    EXPECT_EQ(demanded("uno2", "distance"), "");
    EXPECT_EQ(demanded("uno1", "servo"), "");
    EXPECT_EQ(demanded("*", "dist*"), "lab1" + demand(R"({"distance":5.0,"io*":5.0})") + "\nuno1" +
                                          demand(R"({"distance":5.0,"io*":5.0})") + "\n");
    EXPECT_EQ(demanded("x*", "servo"), "");
}

}  // namespace
}  // namespace asip::gateway
