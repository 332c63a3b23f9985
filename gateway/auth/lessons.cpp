// SPDX-License-Identifier: Apache-2.0
#include "gateway/auth/lessons.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

#include "asip/link/cable_frames.hpp"

namespace asip::gateway {
namespace {

// Nothing that looks like another one (0 and O, 1 and I, 2 and Z, 5 and S, 6 and G, 8 and B, U and V), and no
// vowels, with which codes could become words.
constexpr std::string_view kCodeAlphabet = "CDFHJKMNPQRTVWXY3479";
constexpr std::string_view kPupilCookie = "lesson.";
constexpr std::size_t kPupilCookieBytes = 32;
constexpr std::size_t kIdDigits = 8;

std::string as_typed(std::string_view code) {
    std::string text;
    for (const char c : code)
        if (c != ' ' && c != '-') text += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return text;
}

Rights rights_on(const Lesson& lesson, const Lesson::Seat& seat) {
    Rights rights;
    rights.role = Role::kOperator;
    rights.name = seat.pupil + "@" + lesson.id;
    rights.boards = {seat.board};
    rights.until = lesson.until;
    rights.maker = lesson.maker;
    rights.maker_mark = lesson.maker_mark;
    rights.lesson = lesson.id;
    if (lesson.lends) rights.place = seat.pupil;
    return rights;
}

void give_back(Lesson::Seat& seat) {
    seat.pupil.clear();
    seat.cookie.clear();
}

}  // namespace

// A byte of a hash is as likely as any other; those beyond a multiple of the letters are passed over.
std::string Lessons::fresh_code() const {
    constexpr unsigned kEven = 256 - 256 % kCodeAlphabet.size();
    std::string code;
    while (code.size() < kCodeLength) {
        const auto digits = hash_of(secrets_(kPupilCookieBytes));
        for (std::size_t i = 0; i + 1 < digits.size() && code.size() < kCodeLength; i += 2) {
            unsigned byte = 0;
            std::from_chars(digits.data() + i, digits.data() + i + 2, byte, 16);
            if (byte < kEven) code += kCodeAlphabet[byte % kCodeAlphabet.size()];
        }
    }
    return code;
}

Expected<std::string> Lessons::open(const Rights& teacher, const std::vector<std::string>& boards,
                                    Duration time, const Instant& now) {
    if (lessons_.size() >= kMaxLessons) return fail("there are as many lessons as may be; end one");
    for (const auto& board : boards)
        if (has(board)) return fail("board " + board + " belongs to a lesson that is going on");
    Lesson lesson;
    lesson.id = hash_of(secrets_(kPupilCookieBytes)).substr(0, kIdDigits);
    const auto taken = [this](const std::string& code) {
        return std::any_of(lessons_.begin(), lessons_.end(),
                           [&](const Lesson& each) { return each.code == code; });
    };
    do
        lesson.code = fresh_code();
    while (taken(lesson.code));
    lesson.maker = teacher.name;
    lesson.maker_mark = teacher.mark();
    lesson.lends = boards.empty();
    for (const auto& board : boards)
        lesson.seats.push_back({board});
    lesson.end = now.time + time;
    lesson.until = now.wall + std::chrono::duration_cast<text::WallTime::duration>(time);
    lessons_.push_back(std::move(lesson));
    return lessons_.back().id;
}

const Lesson* Lessons::find(std::string_view id) const {
    const auto found =
        std::find_if(lessons_.begin(), lessons_.end(), [&](const Lesson& each) { return each.id == id; });
    return found == lessons_.end() ? nullptr : &*found;
}

bool Lessons::has(std::string_view board) const {
    return std::any_of(lessons_.begin(), lessons_.end(), [&](const Lesson& lesson) {
        return std::any_of(lesson.seats.begin(), lesson.seats.end(),
                           [&](const Lesson::Seat& seat) { return seat.board == board; });
    });
}

// Also the right code must wait: otherwise what is refused would tell which is right.
std::optional<Duration> Lessons::wait_of(const std::string& address, Time now) {
    while (!wrong_.empty() && wrong_.front().at + kTryTime <= now)
        wrong_.pop_front();
    std::size_t own = 0;
    std::optional<Time> oldest;
    for (const auto& each : wrong_) {
        if (each.address != address) continue;
        ++own;
        if (!oldest) oldest = each.at;
    }
    if (own >= kTries) return *oldest + kTryTime - now;
    if (wrong_.size() >= kAllTries) return wrong_.front().at + kTryTime - now;
    return std::nullopt;
}

Lessons::Joined Lessons::join(std::string_view code, const std::string& address, std::string_view cookie,
                              const std::function<bool(const std::string& board)>& there,
                              const Instant& now) {
    Joined result;
    if (const auto wait = wait_of(address, now.time)) {
        result.outcome = Joined::Outcome::kTooManyTries;
        result.wait = *wait;
        return result;
    }
    const auto typed = as_typed(code);
    Lesson* lesson = nullptr;
    for (auto& each : lessons_)
        if (equal_in_constant_time(each.code, typed) && now.time < each.end) lesson = &each;
    if (lesson == nullptr) {
        wrong_.push_back({address, now.time});
        return result;
    }
    if (auto rights = rights_of(cookie, now); rights && rights->lesson == lesson->id)
        return {Joined::Outcome::kJoined, std::string(cookie), std::move(*rights), true};
    result = give(*lesson, there, now);
    if (result.outcome == Joined::Outcome::kJoined) leave(cookie);
    return result;
}

// The first number that no lesson has: what is kept under the name of a board serves the next lesson, too.
std::string Lessons::fresh_board() const {
    const auto first = std::string(link::kLentPrefix).append(link::kPupilPlace);
    for (std::size_t number = 1;; ++number)
        if (auto board = first + std::to_string(number); !has(board)) return board;
}

Lessons::Joined Lessons::give(Lesson& lesson, const std::function<bool(const std::string& board)>& there,
                              const Instant& now) {
    const bool full = std::none_of(lesson.seats.begin(), lesson.seats.end(), [](const Lesson::Seat& each) {
        return !each.kept && each.cookie.empty();
    });
    if (lesson.lends && full && lesson.seats.size() < kMaxBoards) lesson.seats.push_back({fresh_board()});
    for (std::size_t i = 0; i < lesson.seats.size(); ++i) {
        auto& seat = lesson.seats[i];
        if (seat.kept || !seat.cookie.empty() || !(lesson.lends || there(seat.board))) continue;
        const auto cookie = std::string(kPupilCookie) + secrets_(kPupilCookieBytes);
        seat.pupil = lesson.lends ? seat.board.substr(link::kLentPrefix.size())
                                  : std::string(link::kPupilPlace) + std::to_string(i + 1);
        seat.cookie = hash_of(cookie);
        seat.since = now.wall;
        return {Joined::Outcome::kJoined, cookie, rights_on(lesson, seat)};
    }
    return {Joined::Outcome::kNoBoardFree};
}

std::optional<Rights> Lessons::rights_of(std::string_view cookie, const Instant& now) const {
    if (!is_cookie(cookie)) return std::nullopt;
    const auto hash = hash_of(cookie);
    for (const auto& lesson : lessons_)
        for (const auto& seat : lesson.seats)
            if (seat.cookie == hash && now.time < lesson.end) return rights_on(lesson, seat);
    return std::nullopt;
}

bool Lessons::is_cookie(std::string_view cookie) {
    return cookie.starts_with(kPupilCookie);
}

void Lessons::leave(std::string_view cookie) {
    if (!is_cookie(cookie)) return;
    const auto hash = hash_of(cookie);
    for (auto& lesson : lessons_)
        for (auto& seat : lesson.seats)
            if (seat.cookie == hash) give_back(seat);
}

bool Lessons::take_over(std::string_view id, std::string_view board, bool keep) {
    for (auto& lesson : lessons_) {
        if (lesson.id != id) continue;
        for (auto& seat : lesson.seats) {
            if (seat.board != board) continue;
            give_back(seat);
            seat.kept = keep;
            return true;
        }
    }
    return false;
}

bool Lessons::end(std::string_view id) {
    return std::erase_if(lessons_, [&](const Lesson& each) { return each.id == id; }) > 0;
}

void Lessons::expire(const Instant& now, const std::function<bool(const Rights& pupil)>& may) {
    std::erase_if(lessons_, [&](const Lesson& each) {
        return each.end <= now.time || each.until <= now.wall || !may(rights_on(each, Lesson::Seat()));
    });
}

}  // namespace asip::gateway
