// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "asip/bus/registry/answer.hpp"
#include "asip/bus/topics.hpp"
#include "asip/mqtt/message.hpp"
#include "asip/time.hpp"
#include "registry/catalogue_types.hpp"

namespace asip::registry {

/// How a registry gets, on each connection, what was there before: all that the broker retains below the
/// service bus; or, where other registries have many boards already, the pages of one of them. A broker
/// queues everything that it retains in one go and serves no other client meanwhile (Mosquitto 2.0: 8 us
/// a board), while a registry answers others between two pages.
///
/// What a registry tells of its boards is taken as the retained messages would be, by the same rules, and
/// whatever goes wrong leads back to those. Pure: messages and time in, messages and announcements out.
class FirstState {
  public:
    /// Without an answer for so long, another registry is asked; after kMostAsked the retained messages are
    /// read.
    static constexpr Duration kAnswerTime = std::chrono::seconds(3);
    static constexpr std::size_t kMostAsked = 3;
    /// Where the mark behind what is retained is lost, the state is taken for whole when no retained message
    /// has come for this time.
    static constexpr Duration kRetainedTime = std::chrono::seconds(15);
    /// Of a page: so small that its reader, and programs that ask the other registry meanwhile,
    /// wait for milliseconds.
    static constexpr std::size_t kPage = 50;

    /// What the first state needs of its registry.
    struct Dependencies {
        std::function<void(mqtt::Message)> publish;
        /// Subscribe to the service bus anew, now with what is retained: what is published afterwards arrives
        /// behind that.
        std::function<void()> read_retained;
        /// Ask boards to announce themselves.
        std::function<void()> probe;
        /// One board of the other registry. Views live as long as the call.
        std::function<void(const Announcement&)> apply;
        /// The state is whole.
        std::function<void()> complete;
    };

    /// `id`: of this registry. `reply_topic`: where answers to this class alone come. `many_boards`: where no
    /// other registry has as many, the retained messages are read: they are the broker's own, and a few cost
    /// no time that anybody would notice.
    FirstState(const bus::Topics& topics, std::string id, std::string reply_topic, std::size_t many_boards,
               Dependencies dependencies);

    /// Topics to subscribe to, the latter two with what is retained.
    const std::string& reply_topic() const { return reply_topic_; }
    std::string statistics_topic() const { return topics_.registry_stats("+"); }
    std::string states_topic() const { return topics_.registry_state("+"); }

    /// A new connection. `mark`: random. `retained_comes`: the retained messages are on their way already,
    /// wanted or not (MQTT 3.1.1).
    void begin(std::string mark, bool retained_comes, Time now);
    /// The connection is lost.
    void end() { phase_ = Phase::kWhole; }

    bool active() const { return phase_ != Phase::kWhole; }
    /// Pages of another registry are being read.
    bool copying() const { return phase_ == Phase::kPages; }
    /// The registry whose pages are, or were, read; empty: what the broker retains.
    const std::string& from() const { return from_; }
    /// A message on the registry's own query topic. True: it was this class's mark.
    bool mark(std::string_view payload, Time now);
    /// What a registry counts, and what it is.
    void statistics(std::string_view id, std::string_view payload);
    void state(std::string_view id, std::string_view word);
    /// A message on the reply topic.
    void answer(std::string_view payload, Time now);
    /// A retained message has come.
    void retained_came(Time now) {
        if (phase_ == Phase::kRetained) until_ = now + kRetainedTime;
    }
    void tick(Time now);

  private:
    enum class Phase {
        kWhole,     // nothing to do
        kWho,       // a mark is under way behind what the other registries have said of themselves
        kPages,     // one of them is asked for page after page
        kRetained,  // a mark is under way behind what is retained
    };
    struct Other {
        std::size_t boards = 0;
        bool online = false;
    };
    Other* other(std::string_view id);
    void send_mark(Phase phase);
    void next_registry(Time now);
    void ask_page(Time now);
    bool goes_on(const bus::AnswerLines& page);
    bool take(std::string_view lines);
    bool apply(std::string_view item);
    void retained(Time now);
    void wait_behind_retained(Time now);
    void whole();

    bus::Topics topics_;
    std::string id_;
    std::string reply_topic_;
    std::size_t many_boards_;
    Dependencies dependencies_;
    Phase phase_ = Phase::kWhole;
    std::string run_;       // what marks and questions of this connection begin with
    std::string mark_;      // the one under way
    std::string question_;  // the one without an answer
    std::map<std::string, Other, std::less<>> others_;  // those that were not asked
    std::size_t asked_ = 0;
    std::string from_;  // whose pages are read
    std::string epoch_;
    std::string cursor_;
    std::string last_;  // the name of the last board of them
    std::size_t pages_ = 0;
    Time until_{};
};

}  // namespace asip::registry
