// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "asip/member/announcer.hpp"
#include "tests/truth/presence/sim_broker.hpp"
#include "tests/truth/presence/starts.hpp"

namespace truth::presence {

using asip::model::BoardState;
using asip::model::StateReason;

/// What is really so.
struct Really {
    bool announced = false;
    BoardState state = BoardState::kLost;
    StateReason reason = StateReason::kNone;
    Time since{};
    Time said_at{};  ///< first
};

class SimAgent;

/// What is so of one name, whichever agents have had it.
struct BoardTruth {
    Really said;           ///< the last words, of an agent or of the broker in its place
    Time lease_end{};      ///< of them
    Time there_at{};       ///< when the board was last said to be there
    std::string session;   ///< of them: the later one, while its lease runs
    Time last_will{};      ///< or another word of no session
    Time last_new_word{};  ///< the last of those that did not say the same as was said before
    std::vector<Time> wills;
    /// One beside a description of another connection, or soon before one that says otherwise, until a
    /// renewal behind it: nothing says which of them bridged brokers deliver last, nor of which session a
    /// word is: "lost" behind a late "offline" may be a will.
    std::optional<Really> unordered_word;
    bool taken_back = false;  ///< an agent has put it right
    SimBroker::Client described_by = 0;
    Time described_at{};
    /// What an earlier session said beside the later one, where the broker stores it: a view that starts
    /// behind that has nothing else.
    struct Stored {
        Really what;
        Time at{};  ///< first
        Time lease_end{};
        Really really(Time now) const;
    };
    std::optional<Stored> in_vain;
    Stored last_in_vain;  ///< the same, also where the broker does not store it
    Time vain_at{};       ///< last, also where its agent is gone since
    /// What the other one said, where an earlier session spoke as the lease of the later one ended: messages
    /// take a while, and the ages of stored ones are whole seconds, so the lease is not over in each view at
    /// the same moment.
    std::optional<Stored> at_end;
    /// The description that the broker keeps, and the word: of whichever session.
    Stored kept;
    Really kept_word;
    /// The broker has a description of the session that counts until then: its lease, or one of an earlier
    /// session behind it, or a later session of which the broker stores nothing.
    Time stored_until{};
    std::vector<const SimAgent*> agents;
    /// All that was said, as "lost unplugged".
    struct Word {
        std::string text;
        /// It is of an earlier session: only views that did not hear the later one then believe it.
        std::optional<Time> unless_heard;
    };
    std::vector<Word> words;

    void say(const Really& what);
    /// Whether a description of this session does: that of an earlier one, after the lease of the later one.
    bool counts(const std::string& by, Time now) const;
    /// An agent's description.
    void describe(const Really& what, const std::string& by, SimBroker::Client over, int lease_seconds,
                  bool stored, Time now);
    /// The description of an earlier session beside a later one.
    void describe_in_vain(const Really& what, int lease_seconds, bool stored, Time now);
    /// `$state` says that the board is gone: the broker in the place of an agent, or one of an earlier
    /// session.
    void word(BoardState state, SimBroker::Client of, Time now);
    bool is_heard() const;
    /// The agent of the session that counts is heard: it takes back words of others. An agent that is heard
    /// beside it is believed behind its lease.
    bool holder_is_heard() const;
    /// Several agents run for the name.
    bool is_disputed() const;
    /// What became of the agent that had the name before `agent`, which is about to start.
    Before before(const SimAgent& agent, Time now) const;
    Really last_word() const;
    Really really(Time now) const;
    /// What a view makes of what the broker keeps: where word and description are nearly of one moment, of
    /// either.
    std::vector<Really> all_kept(Time now) const;
    /// When something new was said last, or a description came, by whichever session.
    Time last_said() const { return std::max({described_at, last_new_word, last_in_vain.at}); }
};

/// A board and its agent: the real Announcer, with what happens to boards, programs, machines and clocks
/// around it.
class SimAgent {
  public:
    SimAgent(SimBroker& broker, Dice& dice, std::string board, BoardTruth& truth, int lease_seconds,
             bool says_state);

    const std::string& board() const { return board_; }
    bool runs() const { return announcer_ != nullptr; }

    /// `clock_skew`: by how much the machine's clock is wrong when the agent starts.
    void start(std::int64_t clock_skew, bool takeover, Time now);
    void stop(Time now);
    /// The process dies; the broker sees its connection close.
    void kill(Time now);
    /// The machine is gone, or the network: the broker notices after a while.
    void cut_off(Time now);
    void heal(Time now);
    /// The broker is gone: nothing is said in its place.
    void lose_broker(Time now);
    bool is_cut_off() const { return announcer_ && client_ == 0; }
    /// The broker takes a connection of it for alive that is not.
    bool waits_for_will() const { return will_due_.has_value(); }
    const std::string& session() const { return announcer_->session(); }

    /// What happens to the board. Nothing is said of one that was never there.
    void becomes(BoardState state, StateReason reason, Time now);

    void tick(Time now);
    std::optional<Time> next() const;

    /// It runs, or a broker takes it for alive.
    bool claims() const { return runs() || will_due_; }
    /// It has something to say of its board, and that reaches the bus.
    bool is_heard() const { return announcer_ && identified_ && client_ != 0 && announcer_->may_publish(); }

  private:
    void connect(Time now);
    void take(const Message& message, Time now);
    void perform(asip::member::Announcements& out, Time now);
    void describe();
    asip::Random random();

    SimBroker& broker_;
    Dice& dice_;
    asip::bus::Topics topics_;
    std::string board_;
    std::string description_topic_;
    BoardTruth& truth_;
    int lease_seconds_;
    bool says_state_;
    bool identified_ = false;
    BoardState state_ = BoardState::kOnline;
    StateReason reason_ = StateReason::kNone;
    Time since_{};
    std::unique_ptr<asip::member::Announcer> announcer_;
    SimBroker::Client client_ = 0;
    // A connection that the broker takes for alive.
    SimBroker::Client lingering_ = 0;
    std::optional<Time> will_due_;
};

}  // namespace truth::presence
