// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <set>
#include <string>

#include "asip/bus/topics.hpp"
#include "asip/time.hpp"
#include "registry/port.hpp"

namespace asip::registry {

/// Looks after boards of which only names were heard. Their context traffic is subscribed to, because it
/// renews their leases; and they are asked for a description, in case theirs was missed. Boards that have one
/// publish both within a moment, so all of that waits this moment. Pure.
class NamesOnlyBoards {
  public:
    static constexpr Duration kDelay = std::chrono::seconds(1);
    /// How long an answer to each question is waited for. A question is a subscription to what the broker
    /// retains; the second and the third are a probe as well, which costs a message to every agent.
    static constexpr Duration kQuestionTime = std::chrono::seconds(2);
    static constexpr int kQuestions = 3;
    /// Questions at a time, and those of them with a probe; the others wait. Thousands of boards that join at
    /// once are better left to announce themselves.
    static constexpr std::size_t kMaxOpen = 200;
    static constexpr std::size_t kMaxProbes = 10;
    /// Beyond this many such boards the traffic of all boards is subscribed to, until half as many are left.
    static constexpr std::size_t kMaxListened = 2000;

    NamesOnlyBoards(const bus::Topics& topics, Port port);

    void add(const std::string& board, Time now);
    void remove(const std::string& board);
    /// Call a few times a second.
    void tick(Time now);

  private:
    struct Question {
        Time at;        // of the next step
        int asked = 0;  // questions so far
        bool open = false;
        bool probes() const { return asked > 0; }  // the next one
    };

    void listen(const std::string& board);
    void listen_to_each();
    void step(const std::string& board, Question& question, Time now);
    void ask(const std::string& board, Question& question, Time now);
    void close(const std::string& board, Question& question);
    bool must_wait(const Question& question) const;

    const bus::Topics& topics_;
    Port port_;
    std::map<std::string, Question> questions_;
    std::set<std::string> listened_;
    bool to_all_ = false;
    std::size_t open_ = 0;
    std::size_t probing_ = 0;  // of open_
};

}  // namespace asip::registry
