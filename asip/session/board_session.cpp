#include "asip/session/board_session.hpp"

#include <algorithm>

#include "asip/protocol/checksum.hpp"
#include "asip/protocol/limits.hpp"
#include "asip/protocol/line_reader.hpp"
#include "asip/protocol/message.hpp"
#include "asip/protocol/request.hpp"
#include "asip/session/interview.hpp"
#include "asip/session/rate_change.hpp"
#include "asip/session/request_queue.hpp"
#include "asip/session/search.hpp"
#include "asip/session/settings_memory.hpp"

namespace asip::session {

namespace {

constexpr Duration kBootTime = std::chrono::milliseconds(2500);
// A board that gave up a rate, or was left in the middle of a change, is back at its start rate after this.
constexpr Duration kRateGivenUp = std::chrono::milliseconds(650);
constexpr Duration kGarbageWindow = std::chrono::seconds(10);
constexpr unsigned kGarbageLimit = 3;
constexpr unsigned kLostFenceLimit = 2;
constexpr std::size_t kChecksumBytes = 3;
constexpr std::size_t kSampleBytes = 32;

std::string printable_sample(std::string_view text) {
    std::string sample(text.substr(0, kSampleBytes));
    for (char& c : sample)
        if (c < 0x20 || c > 0x7e) c = '?';
    return sample;
}

bool is_text(std::string_view text) {
    return std::all_of(text.begin(), text.end(),
                       [](char c) { return (c >= 0x20 && c <= 0x7e) || c == '\r' || c == '\t'; });
}

void sooner(std::optional<Time>& deadline, std::optional<Time> other) {
    if (other && (!deadline || *other < *deadline)) deadline = other;
}

}  // namespace

class BoardSession::Impl {
  public:
    explicit Impl(SessionOptions options) : options_(options) {}

    void link_up(const LinkTraits& traits, Time now, Actions& out);
    void link_down(Actions& out);
    void receive(std::string_view bytes, Time now, Actions& out);
    void tick(Time now, Actions& out);
    void line_rate_set(bool ok, Time now, Actions& out);
    Expected<RequestId, Refusal> submit(std::string_view line, const RequestOptions& request, Time now,
                                        Actions& out);
    std::optional<Time> next_deadline() const;

    SessionOptions options_;
    State state_ = State::kDown;
    Identity identity_;
    SessionCounters counters_;
    SettingsMemory settings_;
    RequestQueue queue_;
    unsigned baud_ = 0;

  private:
    void search(Time quiet_until, Time now, Actions& out);
    void search_step(Time now, Actions& out);
    void interview(Time now, Actions& out);
    void follow_interview(Time now, Actions& out);
    void set_up_line(Time now, Actions& out);
    void follow_rate_change(Time now, Actions& out);
    void become_ready(Time now, Actions& out);
    void board_restarted(std::string why, Time now, Actions& out);
    void fall_silent(Time now, Actions& out);

    void on_line(std::string_view line, Time now, Actions& out);
    void on_message(const protocol::Event& event, std::string_view line, Time now, Actions& out);
    void on_message(const protocol::ErrorReply& error, std::string_view line, Time now, Actions& out);
    void on_message(const protocol::Info& info, std::string_view line, Time now, Actions& out);
    void on_message(const protocol::Malformed& malformed, std::string_view line, Time now, Actions& out);
    void garbage(std::string reason, std::string_view line, Time now, Actions& out);
    bool take_checksum(std::string_view& line, Time now, Actions& out);

    void write(const std::vector<std::string>& lines, Actions& out);
    void set_rate(unsigned baud, std::string why, Actions& out);
    void pump(Time now, Actions& out);
    void report(std::vector<RequestQueue::End>& ended, Time now, Actions& out);
    void executed(const RequestQueue::Request& request, Time now, Actions& out);

    bool link_has_rates() const { return start_baud_ != 0; }

