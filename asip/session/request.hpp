// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "asip/session/action.hpp"
#include "asip/time.hpp"

namespace asip::session {

struct Request {
    RequestId id = 0;  ///< 0: the session's own, whose end is not reported
    ClientId client = 0;
    std::string line;  ///< without line end
    Time deadline = Time::max();
    bool prove = true;
    bool urgent = false;
    bool more_follow = false;      ///< see RequestOptions
    bool restores = false;         ///< sets what clients had set before
    std::size_t bytes_behind = 0;  ///< on the wire, for which there has to be room in the same write
    char answer_tag = 0;           ///< tag of the event that answers it, of the same service; 0: none
    Duration answer_time{};        ///< how long after its fence that event may come
    AnswerCheck is_answer{};
    /// Alone between its fences: its error would not name it, or it changes how the line works.
    bool alone = false;

    char service() const { return line[0]; }
    char tag() const { return line[2]; }
    /// Only the answer has its service and tag (`#,?`, `I,M`).
    bool is_question() const;
    /// It turns checksums on or off.
    bool changes_line() const { return service() == '#' && tag() == 'C'; }
};

/// Events of a value's tag that the board sends unasked.
struct SelfReports {
    Time until = Time::min();  ///< then none is on its way any more; Time::max(): not known
    Duration every{};          ///< their period; 0: none, or not known
};

struct RequestEnd {
    Request request;
    Ending ending = Ending::kTimeout;
    NotSent not_sent = NotSent::kBoardGone;
    int code = 0;
    std::string text{};
    protocol::ParsedLine answer{};
};

/// `service` and `tag` are those of a question that is answered with the same two.
bool is_question(char service, char tag);

/// The answer to such a question has the form of the protocol. Other events: true.
bool is_well_formed(const protocol::Event& event);

}  // namespace asip::session
