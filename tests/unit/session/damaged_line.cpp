// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/session/damaged_line.hpp"

#include <algorithm>

#include "asip/protocol/checksum.hpp"

namespace asip::session {

bool DamagedLine::happens(unsigned one_in) {
    if (line_damaged_ || one_in == 0 || random_() % one_in != 0) return false;
    ++faults_done_;
    line_damaged_ = true;
    return true;
}

void DamagedLine::push(std::string_view bytes, Duration byte_time, Time now) {
    last_ = std::max(last_, now);
    for (char c : bytes) {
        const bool ends_line = c == '\n';
        last_ += byte_time;
        if (faults.stalled != 0 && random_() % faults.stalled == 0)
            last_ += std::chrono::milliseconds(random_() % 3000);
        if (happens(faults.changed)) c = static_cast<char>(c ^ (1 << random_() % 8));
        if (!happens(faults.lost)) bytes_.emplace_back(last_, c);
        if (happens(faults.doubled)) bytes_.emplace_back(last_, c);
        // With its end gone, a line goes on in the next one.
        if (ends_line) line_damaged_ = line_damaged_ && (bytes_.empty() || bytes_.back().second != '\n');
    }
}

std::string DamagedLine::take(Time now) {
    std::string arrived;
    while (!bytes_.empty() && bytes_.front().first <= now) {
        arrived += bytes_.front().second;
        bytes_.pop_front();
    }
    return arrived;
}

namespace {

class History {
  public:
    History(std::uint64_t seed, const HistoryOptions& options)
        : options_(options),
          random_(seed),
          session_(Bench::make_session(session_options(options), seed)),
          to_board_(random_),
          from_board_(random_) {
        board_.extensions = options.extensions;
        board_.servo_numbers_twice = true;
        to_board_.faults = options.to_board;
        from_board_.faults = options.from_board;
    }

    Verdict run() {
        link_up();
        const Time end = now_ + options_.length;
        Time next_event = now_ + 1s;
        while (now_ < end) {
            const Time deadline = session_.next_deadline().value_or(Time::max());
            const Time next = std::min({deadline, to_board_.next(), from_board_.next(), next_event, end});
            now_ = std::max(now_ + 1us, next);
            if (now_ >= to_board_.next()) board_hears();
            if (now_ >= from_board_.next()) session_hears();
            if (now_ >= deadline) act([&](Actions& out) { session_.tick(now_, out); });
            if (now_ < next_event) continue;
            something_happens();
            next_event = now_ + std::chrono::milliseconds(1 + random_() % 400);
        }
        settle();
        judge();
        verdict_.faults = to_board_.faults_done() + from_board_.faults_done();
        return std::move(verdict_);
    }

  private:
    struct Command {
        std::string line;
        Time deadline;
        std::optional<Ending> ending;
    };

    static SessionOptions session_options(const HistoryOptions& options) {
        SessionOptions result;
        result.max_baud = options.max_baud;
        result.checksum = options.checksum;
        return result;
    }

