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

/// For comparing the boards at the port before and after a loan.
struct BoardTraits {
    std::string chip;
    std::string sketch;
    std::string stored_name;
    std::string version{};    ///< of its firmware
    std::string available{};  ///< the newer one that its agent would load
    friend bool operator==(const BoardTraits&, const BoardTraits&) = default;
};

/// Chip and stored name are equal where both are known. The sketch may differ.
bool may_be_same_board(const BoardTraits& a, const BoardTraits& b);

/// Who uses the board's port: this agent, or for a time a program that borrowed it (asipctl flash, or avrdude
/// for a request to load firmware). The agent takes the port back in time, with or without a bus. Pure: the
/// effects say what to do with the port.
class PortLoan {
  public:
    /// For making the board safe.
    static constexpr Duration kMakeSafe = std::chrono::milliseconds(500);
    /// A board that answers nothing so long after its port came back is lost: a boot loader, a restart by
    /// DTR, and the asking fit in.
    static constexpr Duration kAnswerTime = std::chrono::seconds(20);

    /// Loading firmware ends by then, in whichever way.
    static constexpr Duration kLoadTime = std::chrono::minutes(5);

    enum class Phase {
        kOurs,
        kMakingSafe,  ///< asked for; the board is made safe first
        kReleased,    ///< not ours: state `updating`
        kTakingBack,  ///< opened again, the board has not answered yet
    };
    Phase phase() const { return phase_; }
    bool is_away() const { return phase_ == Phase::kReleased; }

    /// The board and its port before the loan.
    struct Lent {
        BoardTraits traits;
        model::LinkInfo link;
        std::string host;    ///< this machine's name
        bool ready = false;  ///< the board answers now
    };
    /// Answers now, or when the port was let go of or taken back. A faulty request is refused; one to release
    /// that waited beyond its deadline is answered `timeout`.
    void request(const PortRequest& request, const Lent& board, Time now, text::WallTime wall, Effects& out);
    /// The board is safe, or cannot be made so in time: lets the port go, and answers the request.
    void let_go(Time now, Effects& out);
    /// A word for people, and percents.
    void loading(std::string_view step, int percent);
    /// Loading ended: the port is taken back. A failure is answered at once, a success when the board is
    /// back.
    void loaded(const Expected<void>& result, Time now, Effects& out);
    /// Answers the request that took the port back.
    void identified(const BoardTraits& traits, Effects& out);

    /// Takes the port back in time. True: the board does not answer.
    bool tick(Time now, Effects& out);
    std::optional<Time> next_deadline() const;

    /// For the description: `{"by":"...","until":"..."}`, while firmware is loaded
    /// `{"by":"...","firmware":"...","step":"writing","percent":40}`; empty: the port is ours.
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
    bus::Reply found(const BoardTraits& after) const;
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