    protocol::LineReader reader_;
    std::uint64_t overlong_seen_ = 0;
    Search search_;
    Interview interview_;
    RateChange rate_change_;
    unsigned start_baud_ = 0;
    RequestId next_id_ = 1;
    bool known_ = false;           // identified at least once, since construction
    bool was_silent_ = false;      // state to report while searching
    bool no_answer_said_ = false;  // since link_up, or need not be: it answered
    bool checksum_on_ = false;
    bool restore_ = false;
    std::string banner_services_;
    unsigned suspect_baud_ = 0;  // rate at which there was too much garbage
    unsigned ready_baud_ = 0;    // rate at which the board was last ready
    Time link_up_at_{};
    Time last_heard_{};
    Time window_start_{};
    unsigned window_garbage_ = 0;
};

// --- link

void BoardSession::Impl::link_up(const LinkTraits& traits, Time now, Actions& out) {
    start_baud_ = traits.baud;
    baud_ = traits.baud;
    reader_.reset();
    checksum_on_ = false;
    no_answer_said_ = false;
    was_silent_ = false;
    counters_.bytes_in = 0;
    suspect_baud_ = 0;
    ready_baud_ = traits.baud;
    link_up_at_ = last_heard_ = now;
    banner_services_.clear();
    rate_change_.forget_bad();
    restore_ = known_;
    search(traits.restarting ? now + kBootTime : now, now, out);
}

void BoardSession::Impl::link_down(Actions& out) {
    state_ = State::kDown;
    rate_change_.cancel();
    std::vector<RequestQueue::End> ended;
    queue_.abandon_in_flight(ended);
    queue_.abandon_waiting(ended);
    report(ended, {}, out);
}

void BoardSession::Impl::set_rate(unsigned baud, std::string why, Actions& out) {
    if (baud == baud_ || !link_has_rates()) return;
    baud_ = baud;
    reader_.reset();
    out.emplace_back(SetLineRate{baud});
    if (!why.empty()) out.emplace_back(LineRateChanged{baud, std::move(why)});
}

void BoardSession::Impl::line_rate_set(bool ok, Time now, Actions& out) {
    if (rate_change_.step() != RateChange::Step::kSwitching) return;
    std::vector<std::string> lines;
    rate_change_.on_rate_set(ok, now, lines);
    write(lines, out);
    follow_rate_change(now, out);
}

void BoardSession::Impl::write(const std::vector<std::string>& lines, Actions& out) {
    if (lines.empty()) return;
    std::string bytes;
    for (const std::string& line : lines) {
        bytes += checksum_on_ && !line.empty() ? protocol::append_checksum(line) : line;
        bytes += '\n';
    }
    counters_.bytes_out += bytes.size();
    out.emplace_back(Write{std::move(bytes)});
}

// --- finding the board

void BoardSession::Impl::search(Time quiet_until, Time now, Actions& out) {
    state_ = was_silent_ ? State::kSilent : State::kSearching;
    rate_change_.cancel();
    reader_.reset();
    std::vector<RequestQueue::End> ended;
    queue_.abandon_in_flight(ended);
    report(ended, now, out);
    search_.start(start_baud_, link_has_rates(), quiet_until, now);
    search_step(now, out);
}

void BoardSession::Impl::search_step(Time now, Actions& out) {
    const Search::Step step = search_.next(now);
    set_rate(step.baud, {}, out);
    if (!step.ask) return;
    const bool with_checksum = std::exchange(checksum_on_, false);
    std::vector<std::string> lines;
    if (step.newline_first) lines.emplace_back();
    lines.emplace_back(protocol::kAskInfo);
    write(lines, out);
    checksum_on_ = with_checksum;
}

void BoardSession::Impl::interview(Time now, Actions& out) {
    state_ = State::kIdentifying;
    checksum_on_ = false;
    if (suspect_baud_ != 0 && suspect_baud_ == baud_) rate_change_.mark_bad(baud_);
    suspect_baud_ = 0;
    if (baud_ == start_baud_ && std::exchange(ready_baud_, baud_) != baud_) {
        ++counters_.resets;
        out.emplace_back(BoardReset{"it is at its start rate again"});
    }
    std::vector<std::string> lines;
    interview_.start(banner_services_, now, lines);
    write(lines, out);
}

void BoardSession::Impl::follow_interview(Time now, Actions& out) {
    if (state_ != State::kIdentifying || rate_change_.busy()) return;
    if (interview_.progress() == Interview::Progress::kFailed) return search(now, now, out);
    if (interview_.progress() == Interview::Progress::kDone) set_up_line(now, out);
}

void BoardSession::Impl::set_up_line(Time now, Actions& out) {
    const Identity& found = interview_.identity();
    queue_.use_echo(found.extensions.has(protocol::kEcho));
    const bool can = link_has_rates() && options_.max_baud != 0 &&
                     found.extensions.has(protocol::kLineRate) && found.extensions.has(protocol::kEcho);
    const unsigned best = can ? rate_change_.best(options_.max_baud) : baud_;
    if (best == baud_) return become_ready(now, out);
    std::vector<std::string> lines;
    rate_change_.start(best, now, lines);
    write(lines, out);
}

void BoardSession::Impl::follow_rate_change(Time now, Actions& out) {
    switch (rate_change_.step()) {
        case RateChange::Step::kSwitching:
            set_rate(rate_change_.baud(), {}, out);
            break;
        case RateChange::Step::kDone:
            out.emplace_back(LineRateChanged{baud_, "stepped up"});
            rate_change_.cancel();
            become_ready(now, out);
            break;
        case RateChange::Step::kFailed:
            rate_change_.cancel();
            if (rate_change_.refused()) return set_up_line(now, out);
            out.emplace_back(LineRateChanged{
                start_baud_, std::to_string(rate_change_.baud()) + " baud does not work here"});
            search(now + kRateGivenUp, now, out);
            break;
        default:
            break;
    }
}

void BoardSession::Impl::become_ready(Time now, Actions& out) {
    const bool changed = !known_ || !same_board(identity_, interview_.identity());
    identity_ = interview_.identity();
    known_ = true;
    no_answer_said_ = true;
    was_silent_ = false;
    state_ = State::kReady;
    ready_baud_ = baud_;
    last_heard_ = now;
    window_garbage_ = 0;
    queue_.restart();
    if (options_.checksum && identity_.extensions.has(protocol::kChecksum) &&
        identity_.extensions.has(protocol::kEcho)) {
        write({protocol::set_checksum(true)}, out);
        checksum_on_ = true;
    }
    queue_.set_line_overhead(checksum_on_ ? kChecksumBytes : 0);
    if (restore_) {
        auto lines = settings_.restore();
        for (auto line = lines.rbegin(); line != lines.rend(); ++line) {
            RequestQueue::Request request;
            request.line = *line;
            queue_.push_front(std::move(request));
        }
    }
    restore_ = true;
    out.emplace_back(Identified{changed});
    pump(now, out);
}

void BoardSession::Impl::board_restarted(std::string why, Time now, Actions& out) {
    ++counters_.resets;
    out.emplace_back(BoardReset{std::move(why)});
    std::vector<RequestQueue::End> ended;
    queue_.abandon_in_flight(ended);
    report(ended, now, out);
    rate_change_.cancel();
    interview(now, out);
}

void BoardSession::Impl::fall_silent(Time now, Actions& out) {
    was_silent_ = true;
    out.emplace_back(BecameSilent{});
    std::vector<RequestQueue::End> ended;
    queue_.abandon_in_flight(ended);
    queue_.abandon_waiting(ended);
    report(ended, now, out);
    search(now, now, out);
}

// --- lines

void BoardSession::Impl::receive(std::string_view bytes, Time now, Actions& out) {
    if (state_ == State::kDown) return;
    counters_.bytes_in += bytes.size();
    reader_.push(bytes, [&](std::string_view line) { on_line(line, now, out); });
    if (state_ == State::kReady && baud_ != start_baud_ && !is_text(reader_.partial())) {
        // At a wrong rate a line end may never come.
        const std::string noise(reader_.partial());
        reader_.reset();
        garbage("not text", noise, now, out);
    }
    if (reader_.overlong_lines() != overlong_seen_) {
        overlong_seen_ = reader_.overlong_lines();
        garbage("line too long", {}, now, out);
    }
}

void BoardSession::Impl::on_line(std::string_view line, Time now, Actions& out) {
    ++counters_.lines_in;
    if (state_ == State::kSearching || state_ == State::kSilent) {
        // Whoever talked to the board before may have left checksums on.
        if (const auto text = protocol::verify_checksum(line)) line = *text;
    } else if (checksum_on_ && !take_checksum(line, now, out)) {
        return;
    }
    std::visit([&](const auto& message) { on_message(message, line, now, out); }, protocol::parse_line(line));
}

bool BoardSession::Impl::take_checksum(std::string_view& line, Time now, Actions& out) {
    const auto checked = protocol::verify_checksum(line);
    if (checked) {
        line = *checked;
        return true;
    }
    // A banner has none: the board restarted and knows nothing of checksums any more.
    if (!line.empty() && line.front() == '!') return true;
    ++counters_.checksum_errors;
    garbage("checksum missing or wrong", line, now, out);
    return false;
}

void BoardSession::Impl::on_message(const protocol::Event& event, std::string_view line, Time now,
                                    Actions& out) {
    last_heard_ = now;
    std::vector<std::string> lines;
    if (rate_change_.busy() && rate_change_.on_event(event, now, lines)) {
        write(lines, out);
        return follow_rate_change(now, out);
    }
    if (state_ == State::kIdentifying && interview_.on_event(event, now, lines)) {
        write(lines, out);
        return follow_interview(now, out);
    }
    if (state_ == State::kSearching || state_ == State::kSilent) {
        if (event.service == '#' && event.tag == '?') return interview(now, out);
        search_.heard();
    }
    if (state_ != State::kReady) {
        // Answers to questions that were asked twice are nobody's.
        if (event.service != '#') out.emplace_back(BoardLine{std::string(line)});
        return;
    }
    std::vector<RequestQueue::End> ended;
    if (!queue_.on_event(event, line, ended)) out.emplace_back(BoardLine{std::string(line)});
    report(ended, now, out);
    pump(now, out);
}

void BoardSession::Impl::on_message(const protocol::ErrorReply& error, std::string_view line, Time now,
                                    Actions& out) {
    last_heard_ = now;
    std::vector<std::string> lines;
    if (rate_change_.busy() && rate_change_.on_error(error)) return follow_rate_change(now, out);
    if (state_ == State::kIdentifying && interview_.on_error(error, now, lines)) {
        write(lines, out);
        return follow_interview(now, out);
    }
    if (state_ == State::kSearching || state_ == State::kSilent) {
        search_.heard();
        // Left with checksums on by somebody before us. The answer came with one, which parsing took for
        // text.
        if (error.service == '#' && error.tag == 'C')
            write({protocol::append_checksum(protocol::set_checksum(false)), std::string(protocol::kAskInfo)},
                  out);
        return;
    }
    std::vector<RequestQueue::End> ended;
    queue_.on_error(error, ended);
    out.emplace_back(BoardLine{std::string(line)});
    report(ended, now, out);
}

void BoardSession::Impl::on_message(const protocol::Info& info, std::string_view line, Time now,
                                    Actions& out) {
    last_heard_ = now;
    const auto banner = protocol::parse_banner(info.text);
    // Half a banner is one, too: its end cannot come from anything else.
    const bool half = !banner && info.text.find(" with Services:") != std::string_view::npos;
    out.emplace_back(BoardLine{std::string(line)});
    if (!banner && !half) return;
    if (banner) banner_services_ = banner->services;
    if (state_ == State::kReady) return board_restarted("it said its banner", now, out);
    interview(now, out);
}

void BoardSession::Impl::on_message(const protocol::Malformed& malformed, std::string_view line, Time now,
                                    Actions& out) {
    if (line.find(" with Services:") != std::string_view::npos && state_ == State::kReady)
        return board_restarted("it said its banner, of which the beginning is lost", now, out);
    garbage(std::string(malformed.reason), line, now, out);
}

void BoardSession::Impl::garbage(std::string reason, std::string_view line, Time now, Actions& out) {
    ++counters_.garbage;
    out.emplace_back(Garbage{std::move(reason), printable_sample(line)});
    if (rate_change_.busy()) {
        rate_change_.on_garbage();
        return follow_rate_change(now, out);
    }
    if (state_ != State::kReady || baud_ == start_baud_) return;
    // At a fast rate, garbage means that the board restarted and talks at its start rate, or that the rate is
    // too fast.
    if (now > window_start_ + kGarbageWindow) {
        window_start_ = now;
        window_garbage_ = 0;
    }
    if (++window_garbage_ < kGarbageLimit) {
        queue_.probe();
        return pump(now, out);
    }
    suspect_baud_ = baud_;
    search(now, now, out);
}

// --- requests

Expected<RequestId, Refusal> BoardSession::Impl::submit(std::string_view line, const RequestOptions& wanted,
                                                        Time now, Actions& out) {
    while (!line.empty() && (line.back() == '\n' || line.back() == '\r'))
        line.remove_suffix(1);
    const auto request = protocol::parse_request(line);
    // The line rate and checksums are between the board and us.
    if (!request || (request->service == '#' && (request->tag == 'B' || request->tag == 'C')))
        return Unexpected<Refusal>(Refusal::kInvalid);
    if (state_ == State::kDown || state_ == State::kSilent || !known_)
        return Unexpected<Refusal>(Refusal::kNoBoard);
    if (queue_.waiting() >= kMaxQueued) return Unexpected<Refusal>(Refusal::kQueueFull);
    RequestQueue::Request queued;
    queued.id = next_id_++;
    queued.line = std::string(line);
    queued.prove = wanted.prove;
    queued.answer_tag = wanted.answer_tag;
    queued.alone = request->service != '#' && !identity_.find_service(request->service);
    const RequestId id = queued.id;
    queue_.push(std::move(queued));
    if (state_ == State::kReady) pump(now, out);
    return id;
}

void BoardSession::Impl::pump(Time now, Actions& out) {
    if (state_ == State::kReady) write(queue_.pump(now), out);
}

void BoardSession::Impl::report(std::vector<RequestQueue::End>& ended, Time now, Actions& out) {
    for (auto& end : ended) {
        if (end.ending == Ending::kExecuted || end.ending == Ending::kUnproven)
            executed(end.request, now, out);
        if (end.ending == Ending::kBoardError) settings_.refused(end.request.line);
        if (end.request.id == 0) continue;
        out.emplace_back(
            Finished{end.request.id, end.ending, end.code, std::move(end.text), std::move(end.answer)});
    }
    ended.clear();
}

void BoardSession::Impl::executed(const RequestQueue::Request& request, Time, Actions&) {
    settings_.executed(request.line);
    const auto mode = parse_mode_request(request.line);
    if (mode && static_cast<std::size_t>(mode->pin) < identity_.pin_modes.size())
        identity_.pin_modes[static_cast<std::size_t>(mode->pin)] = static_cast<protocol::PinMode>(mode->mode);
}

// --- time

void BoardSession::Impl::tick(Time now, Actions& out) {
    if (state_ == State::kDown) return;
    std::vector<std::string> lines;
    if (rate_change_.busy()) {
        rate_change_.on_deadline(now, lines);
        write(lines, out);
        return follow_rate_change(now, out);
    }
    if (state_ == State::kIdentifying) {
        interview_.on_deadline(now, options_.answer_timeout, lines);
        write(lines, out);
        return follow_interview(now, out);
    }
    if (state_ == State::kSearching || state_ == State::kSilent) {
        if (!no_answer_said_ && now >= link_up_at_ + options_.patience) {
            no_answer_said_ = true;
            out.emplace_back(NoAnswer{counters_.bytes_in > 0});
        }
        if (now >= search_.next_deadline()) search_step(now, out);
        return;
    }
    std::vector<RequestQueue::End> ended;
    const auto timeouts = queue_.fence_timeouts();
    queue_.on_deadline(now, options_.answer_timeout, ended);
    report(ended, now, out);
    counters_.fence_timeouts = queue_.fence_timeouts();
    const bool lost_one = counters_.fence_timeouts != timeouts;
    const bool heard_since = now - last_heard_ < options_.answer_timeout;
    if (lost_one && (!heard_since || queue_.lost_fences() >= kLostFenceLimit)) return fall_silent(now, out);
    if (now >= last_heard_ + options_.silence) queue_.probe();
    pump(now, out);
}

std::optional<Time> BoardSession::Impl::next_deadline() const {
    if (state_ == State::kDown) return std::nullopt;
    if (rate_change_.busy()) return rate_change_.next_deadline();
    if (state_ == State::kIdentifying) return interview_.next_deadline(options_.answer_timeout);
    std::optional<Time> deadline;
    if (state_ == State::kReady) {
        sooner(deadline, queue_.next_deadline(options_.answer_timeout));
        if (queue_.idle()) sooner(deadline, last_heard_ + options_.silence);
        return deadline;
    }
    sooner(deadline, search_.next_deadline());
    if (!no_answer_said_) sooner(deadline, link_up_at_ + options_.patience);
    return deadline;
}

// --- the public face

BoardSession::BoardSession(SessionOptions options) : impl_(std::make_unique<Impl>(options)) {}
BoardSession::~BoardSession() = default;
BoardSession::BoardSession(BoardSession&&) noexcept = default;
BoardSession& BoardSession::operator=(BoardSession&&) noexcept = default;

void BoardSession::link_up(const LinkTraits& traits, Time now, Actions& out) {
    impl_->link_up(traits, now, out);
}
void BoardSession::link_down(Time, Actions& out) {
    impl_->link_down(out);
}
void BoardSession::receive(std::string_view bytes, Time now, Actions& out) {
    impl_->receive(bytes, now, out);
}
void BoardSession::tick(Time now, Actions& out) {
    impl_->tick(now, out);
}
void BoardSession::line_rate_set(bool ok, Time now, Actions& out) {
    impl_->line_rate_set(ok, now, out);
}
Expected<RequestId, Refusal> BoardSession::submit(std::string_view line, const RequestOptions& request,
                                                  Time now, Actions& out) {
    return impl_->submit(line, request, now, out);
}
std::optional<Time> BoardSession::next_deadline() const {
    return impl_->next_deadline();
}
BoardSession::State BoardSession::state() const {
    return impl_->state_;
}
const Identity& BoardSession::identity() const {
    return impl_->identity_;
}
unsigned BoardSession::baud() const {
    return impl_->baud_;
}
std::size_t BoardSession::bytes_in_flight() const {
    return impl_->queue_.bytes_in_flight();
}
std::size_t BoardSession::queued() const {
    return impl_->queue_.waiting();
}
const SessionCounters& BoardSession::counters() const {
    return impl_->counters_;
}
std::optional<unsigned> BoardSession::period(char service) const {
    return impl_->settings_.period(service);
}

const char* to_string(BoardSession::State state) {
    switch (state) {
        case BoardSession::State::kDown:
            return "down";
        case BoardSession::State::kSearching:
            return "searching";
        case BoardSession::State::kIdentifying:
            return "identifying";
        case BoardSession::State::kReady:
            return "ready";
        case BoardSession::State::kSilent:
            return "silent";
    }
    return "?";
}

const char* to_string(Refusal refusal) {
    switch (refusal) {
        case Refusal::kInvalid:
            return "invalid";
        case Refusal::kQueueFull:
            return "queue-full";
        case Refusal::kNoBoard:
            return "board-not-there";
    }
    return "?";
}

const char* to_string(Ending ending) {
    switch (ending) {
        case Ending::kExecuted:
            return "executed";
        case Ending::kUnproven:
            return "unproven";
        case Ending::kBoardError:
            return "error";
        case Ending::kTimeout:
            return "timeout";
        case Ending::kNotSent:
            return "not sent";
    }
    return "?";
}

}  // namespace asip::session
