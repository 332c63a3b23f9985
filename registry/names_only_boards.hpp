// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <set>
#include <string>

#include "asip/bus/topics.hpp"
#include "asip/time.hpp"
#include "registry/port.hpp"

namespace asip::registry {

/// Cares for boards of which only names were heard: their context traffic is subscribed to, since it renews
/// leases, and they are asked for a description. A moment passes first, because most publish both. Pure.
class NamesOnlyBoards {
  public:
    static constexpr Duration kDelay = std::chrono::seconds(1);
    /// How long each answer is waited for. The first question subscribes to what the broker retains; the
    /// second and third are also a probe, a message to every agent.
    static constexpr Duration kQuestionTime = std::chrono::seconds(2);
    static constexpr int kQuestions = 3;
    /// Open questions at a time; further ones wait, since thousands that join at once announce themselves.
    static constexpr std::size_t kMaxOpen = 200;
    static constexpr std::size_t kMaxProbes = 10;
    /// Beyond this many such boards the traffic of all is subscribed to, until half as many are left.
    static constexpr std::size_t kMaxListened = 2000;

    NamesOnlyBoards(const bus::Topics& topics, Port port);

    void add(const std::string& board, Time now);
    void remove(const std::string& board);
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
