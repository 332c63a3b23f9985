// SPDX-License-Identifier: Apache-2.0
// A teacher lends boards to those who know a code, and sees who has which; a pupil joins by the code.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <tuple>

#include "asip/bus/registry/query.hpp"
#include "asip/model/board_state.hpp"
#include "asip/program/log.hpp"
#include "asip/text/nearest.hpp"
#include "asip/text/printable.hpp"
#include "gateway/api/routes.hpp"
#include "gateway/http/address.hpp"

namespace asip::gateway::api {
namespace {

using nlohmann::json;
namespace log = program::log;

constexpr std::int64_t kLessonMinutes = 60;
constexpr const char* kLessonForm =
    R"(the body must be {"boards":["uno*"],"minutes":45}, or with "labels":"class=4b" or "lend":true in place of boards)";
// A browser whose lesson is over is told so, and not that a token is needed.
constexpr std::int64_t kCookieSeconds = 12 * 3600;

Lessons& lessons_of(const Call& call) {
    return call.gateway.gate().lessons(call.now());
}

json shown_lesson(const Lesson& lesson) {
    json boards = json::array();
    std::size_t free = lesson.lends ? Lessons::kMaxBoards - lesson.seats.size() : 0;
    for (const auto& seat : lesson.seats) {
        json item{{"board", seat.board}, {"kept", seat.kept}};
        if (!seat.cookie.empty()) item.update({{"pupil", seat.pupil}, {"since", text::iso_time(seat.since)}});
        free += static_cast<std::size_t>(seat.cookie.empty() && !seat.kept);
        boards.push_back(std::move(item));
    }
    return {{"id", lesson.id},
            {"code", lesson.code},
            {"path", "#/join/" + lesson.code},
            {"by", lesson.maker},
            {"until", text::iso_time(lesson.until)},
            {"lend", lesson.lends},
            {"boards", std::move(boards)},
            {"free", free}};
}

/// Null where the call is answered: there is none.
const Lesson* lesson_of(const Call& call) {
    const auto& id = call.path.find("lesson")->second;
    const auto* lesson = lessons_of(call).find(id);
    if (lesson == nullptr)
        send_problem(call, 404, "there is no lesson \"" + text::printable(id) + "\"; it may be over");
    return lesson;
}

struct Wanted {
    std::vector<std::string> boards;  ///< patterns
    std::string labels;
    bool lend = false;  ///< the pupils do
    std::int64_t minutes = kLessonMinutes;
};

Expected<Wanted> read_wanted(const Call& call) {
    const auto body = body_of(call.request);
    if (!body) return Unexpected<std::string>(body.error());
    if (!body->is_object()) return fail(kLessonForm);
    Wanted result;
    for (const auto& [name, value] : body->items()) {
        if (name == "boards" && value.is_array() && !value.empty() && value.size() <= Lessons::kMaxBoards &&
            std::all_of(value.begin(), value.end(), [](const json& each) { return each.is_string(); })) {
            result.boards = value.get<std::vector<std::string>>();
        } else if (name == "labels" && value.is_string()) {
            result.labels = value.get<std::string>();
        } else if (name == "lend" && value.is_boolean()) {
            result.lend = value.get<bool>();
        } else if (name == "minutes" && value.is_number_integer()) {
            result.minutes = value.get<std::int64_t>();
        } else {
            return fail(kLessonForm);
        }
    }
    constexpr auto kMax = std::chrono::duration_cast<std::chrono::minutes>(Lessons::kLongest).count();
    if (result.minutes < 1 || result.minutes > kMax)
        return fail("minutes: must be a whole number from 1 to " + std::to_string(kMax));
    const int ways = int{!result.boards.empty()} + int{!result.labels.empty()} + int{result.lend};
    if (ways != 1) return fail(kLessonForm);
    return result;
}

/// student-2 ahead of student-10.
auto numbered_order(const std::string& name) {
    const auto digits = name.find_last_not_of("0123456789") + 1;
    return std::tuple(name.substr(0, digits), name.size(), name);
}

/// The boards of now: what is labelled later gives no rights. One that is named in full belongs to the lesson
/// though it is lost, and is lent once it is back; so does none that another lesson has.
Expected<std::vector<std::string>> boards_wanted(const Call& call, const Wanted& wanted) {
    std::vector<std::string> names;
    if (wanted.lend) return names;
    auto patterns = wanted.boards;
    if (patterns.empty()) patterns.emplace_back("*");
    for (const auto& pattern : patterns) {
        bus::Query query;
        query.board = pattern;
        query.limit = bus::Query::kMaxPage;
        if (!wanted.labels.empty()) {
            auto selector = bus::LabelSelector::parse(wanted.labels);
            if (!selector) return fail("labels: " + selector.error());
            query.labels = std::move(*selector);
        }
        const bool exact = pattern.find_first_of("*?") == std::string::npos && !pattern.empty();
        const auto found = call.gateway.mirror().find(query, call.now());
        if (!found) return Unexpected<std::string>(found.error());
        for (const auto& each : found->boards)
            if (exact || (!model::is_gone(each.state) && !lessons_of(call).has(each.board)))
                names.push_back(each.board);
    }
    std::sort(names.begin(), names.end(),
              [](const auto& a, const auto& b) { return numbered_order(a) < numbered_order(b); });
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return names;
}

void too_many_tries(const Call& call, Duration wait) {
    const auto seconds = std::chrono::ceil<std::chrono::seconds>(wait).count();
    auto response = problem(429, "too many wrong codes; try again in " + std::to_string(seconds) + " s");
    for (auto& [name, value] : response.headers)
        if (name == "Retry-After") value = std::to_string(seconds);
    call.reply.send(std::move(response));
}

void joined(const Call& call, const Lessons::Joined& seat) {
    const auto& rights = seat.rights;
    const auto pupil = rights.name.substr(0, rights.name.find('@'));
    if (!seat.again && call.gateway.log_rates().take(rights.name, call.now().time))
        log::info("pupil",
                  {{"by", rights.name}, {"board", rights.boards.front()}, {"from", call.peer.address}});
    auto response = json_response({{"pupil", pupil},
                                   {"board", rights.boards.front()},
                                   {"lend", rights.may_lend()},
                                   {"until", text::iso_time(*rights.until)}});
    response.headers = {
        {"Cache-Control", "no-store"},
        {"Set-Cookie", cookie_text(call.gateway, call.gateway.gate().options().cookie, seat.cookie,
                                   std::to_string(kCookieSeconds), call.peer.secure)}};
    call.reply.send(std::move(response));
}

}  // namespace

void get_lessons(Call& call) {
    json items = json::array();
    for (const auto& lesson : lessons_of(call).all())
        items.push_back(shown_lesson(lesson));
    send_json(call, {{"items", std::move(items)}});
}

void get_lesson(Call& call) {
    if (const auto* lesson = lesson_of(call)) send_json(call, shown_lesson(*lesson));
}

void post_lessons(Call& call) {
    if (!bus_is_there(call)) return;
    const auto asked = read_wanted(call);
    if (!asked) return send_problem(call, 400, asked.error());
    const auto boards = boards_wanted(call, *asked);
    if (!boards) return send_problem(call, 400, boards.error());
    if (asked->lend && !has_cables(call)) return;
    if (boards->empty() && !asked->lend)
        return send_problem(call, 404,
                            asked->labels.empty()
                                ? "no board that is there, and in no other lesson, is named so"
                                : "no board that is there, and in no other lesson, has these labels");
    if (boards->size() > Lessons::kMaxBoards)
        return send_problem(call, 400,
                            "a lesson has at most " + std::to_string(Lessons::kMaxBoards) + " boards");
    auto& lessons = lessons_of(call);
    const auto id =
        lessons.open(call.principal.rights, *boards, std::chrono::minutes(asked->minutes), call.now());
    if (!id) return send_problem(call, 409, id.error());
    call.reply.send(json_response(shown_lesson(*lessons.find(*id)), 201));
}

void post_take_over(Call& call) {
    const auto* lesson = lesson_of(call);
    if (lesson == nullptr) return;
    const auto body = body_of(call.request);
    const auto board = body && body->is_object() ? body->find("board") : json::const_iterator();
    const bool named = body && body->is_object() && board != body->end() && board->is_string();
    const auto keep = named ? body->find("keep") : json::const_iterator();
    const bool says = named && keep != body->end();
    if (!named || body->size() != (says ? 2 : 1) || (says && !keep->is_boolean()))
        return send_problem(call, 400, R"(the body must be {"board":"uno3","keep":true})");
    if (!lessons_of(call).take_over(lesson->id, board->get<std::string>(), says && keep->get<bool>())) {
        std::vector<std::string> names;
        for (const auto& seat : lesson->seats)
            names.push_back(seat.board);
        const auto name = board->get<std::string>();
        return send_problem(call, 404,
                            "no board \"" + text::printable(name) + "\" belongs to this lesson" +
                                text::did_you_mean(name, names));
    }
    call.gateway.streams().end_those_without_right(call.now(), call.gateway.gate());
    send_json(call, shown_lesson(*lesson));
}

void delete_lesson(Call& call) {
    const auto* lesson = lesson_of(call);
    if (lesson == nullptr) return;
    lessons_of(call).end(lesson->id);
    call.gateway.streams().end_those_without_right(call.now(), call.gateway.gate());
    http::Response response;
    response.status = 204;
    call.reply.send(std::move(response));
}

// The code stands in the body alone, which no log has.
void post_join(Call& call) {
    const auto body = body_of(call.request);
    if (!body || !body->is_object() || body->size() != 1 || !body->contains("code") ||
        !(*body)["code"].is_string())
        return send_problem(call, 400, R"(the body must be {"code":"CDF347"})");
    auto& gate = call.gateway.gate();
    const auto cookie = gate.cookie_of(call.request);
    if (const auto user = gate.logins().session(cookie, call.now().time))
        return send_problem(
            call, 409, "this browser is signed in as " + user->name + "; sign out first, or use another");
    const auto there = [&](const std::string& board) {
        const auto item = call.gateway.mirror().known(board, call.now());
        return item != nullptr && !model::is_gone(item->state);
    };
    using Outcome = Lessons::Joined::Outcome;
    const auto seat = lessons_of(call).join((*body)["code"].get<std::string>(),
                                            http::network_of(call.peer.address), cookie, there, call.now());
    switch (seat.outcome) {
        case Outcome::kJoined:
            return joined(call, seat);
        case Outcome::kTooManyTries:
            return too_many_tries(call, seat.wait);
        case Outcome::kNoBoardFree:
            return send_problem(call, 409, "no board is free; ask the teacher for one");
        case Outcome::kNoSuchCode:
            return send_problem(call, 404, "no lesson has this code; look at it again, or ask the teacher");
    }
}

}  // namespace asip::gateway::api
