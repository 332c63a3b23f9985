#include <algorithm>

#include "asip/protocol/checksum.hpp"
#include "asip/protocol/request.hpp"
#include "asip/session/board_session_impl.hpp"

namespace asip::session {

namespace {

constexpr Duration kGarbageWindow = std::chrono::seconds(10);
constexpr unsigned kGarbageLimit = 3;
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

}  // namespace

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

}  // namespace asip::session
