// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <functional>
#include <list>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "asip/expected.hpp"
#include "gateway/stream/streams.hpp"

namespace asip::gateway {

/// A WebSocket's messages: subscriptions, commands and what comes back. Pure.
class StreamChannel : public http::Channel, public OpenStream {
  public:
    static constexpr std::size_t kMaxAnswers = 16'384;  ///< that wait to be read
    static constexpr int kMaxFaults = 100;              ///< messages that are none, then the connection ends

    /// What the channel needs of the rest. Errors are sentences for a person.
    struct Dependencies {
        std::function<Instant()> now;
        /// A feed for `{"subscribe":...}`.
        std::function<Expected<std::unique_ptr<Feed>>(const nlohmann::json& request)> subscribe;
        /// A command; `answer` is called once, at once or later, with the text of the answer.
        std::function<void(const nlohmann::json& request, std::function<void(std::string)> answer)> command;
        std::size_t max_subscriptions = 256;
    };

    StreamChannel(Streams& streams, Dependencies dependencies, Principal principal, std::string client);
    ~StreamChannel() override;

    bool take(std::string& message) override;
    bool received(std::string_view message) override;
    std::uint16_t close_code() const override { return revoked_ ? 1008 : 0; }
    void tick(const Instant& now) override;
    void revoke() override;

  private:
    struct Subscription {
        std::string ref;  // JSON text
        std::unique_ptr<Feed> feed;
        bool idle = false;  // had nothing; until its wake
    };
    void answer(std::string text);
    bool fault(const std::string& ref, const std::string& sentence);
    void handle(const nlohmann::json& request);
    void subscribe(const nlohmann::json& request);
    void unsubscribe(const nlohmann::json& request);
    bool next_event(std::string& message);

    Streams& streams_;
    Dependencies dependencies_;
    std::list<Subscription> subscriptions_;  // the next to be asked first
    std::deque<std::string> answers_;
    std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
    int faults_ = 0;
    bool revoked_ = false;
};

}  // namespace asip::gateway