    Duration byte_time() const { return std::chrono::nanoseconds(10'000'000'000LL / host_baud_); }

    template <class Call>
    void act(Call&& call) {
        Actions actions;
        call(actions);
        for (std::size_t i = 0; i < actions.size(); ++i)
            perform(actions[i], actions);
        if (session_.bytes_in_flight() > BoardSession::kReceiveBufferBytes)
            violation("more in flight than the board's buffer holds");
    }

    void perform(const Action& action, Actions& more) {
        if (const auto* write = std::get_if<Write>(&action)) {
            check_written(write->bytes);
            if (link_) to_board_.push(write->bytes, byte_time(), now_);
        } else if (const auto* rate = std::get_if<SetLineRate>(&action)) {
            host_baud_ = rate->baud;
            Actions after;
            session_.line_rate_set(true, now_, after);
            for (Action& each : after)
                more.push_back(std::move(each));
        } else if (const auto* end = std::get_if<Finished>(&action)) {
            finished(*end);
        }
    }

    void finished(const Finished& end) {
        const auto it = commands_.find(end.id);
        if (it == commands_.end()) return violation("an unknown request ended");
        Command& command = it->second;
        if (command.ending) violation(command.line + " ended twice");
        if (now_ > command.deadline + 1ms) violation(command.line + " ended after its deadline");
        command.ending = end.ending;
    }

    void check_written(const std::string& bytes) {
        std::size_t at = 0;
        for (std::size_t end; (end = bytes.find('\n', at)) != bytes.npos; at = end + 1) {
            std::string line = bytes.substr(at, end - at);
            if (const auto plain = protocol::verify_checksum(line)) line = std::string(*plain);
            const auto known = by_line_.find(line);
            if (known == by_line_.end()) continue;
            const Command& command = commands_.at(known->second);
            if (command.ending) violation(line + " was sent after its end");
            if (now_ > command.deadline) violation(line + " was sent after its deadline");
        }
    }

    void board_hears() {
        const std::string bytes = to_board_.take(now_);
        if (mute_until_ > now_) return;

        const std::string said = board_.hear(bytes, host_baud_, now_);
        from_board_.push(said, byte_time(), now_);
    }

    void session_hears() {
        const std::string bytes = from_board_.take(now_);

        if (link_) act([&](Actions& out) { session_.receive(bytes, now_, out); });
    }

    void something_happens() {
        const auto what = random_() % 100;
        if (what < 80) return submit();
        if (what < 90) return from_board_.push(board_.framed("@D,e,1,{42}"), byte_time(), now_);
        if (!options_.restarts) return;
        if (what == 90)
            from_board_.push(board_.reboot(), byte_time(), now_);
        else if (what == 91)
            mute_until_ = now_ + std::chrono::milliseconds(random_() % 8000);
        else if (what == 92)
            link_down();
        else if (!link_)
            link_up();
    }

    void submit() {
        const int count = random_() % 4 == 0 ? 8 : 1;
        for (int i = 0; i < count; ++i) {
            const std::string number = std::to_string(++number_);
            const std::string line = "S,W," + number + "," + number;
            RequestOptions wanted;
            wanted.client = random_() % 3;
            wanted.prove = random_() % 4 != 0;
            const Duration limit =
                std::chrono::milliseconds(random_() % 3 == 0 ? 50 + random_() % 500 : 5000);
            wanted.deadline = now_ + limit;
            act([&](Actions& out) {
                const auto id = session_.submit(line, wanted, now_, out);
                if (!id) return;
                commands_[*id] = {line, now_ + limit, std::nullopt};
                by_line_[line] = *id;
            });
        }
    }

    void link_up() {
        link_ = true;
        host_baud_ = 57600;
        board_.reboot();
        act([&](Actions& out) { session_.link_up({57600, false}, now_, out); });
    }

    void link_down() {
        if (!link_) return;
        link_ = false;
        to_board_.clear();
        from_board_.clear();
        act([&](Actions& out) { session_.link_down(now_, out); });
    }

    // All that is still under way arrives, and every deadline passes.
    void settle() {
        const Time end = now_ + 20s;
        while (now_ < end) {
            const Time deadline = session_.next_deadline().value_or(Time::max());
            now_ = std::max(now_ + 1us, std::min({deadline, to_board_.next(), from_board_.next(), end}));
            if (now_ >= to_board_.next()) board_hears();
            if (now_ >= from_board_.next()) session_hears();
            if (now_ >= deadline) act([&](Actions& out) { session_.tick(now_, out); });
        }
    }

    void judge() {
        std::map<std::string, int> executed;
        for (const std::string& line : board_.executed)
            ++executed[line];
        for (const auto& [id, command] : commands_) {
            ++verdict_.commands;
            if (!command.ending) {
                violation(command.line + " was never answered");
                continue;
            }
            const bool done = executed.contains(command.line);
            switch (*command.ending) {
                case Ending::kExecuted:
                    ++verdict_.executed;
                    if (!done) violation(command.line + " is said to be executed, and was not");
                    break;
                case Ending::kNotSent:
                    ++verdict_.not_sent;
                    if (done) violation(command.line + " is said not to be sent, and was executed");
                    break;
                case Ending::kDoubt:
                    ++verdict_.doubts;
                    break;
                default:
                    break;
            }
        }
    }

    void violation(std::string what) { verdict_.violations.push_back(std::move(what)); }

    HistoryOptions options_;
    std::mt19937_64 random_;
    BoardSession session_;
    ScriptedBoard board_;
    DamagedLine to_board_;
    DamagedLine from_board_;
    Time now_{};
    Time mute_until_{};
    unsigned host_baud_ = 57600;
    bool link_ = false;
    int number_ = 100;
    std::map<RequestId, Command> commands_;
    std::map<std::string, RequestId> by_line_;
    Verdict verdict_;
};

}  // namespace

Verdict run_history(std::uint64_t seed, const HistoryOptions& options) {
    return History(seed, options).run();
}

}  // namespace asip::session
