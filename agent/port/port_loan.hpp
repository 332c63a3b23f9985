// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "agent/bridge/effects.hpp"
#include "agent/inbound/inbound.hpp"
#include "asip/bus/request/reply.hpp"
#include "asip/model/description.hpp"
#include "asip/text/wall_time.hpp"
#include "asip/time.hpp"

namespace asip::agent {

/// What a board was before its port was let go of, and what answers there afterwards.
struct BoardTraits {
    std::string chip;
    std::string sketch;
    std::string stored_name;
    friend bool operator==(const BoardTraits&, const BoardTraits&) = default;
};

/// Whether both may be one board: chip and stored name are equal where both are known. The sketch may differ.
bool may_be_same_board(const BoardTraits& a, const BoardTraits& b);

/// The user of the board's port: this agent, or until a certain time a program that borrowed the port
/// (asipctl flash, or avrdude on behalf of a request to load firmware). The agent takes the port back when
/// that time is over, also where the bus is away. Pure: it says in the effects what to do with the port.
class PortLoan {
  public:
    /// While the board is made safe, at most so long.
    static constexpr Duration kMakeSafe = std::chrono::milliseconds(500);
    /// A board that does not answer within this time after its port was taken back is lost: a boot loader, a
    /// restart by DTR, and the asking.
    static constexpr Duration kAnswerTime = std::chrono::seconds(20);

    /// What loads firmware ends before that time, in whichever way.
    static constexpr Duration kLoadTime = std::chrono::minutes(5);

    enum class Phase {
        kOurs,
        kMakingSafe,  ///< asked for; the board is made safe first
        kReleased,    ///< not ours: state `updating`
        kTakingBack,  ///< opened again, the board has not answered yet
    };
    Phase phase() const { return phase_; }
    /// Whether the port is lent now.
    bool is_away() const { return phase_ == Phase::kReleased; }

    /// The board and its port, as they are before the port is lent.
    struct Lent {
        BoardTraits traits;
        model::LinkInfo link;
        std::string host;    ///< this machine's name
        bool ready = false;  ///< the board answers now
    };
    /// Answers the request now, or when the port was let go of or taken back. A faulty request is refused,
    /// one to release that waited longer than its deadline is answered `timeout`.
    void request(const PortRequest& request, const Lent& board, Time now, text::WallTime wall, Effects& out);
    /// The board is safe, or cannot be made so in time: the port is let go of, and the request is answered.
    void let_go(Time now, Effects& out);
    /// How far the loading of firmware is: a word for people, and percents.
    void loading(std::string_view step, int percent);
    /// It has ended: the port is taken back. A failure is answered at once; otherwise the board is waited
    /// for.
    void loaded(const Expected<void>& result, Time now, Effects& out);
    /// A board was identified at the port. Where the port was just taken back, that request is answered now.
    void identified(const BoardTraits& traits, Effects& out);

    /// When the time is over the port is taken back. True: the board was given back and does not answer.
    bool tick(Time now, Effects& out);
    std::optional<Time> next_deadline() const;

    /// For the description while it is released: `{"by":"...","until":"..."}`, while firmware is loaded
    /// `{"by":"...","firmware":"...","step":"writing","percent":40}`; empty: it is ours.
    std::string updating() const;

  private:
    void answer(const bus::ReplyTo& to, bus::Reply reply, Effects& out) const;
    void release(const bus::PortRequest& request, const bus::ReplyTo& reply, const Lent& board, Time now,
                 text::WallTime wall, Effects& out);
    void load(const bus::PortRequest& request, const bus::ReplyTo& reply, const Lent& board, Time now,
              Effects& out);
    void begin(const bus::ReplyTo& reply, const Lent& board, Time now);
    void take_back(Time now, Effects& out);
    bus::Reply refusal() const;
    std::string granted() const;
    std::string until_text() const { return text::iso_time(until_wall_); }

    Phase phase_ = Phase::kOurs;
    Time deadline_{};  // of the phase
    Time until_{};
    text::WallTime until_wall_{};
    std::string by_;
    Lent before_;
    std::optional<bus::PortRequest> load_;
    std::string step_;
    int percent_ = 0;
    bus::ReplyTo release_reply_;
    bus::ReplyTo take_reply_;
};

}  // namespace asip::agent
