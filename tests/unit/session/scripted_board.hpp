// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "asip/protocol/checksum.hpp"
#include "asip/session/board_session.hpp"

namespace asip::session {

using namespace std::chrono_literals;

/// A board of either generation as far as its peer can know, in plain text. Bytes at a rate it does not have
/// are garbage to both sides. Time passes only when the Bench says so.
class ScriptedBoard {
  public:
    bool extensions = true;
    bool verified_fences = false;
    unsigned baud = 57600;
    bool mute = false;  ///< hears and says nothing
    bool answers_info = true;
    std::string chip = "ATmega328P";
    std::string sketch = "Script";
    std::string stored_name = "uno1";
    std::string services = "ISD";          ///< others are refused
    unsigned fastest_working = 1'000'000;  ///< rates above are accepted and then do not work
    unsigned fastest_allowed = 1'000'000;  ///< rates above are refused
    int lose_lines = 0;                    ///< so many lines from now on are lost on their way to it
    int swallow_fences = 0;                ///< so many fences from now on are lost
    bool checksum = false;
    std::map<std::string, std::string> misreads;  ///< request line to what the line makes of it
    std::map<std::string, int> lost_errors;       ///< request line to the error that does not arrive
    std::map<std::string, std::string> replies;   ///< request line to answer line, before everything else

    std::vector<std::string> executed;  ///< every line that is no question of an interview and no fence
    std::vector<std::string> heard;     ///< every whole line
    bool keeps_writes = false;
    std::vector<std::string> writes;  ///< as they came

    /// What it answers at `host_baud`, now.
    std::string hear(std::string_view bytes, unsigned host_baud, Time now);
    void tick(Time now);
    /// As after power-on: the banner's bytes.
    std::string reboot();
    /// A line as the board sends it.
    std::string framed(const std::string& line) const {
        return (checksum ? protocol::append_checksum(line) : line) + "\r\n";
    }
    std::string banner() const { return "!" + sketch + " running on " + chip + " with Services: I S D \r\n"; }

  private:
    std::string answer(const std::string& line, Time now);
    std::string execute(const std::string& line);
    std::optional<std::string> refusal(const std::string& line) const;

    std::string partial_;
    protocol::Digest digest_;
    std::optional<unsigned> next_baud_;
    std::optional<Time> trial_ends_;
};

/// The session with a board, and time.
class Bench {
  public:
    explicit Bench(SessionOptions options = {}) : session(make_session(options)) {}
    static BoardSession make_session(SessionOptions options, std::uint64_t seed = 1);

    ScriptedBoard board;
    BoardSession session;
    Time now{};
    unsigned host_baud = 57600;
    bool rate_works = true;  ///< what the port says to a change of rate

    std::vector<std::string> lines;  ///< BoardLine
    std::vector<std::pair<std::string, std::optional<ClientId>>> owned_lines;
    std::vector<Finished> finished;
    std::vector<std::string> facts;  ///< "identified", "reset", "silent", "no-answer", "baud N", "garbage"
    std::vector<unsigned> rates;     ///< SetLineRate
    std::size_t most_in_flight = 0;

    void plug(LinkTraits traits = {57600, false});
    void unplug();
    void leave(Leave how = Leave::kOnceQuiet);
    /// Until the session is ready, at most for `limit` of its time.
    bool ready_within(Duration limit = 10s);
    /// Plugs the board in, to a new session where options are given. False: it is not ready.
    bool start() {
        plug();
        return ready_within();
    }
    bool start(const SessionOptions& options) {
        session = make_session(options);
        return start();
    }
    void pass(Duration time);
    /// The board sends this by itself.
    void say(std::string_view bytes);
    /// The same for one line, with a checksum where the board has them on.
    void say_line(const std::string& line);
    RequestId request(std::string_view line, RequestOptions options = {});
    std::optional<Refusal> refused(std::string_view line);
    const Finished* end_of(RequestId id) const;
    /// How it ended, and the line of its answer; nothing: it has not.
    std::optional<Ending> ending(RequestId id) const {
        return end_of(id) ? std::optional(end_of(id)->ending) : std::nullopt;
    }
    std::string answer(RequestId id) const { return end_of(id) ? end_of(id)->answer.text() : std::string(); }
    int count(std::string_view fact) const;
    /// What the board says waits until release().
    void hold() { delivering_ = true; }
    void release() {
        delivering_ = false;
        deliver();
    }
    /// While it is held: what the board has said until now arrives, and what it answers to that waits.
    void release_held();

  private:
    void perform(Actions& actions);
    void perform_all(Actions& actions);
    void deliver();
    void deliver_next();
    void step_to(Time time);

    std::deque<std::string> inbox_;
    bool delivering_ = false;
};

/// With a board that is ready.
struct ReadyBench : Bench {
    explicit ReadyBench(const SessionOptions& options = {}) : Bench(options) {
        if (!start()) throw std::runtime_error("the board is not ready");
    }
};

}  // namespace asip::session
