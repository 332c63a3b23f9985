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

/// A WebSocket's messages: subscriptions, commands and their answers, as JSON objects. A bad message is
/// answered with a sentence. Answers go first, then events of subscriptions in turn. Pure.
class StreamChannel : public http::Channel, public OpenStream {
  public:
    static constexpr std::size_t kBytesOfAnswer = 64;  ///< that waits to be read, beside its text
    /// Part of what the connection takes for answers, so that a client with no budget left is told so.
    static constexpr std::size_t kBytesOfAnswers = 16 * 1024;
    static constexpr int kMaxFaults = 100;  ///< messages that are none, then the connection ends

    /// Errors are sentences for a person.
    struct Dependencies {
        std::function<Instant()> now;
        /// For `{"subscribe":...}`.
        std::function<Expected<std::unique_ptr<Feed>>(const nlohmann::json& request)> subscribe;
        /// `answer` is called once, at once or later.
        std::function<void(const nlohmann::json& request, std::function<void(std::string)> answer)> command;
        std::size_t max_subscriptions = 256;
        /// A part of its client's budget, kBytesOfAnswers with it. Where another answer does not fit the
        /// connection is closed.
        Budget::Part part{};
    };

    StreamChannel(Streams& streams, Dependencies dependencies, Principal principal, std::string client);
    ~StreamChannel() override;

    bool take(std::string& message) override;
    bool received(std::string_view message) override;
    std::uint16_t close_code() const override { return revoked_ ? 1008 : 0; }
    bool more() const override { return more_; }
    void tick(const Instant& now) override;
    void revoke() override;

  private:
    struct Subscription {
        std::string ref;  // JSON text
        std::unique_ptr<Feed> feed;
        bool idle = false;  // had nothing; until its wake
        bool over = false;  // its fault was told
    };
    void answer(std::string text);
    bool count_answers(std::size_t bytes);
    bool fault(const std::string& ref, const std::string& sentence);
    void handle(const nlohmann::json& request, std::string_view message);
    void subscribe(const nlohmann::json& request, std::string_view message);
    void unsubscribe(const nlohmann::json& request, std::string_view message);
    bool next_event(std::string& message);

    Streams& streams_;
    Dependencies dependencies_;
    std::list<Subscription> subscriptions_;  // the next to be asked first
    std::deque<std::string> answers_;
    std::size_t answer_bytes_ = 0;
    std::size_t base_bytes_ = 0;  // of the connection itself
    std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
    int faults_ = 0;
    bool more_ = false;
    bool revoked_ = false;
};

}  // namespace asip::gateway
