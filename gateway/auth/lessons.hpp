// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "gateway/auth/rights.hpp"
#include "gateway/auth/secret.hpp"
#include "gateway/instant.hpp"

namespace asip::gateway {

/// Boards that a teacher lends to whoever knows a code, one to each browser, until an end. Or the pupils
/// lend: each browser has a place for the board in its computer.
struct Lesson {
    /// A board, and the pupil who has it.
    struct Seat {
        std::string board;
        bool kept = false;  ///< by the teacher: no pupil gets it
        std::string pupil{};
        std::string cookie{};  ///< its hash; empty: the board is free
        text::WallTime since{};
    };
    std::string id, code;
    std::string maker, maker_mark;  ///< as of Rights: a lesson ends with the rights of its teacher
    bool lends = false;  ///< the pupils do: a seat is made for each, and its board may not be there yet
    std::vector<Seat> seats;
    Time end{};
    text::WallTime until{};
};

/// The lessons that are going on. Pure: time and randomness are passed in. Codes are short, so that pupils
/// can type them: wrong ones are counted, of each address and of all together. Nothing is stored: a restart
/// ends all lessons.
class Lessons {
  public:
    static constexpr std::size_t kMaxLessons = 16;
    static constexpr std::size_t kMaxBoards = 64;
    static constexpr Duration kLongest = std::chrono::hours(8);
    static constexpr std::size_t kCodeLength = 6;
    static constexpr std::size_t kTries = 5;      ///< wrong ones of an address within kTryTime
    static constexpr std::size_t kAllTries = 60;  ///< of all addresses
    static constexpr Duration kTryTime = std::chrono::minutes(1);

    explicit Lessons(Secrets secrets) : secrets_(std::move(secrets)) {}

    /// `boards`: in the order in which they are given out; none: the pupils lend theirs. Fails with a
    /// sentence where there are too many lessons, or a board belongs to another one.
    Expected<std::string> open(const Rights& teacher, const std::vector<std::string>& boards, Duration time,
                               const Instant& now);
    const std::deque<Lesson>& all() const { return lessons_; }
    /// Null: there is none of this id.
    const Lesson* find(std::string_view id) const;
    bool has(std::string_view board) const;

    struct Joined {
        enum class Outcome { kJoined, kNoSuchCode, kTooManyTries, kNoBoardFree };
        Outcome outcome = Outcome::kNoSuchCode;
        std::string cookie{};
        Rights rights{};
        bool again = false;  ///< the browser had this board before
        Duration wait{};     ///< kTooManyTries: until the next try
    };
    /// `address`: whose wrong tries are counted. `cookie`: of the browser; with one of this lesson it gets
    /// the board that it has, with one of another lesson it leaves that. `there`: whether a board can be used
    /// now.
    Joined join(std::string_view code, const std::string& address, std::string_view cookie,
                const std::function<bool(const std::string& board)>& there, const Instant& now);
    /// Nothing for a cookie whose lesson is over, or whose board was taken over.
    std::optional<Rights> rights_of(std::string_view cookie, const Instant& now) const;
    /// Whether a cookie is of a lesson, maybe of one that is over.
    static bool is_cookie(std::string_view cookie);
    /// The pupil gives the board back.
    void leave(std::string_view cookie);
    /// Ends the rights of the pupil who has the board. `keep`: no other pupil gets it. False: there is no
    /// such lesson or board.
    bool take_over(std::string_view id, std::string_view board, bool keep);
    bool end(std::string_view id);
    /// Ends the lessons whose time is over, or whose teacher `may` not hold them any more. `may` is asked
    /// with the rights of a pupil.
    void expire(const Instant& now, const std::function<bool(const Rights& pupil)>& may);

  private:
    struct WrongTry {
        std::string address;
        Time at;
    };
    std::string fresh_code() const;
    std::string fresh_board() const;
    std::optional<Duration> wait_of(const std::string& address, Time now);
    Joined give(Lesson& lesson, const std::function<bool(const std::string& board)>& there,
                const Instant& now);

    Secrets secrets_;
    std::deque<Lesson> lessons_;
    std::deque<WrongTry> wrong_;  // of the last minute; as many as kAllTries at most
};

}  // namespace asip::gateway
