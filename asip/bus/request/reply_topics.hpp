// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "asip/bus/topics.hpp"

namespace asip::bus {

/// A program's user of the broker as a level of topics: `$nobody` where it is empty or cannot be one.
std::string user_level(std::string_view user);

/// Where the answers to one program's requests come: ROOT/reply/USER/ASKED/CLIENT. USER is the program's user
/// of the broker, ASKED the board that is asked or `registry`, CLIENT what no other program has. So the
/// broker's access rules can keep others from reading an answer (by USER), and from giving one for
/// another answerer (by ASKED). Where the broker has no users, answers go to any topic that a request names;
/// else see may_answer_on().
class ReplyTopics {
  public:
    /// `user` becomes user_level(). `client`: one or more levels that are valid in a topic.
    ReplyTopics(const Topics& topics, std::string_view user, std::string_view client);

    /// Of the answers to a part of the program's requests: CLIENT becomes CLIENT/`level`.
    ReplyTopics below(std::string_view level) const;
    /// Of another client of the same program: CLIENT becomes CLIENT-`suffix`.
    ReplyTopics beside(std::string_view suffix) const;

    /// Subscribe to it before the first request: answers of everybody.
    std::string filter() const { return of("+"); }
    /// Where the answer to a request on `request_topic` comes.
    std::string to(std::string_view request_topic) const { return of(asked(request_topic)); }
    /// Who is asked there: a board, or `registry`.
    std::string_view asked(std::string_view request_topic) const;
    /// A topic that only the program itself writes and reads.
    std::string own() const { return of("$self"); }
    /// Of all programs of this user: own() without CLIENT.
    std::string own_of_all() const { return prefix_ + "$self"; }
    /// Whether the topic matches filter().
    bool have(std::string_view topic) const;
    /// Whether the topic is of this user, and of whichever of its programs.
    bool of_user(std::string_view topic) const { return topic.starts_with(prefix_); }

  private:
    std::string of(std::string_view asked) const;

    std::string root_;    // with a slash behind it
    std::string prefix_;  // ROOT/reply/USER/
    std::string client_;  // with a slash in front of it
};

/// Whether `answerer`, a board or `registry`, answers on this topic where the broker knows its users:
/// ROOT/reply/USER/ANSWERER/CLIENT. The rules of the broker let an answerer write more than that, values of
/// its board for example, and the requester names the topic.
bool may_answer_on(std::string_view topic, const Topics& topics, std::string_view answerer);

}  // namespace asip::bus
