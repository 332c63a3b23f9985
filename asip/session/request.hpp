// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "asip/session/action.hpp"
#include "asip/time.hpp"

namespace asip::session {

/// A request line on its way to the board.
struct Request {
    RequestId id = 0;  ///< 0: the session's own, whose end is not reported
    ClientId client = 0;
    std::string line;  ///< without line end
    Time deadline = Time::max();
    bool prove = true;
    bool urgent = false;
    char answer_tag = 0;     ///< tag of the event that answers it, of the same service; 0: none
    Duration answer_time{};  ///< how long after its fence that event may come
    AnswerCheck is_answer{};
    /// Nothing else between its fences: an error of it would not name it, or it changes how the line works.
    bool alone = false;

    char service() const { return line[0]; }
    char tag() const { return line[2]; }
    /// Its answer has its own service and tag (`#,?`, `I,M`): nothing but the answer looks like that.
    bool is_question() const;
    /// It turns checksums on or off: what follows it has another form.
    bool changes_line() const { return service() == '#' && tag() == 'C'; }
};

/// The events of its tag that the board sends without being asked.
struct SelfReports {
    Time until = Time::min();  ///< then none is on its way any more; Time::max(): not known
    Duration every{};          ///< their period; 0: none, or not known
};

/// How a request ended.
struct RequestEnd {
    Request request;
    Ending ending = Ending::kTimeout;
    NotSent not_sent = NotSent::kBoardGone;
    int code = 0;
    std::string text{};
    protocol::ParsedLine answer{};
};

/// Whether `service` and `tag` are those of a question that the board answers with an event of the same
/// service and tag.
bool is_question(char service, char tag);

/// Whether the answer to such a question has the form that the protocol demands. Other events: true.
bool is_well_formed(const protocol::Event& event);

}  // namespace asip::session
