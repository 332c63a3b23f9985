// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "asip/protocol/message.hpp"
#include "tests/truth/board_model.hpp"
#include "tests/truth/command.hpp"
#include "tests/truth/turns.hpp"

namespace truth {

enum class Outcome : std::uint8_t { kExecuted, kUnproven, kBoardError, kDoubt, kNoValue, kTimeout, kNotSent };
constexpr unsigned kOutcomes = 7;
const char* to_string(Outcome outcome);

/// The one final answer of a command.
struct Answer {
    Outcome outcome;
    int code = 0;       ///< kBoardError
    std::string value;  ///< the event that a question asked for
};

struct Counts {
    std::uint64_t histories = 0;
    std::uint64_t commands = 0;
    std::uint64_t refused = 0;
    std::array<std::uint64_t, kOutcomes> outcomes{};
    std::array<std::uint64_t, kFaults> faults{};
    std::uint64_t incidents = 0;
    std::uint64_t not_executed = 0;  ///< `ok` without a digest that left no sign: see Ledger
    std::uint64_t wrong_values = 0;  ///< executed, but the value was changed: without a checksum
    std::uint64_t wrong_summed = 0;  ///< the same with one
    std::uint64_t old_reports = 0;   ///< taken for a value; of a period set before the session began
    std::uint64_t false_errors = 0;  ///< the same for errors
    std::uint64_t equal_digests = 0;
    void add(const Counts& other);
    bool operator==(const Counts&) const = default;
};

/// Knows what was asked for, what went over the line, what the board really did and what was answered, and
/// whether all of that is true.
///
/// Where fences have no digest, as on boards of ASIP 0.4, a request that the line changed into another valid
/// one, or swallowed whole, leaves no sign; nor does, on any board, a reply that the line changed into
/// another valid one of the same checksum. And a session that took the place of another does not know which
/// reports that one had asked for, until the first has come. Such an `ok` is false and excused, and counted:
/// only where damage happened, and where nothing that reached the session while the command was under way was
/// a sign of it.
class Ledger {
  public:
    using Note = std::function<void(const std::string&)>;
    /// `digests`: the board has verified fences, and no `ok` of it is excused.
    Ledger(bool calm, bool digests, Note note) : calm_(calm), digests_(digests), note_(std::move(note)) {}
    std::size_t submitted(Command command, Micros now);
    void refused(std::size_t command, Micros now);
    /// A line of the session goes to the line. Returns its number on the wire.
    std::uint32_t wrote(const std::string& line, Micros now);
    void answered(std::size_t command, Answer answer, Micros now);
    /// The agent ended: what it had not answered is never answered.
    void session_ended(Micros now);

    void board_read(BoardRead read);
    void board_sent(std::uint32_t line, std::string text, Micros now);
    void delivered(std::string_view bytes, Micros now);
    void delivery_cut() { partial_.clear(); }
    void fault(bool to_board, Fault fault, const WireByte& byte, Micros now);

    /// The history is over: every command must have its answer.
    void finish();
    std::size_t open() const { return open_; }
    /// Whether a command with this line was answered `ok`.
    bool was_executed(const std::string& line) const;
    Micros last_deadline() const { return last_deadline_; }

    bool failed() const { return !failure_.empty(); }
    const std::string& failure() const { return failure_; }
    void fail(std::string what);
    Counts counts;

  private:
    enum class State : std::uint8_t { kWaiting, kSent, kEnded };
    struct Entry {
        Command command;
        State state = State::kWaiting;
        Micros submitted = 0;
        Micros deadline = 0;
        Micros sent = kNever;
        Micros ended = kNever;
        bool abandoned = false;
        bool checksum = false;
        bool without_value = false;
        bool executed = false;
        std::uint32_t wire_line = 0;
        std::size_t arrived = 0;  // lines that the session had got when it was sent
    };
    struct Execution {
        BoardRead read;
        int error = -1;
        bool used = false;
    };
    struct Line {
        Micros at;
        std::string text;
    };

    void check_executed(const Entry& entry, const Answer& answer, Micros now);
    void check_error(const Entry& entry, const Answer& answer, Micros now);
    void check_value(const Entry& entry, Micros since, const Answer& answer, Micros now);
    void check_calm(const Entry& entry, const Answer& answer, Micros now);
    bool ambiguous(const Entry& entry) const;
    void check_late(const BoardRead& read);
    void swap_with_twin(Entry& entry);
    Micros sent(const Entry& entry) const;
    Entry* waiting_for(const std::string& line);
    bool may_be_own(const std::string& line) const;
    bool is_restored_level(const std::string& line) const;
    bool is_mode_of_a_duty(const std::string& line) const;
    void take_turn(const Entry& entry);
    bool is_sign(const Entry& entry, const std::string& line, Micros at) const;
    bool merged(const Entry& entry) const;
    bool damage_since(Micros from) const;
    std::optional<std::string> sign_since(const Entry& entry, Micros now) const;
    void untrue(const Entry& entry, std::string what, bool is_value, Micros now);
    bool blames_another(const Entry& entry, Micros then, char service, char tag) const;
    bool may_be_old_report(const Entry& entry) const;
    bool can_be(const Entry& entry, const asip::protocol::Event& event) const;
    bool answers_another(const Entry& entry, Micros at, const asip::protocol::ErrorReply& error) const;
    std::string describe(const Entry& entry) const;

    bool calm_;
    bool digests_;
    Note note_;
    std::string failure_;
    std::vector<Entry> entries_;
    std::unordered_map<std::string, std::vector<std::size_t>> by_line_;
    Turns turns_;
    std::vector<Execution> executions_;
    std::vector<Line> board_lines_;       // as sent
    std::vector<Line> arrived_;           // as the session got them
    std::vector<std::string> values_;     // of answers
    std::vector<Line> fences_;            // how the answers to those with a token begin
    std::vector<bool> damaged_to_board_;  // by number on the wire
    std::vector<Micros> damage_;
    std::string partial_;
    std::size_t open_ = 0;
    Micros last_deadline_ = 0;
    std::uint32_t wire_line_ = 0;
    std::uint32_t began_line_ = 0;   // on the wire, and
    std::size_t began_arrived_ = 0;  // of the board, when the session took the place of another
};

}  // namespace truth
