// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/session/scripted_board.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <random>
#include <utility>

#include "asip/protocol/checksum.hpp"

namespace asip::session {

namespace {

const std::map<std::string, std::string> kAnswers{
    {"#,N", "@#,N,3,{I:ASIP core IO,S:Servos,D:Distance}"},
    {"#,S", "@#,S,6,{@,@,I,I,S,D}"},
    {"I,M", "@I,M,6,{4:1,4:2,4:4,4:8,4:10,3:1}"},
    {"I,m", "@I,m,1,{5:0}"},
    {"I,p", "@I,p,6{6,6,1,1,7,7}"},
    {"I,c", "@I,c,6,{1,1,1,5,1,3}"},
};

}  // namespace

std::string ScriptedBoard::reboot() {
    baud = 57600;
    partial_.clear();
    next_baud_.reset();
    trial_ends_.reset();
    checksum = false;
    digest_ = {};
    return banner();
}

void ScriptedBoard::tick(Time now) {
    if (trial_ends_ && now >= *trial_ends_) {
        trial_ends_.reset();
        baud = 57600;
        partial_.clear();
    }
}

std::string ScriptedBoard::hear(std::string_view bytes, unsigned host_baud, Time now) {
    tick(now);
    if (mute) return {};
    if (keeps_writes) writes.emplace_back(bytes);
    const bool works = baud <= fastest_working;
    if (host_baud != baud || !works) {
        partial_ += std::string(bytes.size() / 2, '\x80');
        if (partial_.size() > 100) partial_.clear();
        return {};
    }
    std::string said;
    for (char c : bytes) {
        if (c != '\n') {
            partial_ += c;
            continue;
        }
        std::string line;
        line.swap(partial_);
        if (line.empty()) continue;
        if (lose_lines > 0 && lose_lines-- > 0) continue;
        said += answer(line, now);
        if (next_baud_) {
            baud = *next_baud_;
            next_baud_.reset();
            trial_ends_ = now + 500ms;
            break;
        }
    }
    return said;
}

// What real firmware does not execute: lines that are no request, and services it does not have.
std::optional<std::string> ScriptedBoard::refusal(const std::string& line) const {
    const bool known = line[0] == '#' || services.find(line[0]) != std::string::npos;
    if (!known) return "~Q,?,1{INVALID_SERVICE}";
    const std::string start{'~', line[0], ','};
    if (line.size() < 3) return start + "?,2{UNKNOWN_REQUEST}";
    const char tag = line[2] > ' ' && line[2] < 127 ? line[2] : '?';
    if (line[1] != ',' || (line.size() > 3 && line[3] != ',')) return start + tag + ",2{UNKNOWN_REQUEST}";
    return std::nullopt;
}

std::string ScriptedBoard::answer(const std::string& received, Time) {
    std::string line = received;
    const auto say = [this](const std::string& text) { return framed(text); };
    if (checksum) {
        const auto checked = protocol::verify_checksum(line);
        if (!checked) return say("~#,C,10{BAD_CHECKSUM}");
        line = std::string(*checked);
    }
    while (!checksum && line.ends_with(' '))
        line.pop_back();
    if (const auto other = misreads.find(line); other != misreads.end()) line = other->second;
    heard.push_back(line);
    if (verified_fences && line.starts_with("#,V,")) {
        digest_.add(line);
        if (swallow_fences > 0) return --swallow_fences, std::string();
        return say("@#,V," + line.substr(4) + ',' + std::to_string(std::exchange(digest_, {}).value()));
    }
    const std::string said = execute(line);
    const auto number = said.starts_with('~') ? said.find(',', 3) : std::string::npos;
    const auto lost = lost_errors.find(line);
    const int error = number == std::string::npos ? 0 : std::atoi(said.c_str() + number + 1);
    digest_.add(line, lost == lost_errors.end() ? error : lost->second);
    return said;
}

std::string ScriptedBoard::execute(const std::string& line) {
    const auto say = [this](const std::string& text) { return framed(text); };
    if (const auto error = refusal(line)) return say(*error);
    if (const auto reply = replies.find(line); reply != replies.end()) {
        if (line[0] != '#') executed.push_back(line);
        return reply->second.empty() ? "" : say(reply->second);
    }
    if (line == "#,?") {
        if (!answers_info) return {};
        if (!extensions && swallow_fences > 0) return --swallow_fences, std::string();
        return say("@#,?,0,4," + chip + ",6," + sketch);
    }
    if (const auto known = kAnswers.find(line); known != kAnswers.end()) return say(known->second);
    if (line[0] == '#' && extensions) {
        const std::string rest = line.size() > 4 ? line.substr(4) : "";
        if (line == "#,X")
            return say(verified_fences ? "@#,X,5,{E:1,I:1,B:1,C:1,V:1}" : "@#,X,4,{E:1,I:1,B:1,C:1}");
        if (line == "#,I") return say("@#,I," + stored_name);
        if (line[2] == 'E') {
            const bool token =
                !rest.empty() && rest.size() <= 8 &&
                std::all_of(rest.begin(), rest.end(), [](unsigned char c) { return std::isalnum(c); });
            if (!token) return say("~#,E,11{BAD_ARGUMENT}");
            if (swallow_fences > 0) return --swallow_fences, std::string();
            trial_ends_.reset();
            return say("@#,E," + rest);
        }
        if (line[2] == 'B') {
            const unsigned wanted = static_cast<unsigned>(std::strtoul(rest.c_str(), nullptr, 10));
            if (wanted < 57600 || wanted % 100 != 0 || wanted > fastest_allowed)
                return say("~#,B,11{BAD_ARGUMENT}");
            next_baud_ = wanted;
            return say("@#,B," + rest);
        }
        if (line[2] == 'C') {
            if (rest != "0" && rest != "1") return say("~#,C,11{BAD_ARGUMENT}");
            checksum = rest == "1";
            return {};
        }
    }
    if (line[0] != '#' || line == "#,R") executed.push_back(line);
    if (line[0] == '#' && line != "#,R") return say(std::string("~#,") + line[2] + ",2{UNKNOWN_REQUEST}");
    return {};
}

BoardSession Bench::make_session(SessionOptions options, std::uint64_t seed) {
    return BoardSession(options, [engine = std::mt19937_64(seed)]() mutable { return engine(); });
}

void Bench::plug(LinkTraits traits) {
    host_baud = traits.baud;
    Actions actions;
    session.link_up(traits, now, actions);
    perform(actions);
}

void Bench::unplug() {
    Actions actions;
    session.link_down(now, actions);
    perform(actions);
}

void Bench::leave(Leave how) {
    Actions actions;
    session.leave(how, now, actions);
    perform(actions);
    deliver();
}

void Bench::say_line(const std::string& line) {
    say(board.framed(line));
}

void Bench::say(std::string_view bytes) {
    inbox_.emplace_back(bytes);
    deliver();
}

// What the board answers arrives after everything that was to be done before.
void Bench::perform(Actions& actions) {
    const bool outermost = !std::exchange(delivering_, true);
    perform_all(actions);
    if (!outermost) return;
    delivering_ = false;
    deliver();
}

void Bench::deliver() {
    if (std::exchange(delivering_, true)) return;
    while (!inbox_.empty())
        deliver_next();
    delivering_ = false;
}

void Bench::release_held() {
    for (auto left = inbox_.size(); left > 0; --left)
        deliver_next();
}

void Bench::deliver_next() {
    const std::string bytes = std::move(inbox_.front());
    inbox_.pop_front();
    Actions actions;
    session.receive(bytes, now, actions);
    perform_all(actions);
}

void Bench::perform_all(Actions& actions) {
    most_in_flight = std::max(most_in_flight, session.bytes_in_flight());
    for (Action& action : actions) {
        if (auto* write = std::get_if<Write>(&action)) {
            const std::string said = board.hear(write->bytes, host_baud, now);
            if (!said.empty()) inbox_.push_back(said);
        } else if (auto* rate = std::get_if<SetLineRate>(&action)) {
            rates.push_back(rate->baud);
            if (rate_works) host_baud = rate->baud;
            Actions more;
            session.line_rate_set(rate_works, now, more);
            perform_all(more);
        } else if (auto* line = std::get_if<BoardLine>(&action)) {
            lines.push_back(line->line.text());
            owned_lines.emplace_back(line->line.text(), line->owner);
        } else if (auto* end = std::get_if<Finished>(&action)) {
            finished.push_back(*end);
        } else if (std::holds_alternative<Identified>(action)) {
            facts.emplace_back("identified");
        } else if (std::holds_alternative<BoardReset>(action)) {
            facts.emplace_back("reset");
        } else if (std::holds_alternative<BecameSilent>(action)) {
            facts.emplace_back("silent");
        } else if (std::holds_alternative<NoAnswer>(action)) {
            facts.emplace_back("no-answer");
        } else if (auto* change = std::get_if<LineRateChanged>(&action)) {
            facts.push_back("baud " + std::to_string(change->baud));
        } else if (std::holds_alternative<Garbage>(action)) {
            facts.emplace_back("garbage");
        }
    }
}

void Bench::step_to(Time time) {
    now = time;
    board.tick(now);
    Actions actions;
    session.tick(now, actions);
    perform(actions);
}

void Bench::pass(Duration time) {
    const Time end = now + time;
    while (true) {
        const auto deadline = session.next_deadline();
        if (!deadline || *deadline > end) break;
        step_to(std::max(*deadline, now + 1us));
    }
    now = end;
    board.tick(now);
}

bool Bench::ready_within(Duration limit) {
    const Time end = now + limit;
    while (session.state() != BoardSession::State::kReady) {
        const auto deadline = session.next_deadline();
        if (!deadline || *deadline > end) return false;
        step_to(std::max(*deadline, now + 1us));
    }
    return true;
}

RequestId Bench::request(std::string_view line, RequestOptions options) {
    Actions actions;
    const auto id = session.submit(line, options, now, actions);
    perform(actions);
    return id ? *id : 0;
}

std::optional<Refusal> Bench::refused(std::string_view line) {
    Actions actions;
    const auto id = session.submit(line, {}, now, actions);
    perform(actions);
    if (id) return std::nullopt;
    return id.error();
}

const Finished* Bench::end_of(RequestId id) const {
    auto it = std::find_if(finished.begin(), finished.end(), [&](const Finished& f) { return f.id == id; });
    return it == finished.end() ? nullptr : &*it;
}

int Bench::count(std::string_view fact) const {
    return static_cast<int>(std::count(facts.begin(), facts.end(), fact));
}

}  // namespace asip::session
