// SPDX-License-Identifier: Apache-2.0
#include "gateway/api/routes.hpp"

#include <algorithm>

namespace asip::gateway::api {

namespace {

constexpr std::string_view kText = R"({"type":"string"})";
constexpr std::string_view kUsbNumber = R"({"type":"string","pattern":"^[0-9a-f]{4}$"})";
constexpr std::string_view kTruth = R"({"type":"boolean"})";

std::vector<Parameter> query_parameters(bool boards) {
    std::vector<Parameter> result{
        {"board", kText, "Pattern of board names: `*` any text, `?` any one character", R"("uno*")"},
        {"service", kText, "Pattern of service names", R"("dist*")"},
        {"kind", kText, "Names of service models, with commas between them", R"("distance")"},
        {"state", kText, "Effective states, with commas between them", R"("online")"},
        {"chip", kText, "Pattern", R"("ATmega*")"},
        {"sketch", kText, "Pattern", R"("*")"},
        {"unit", kText, "Some event or command of the service has this unit", R"("cm")"},
        {"capability", R"({"type":"string","enum":["digital","analog","pwm"]})", "Some pin can do this",
         R"("pwm")"},
        {"labels", kText, "Selector of labels: `room=lab,floor!=2,camera,!old`; all must hold",
         R"("!retired")"},
        {"sort",
         R"({"type":"string","enum":["name","-name","state","-state","chip","-chip","sketch","-sketch","last_seen","-last_seen"]})",
         "Order", R"("-name")"},
        {"limit", R"({"type":"integer","minimum":1})", "Items a page, at most 1000, with `full` at most 250",
         "10"},
        {"cursor", kText, "`cursor` of the page before", ""},
        {"count", kTruth, "Give `total` even where it costs a scan", "true"}};
    if (boards) {
        result.push_back({"full", kTruth, "Boards with their whole description", "true"});
        result.push_back({"brief", kTruth, "Boards as rows with only what a table shows", "false"});
    }
    return result;
}

std::vector<Parameter> metrics_parameters() {
    return {{"part", kText,
             "Boards of this part alone: of so many, which; what is not of boards is in part 1", "\"1/4\""},
            {"values", kText, "With the last values of these services: BOARD/SERVICE, patterns, with commas",
             "\"*/distance,hall*/pressure\""}};
}

Answer fault(int status, std::string_view about) {
    return {status, about, "Problem", "application/problem+json"};
}

const Parameter kDeadline{"deadline_ms", R"({"type":"integer","minimum":50,"maximum":60000})",
                          "Within what time the answer is needed", "1000"};
const Parameter kHold{"hold_ms", R"({"type":"integer","minimum":50,"maximum":60000})",
                      "Undo the command unless it is renewed within this time", ""};
const Parameter kOnce{"once", kTruth, "Do not keep the board stopped: later commands are executed again",
                      "false"};
const Parameter kWhy{"why", kText, "Told to those whose commands are refused", ""};
const Parameter kIds{"ids", kText, "Only these properties, with commas between their ids", ""};
const Parameter kLastEventId{"last_event_id", kText, "As the header Last-Event-ID", ""};

std::vector<Answer> command_answers() {
    return {{200, "Executed; `proof` names how that is known", "CommandAnswer"},
            fault(400, "Refused: `invalid`"),
            fault(404, "No such board, service or command"),
            fault(409, "Refused: `id-reused`, `stopped` or `denied`"),
            fault(422, "The board refused it: `code`, `error`"),
            fault(429, "Too many commands, of one client or for the board (`queue-full`)"),
            fault(503, "The board or the broker is not there"),
            fault(504, "No proof in time: it may or may not have been executed")};
}

/// Those of an action, and of writing a property.
std::vector<Answer> setting_answers() {
    auto answers = command_answers();
    answers[0] = {204, "The board executed it", ""};
    std::erase_if(answers, [](const Answer& each) { return each.status == 404; });
    answers.push_back(fault(404, "No such thing, or it has no such property or action"));
    return answers;
}

std::vector<Answer> widget_answers() {
    auto answers = setting_answers();
    answers.push_back({200, "Of a stop: the answer of each board", "Stopped"});
    answers.push_back({207, "Of a stop: some boards did not confirm it in time", "Stopped"});
    return answers;
}

std::vector<Answer> label_answers() {
    return {{200, "Kept; `answer` has what is kept now", "CommandAnswer"},
            fault(400, "Refused: `invalid`"),
            fault(404, "No such board"),
            fault(409, "Refused: `id-reused` or `not-kept`"),
            fault(429, "Too many commands of one client"),
            fault(503, "The board's agent or the broker is not there"),
            fault(504, "No answer in time")};
}

std::vector<Answer> load_answers() {
    return {{200, "Loaded, and the board answers: `answer` has what it runs", "CommandAnswer"},
            fault(400, "Refused: `invalid`"),
            fault(404, "No such board"),
            fault(409, "Refused: `speaks-asip`, `released`, `not-loaded` or `id-reused`"),
            fault(429, "Too many commands of one client"),
            fault(503, "The board's agent or the broker is not there"),
            fault(504, "No answer in time; it may go on")};
}

const Answer kNotFound = fault(404, "No such board, service or other thing; the nearest name is in `detail`");
const Answer kNotReady = fault(503, "The broker is not connected");
const Answer kTooMany = fault(429, "Too many; Retry-After: when to try again");
const Answer kUnchanged{304, "Unchanged since the ETag that was sent", ""};

std::vector<Parameter> history_parameters() {
    return {{"limit", R"({"type":"integer","minimum":1,"maximum":1000})", "Items a page", "10"},
            {"cursor", kText, "Of the page before", ""}};
}

std::vector<Parameter> kept_parameters(bool property) {
    std::vector<Parameter> all{
        {"from", kText, "A time; a day before `to` where it is missing", ""},
        {"to", kText, "A time; now", ""},
        {"points", R"({"type":"integer","minimum":1,"maximum":1000})", "At most so many", "10"}};
    if (property) all.insert(all.begin(), {"property", kText, "Its id", R"("distance/0")"});
    return all;
}

const Answer kKeptPoints{
    200,
    "Points, the oldest first: [time, mean, min, max], [time, value], or [time, null] where a gap begins",
    "Page"};

// A row: method, path, id, what it does, what it needs; its parameters, the schema of its body; its answers;
// the function that serves it.
// clang-format off
std::vector<Route> make_routes() {
    return {
        {"GET", "/api/boards", "listBoards", "Boards that match, page by page", Need::kRead, query_parameters(true), "", {{200, "One page", "Page"}, kUnchanged}, get_boards},
        {"GET", "/api/boards/{board}", "getBoard", "One board with its description", Need::kRead, {}, "", {{200, "The board", "Board"}, kUnchanged, kNotFound}, get_board},
        {"DELETE", "/api/boards/{board}", "forgetBoard", "Forget a board that is lost or offline", Need::kForget, {}, "", {{200, "Forgotten", "Forgotten"}, kNotFound, fault(409, "The board lives"), kNotReady, kTooMany}, delete_board},
        {"GET", "/api/boards/{board}/properties", "getProperties", "What can be read and set on a board", Need::kRead, {kIds}, "", {{200, "The list", "PropertyList"}, kNotFound}, get_board_properties},
        {"GET", "/api/boards/{board}/values", "getBoardValues", "How its properties stand", Need::kRead, {kIds, {"past", R"({"type":"integer","minimum":0,"maximum":600,"default":0})", "So many of the last numbers of each, too", "20"}}, "", {{200, "By id", "PropertyValues"}, kNotFound}, get_board_values},
        {"PUT", "/api/boards/{board}/values", "putBoardValue", "Set one property and wait until the board did", Need::kCommand, {kDeadline}, "PropertyByIdValue", setting_answers(), put_board_values},
        {"GET", "/api/boards/{board}/values/stream", "streamBoardValues", "How its properties stand, then each change, as Server-Sent Events", Need::kRead, {{"max_hz", R"({"type":"number","minimum":0,"maximum":1000})", "The newest values of a service at most so often; 0: each", "20"}}, "", {{200, "A stream without end", "EventStream", "text/event-stream"}, kNotFound, kNotReady, kTooMany}, get_board_values_stream},
        {"GET", "/api/boards/{board}/values/kept", "getKeptValues", "How a property was: what a registry keeps of its values", Need::kRead, kept_parameters(true), "", {kKeptPoints, kNotFound, kNotReady, kTooMany}, get_board_values_kept},
        {"GET", "/api/boards/{board}/history", "getBoardHistory", "What a registry keeps of its changes", Need::kRead, history_parameters(), "", {{200, "One page, the newest first", "Page"}, kNotFound, kNotReady, kTooMany}, get_board_history},
        {"GET", "/api/history", "getHistory", "Changes of all boards that a registry keeps", Need::kRead, history_parameters(), "", {{200, "One page, the newest first", "Page"}, kNotFound, kNotReady, kTooMany}, get_history},
        {"GET", "/api/services", "listServices", "Services that match, page by page", Need::kRead, query_parameters(false), "", {{200, "One page", "Page"}, kUnchanged}, get_services},
        {"GET", "/api/boards/{board}/services/{service}", "getService", "A service with its model", Need::kRead, {}, "", {{200, "The service", "Service"}, kNotFound}, get_service},
        {"GET", "/api/boards/{board}/services/{service}/value", "getValue", "The last value of each event; or the next, with `wait`", Need::kRead, {{"wait", R"({"type":"number","minimum":0,"maximum":60})", "Seconds to wait for the next value", "0"}, {"after", kText, "Answer at once when there is a value behind this place", ""}}, "", {{200, "Values by event", "Value"}, kNotFound, kNotReady, kTooMany}, get_value},
        {"GET", "/api/boards/{board}/services/{service}/values", "getValues", "Recent values", Need::kRead, {{"since", kText, "A place or a time: only what came behind it", ""}}, "", {{200, "The oldest first", "Values"}, kNotFound}, get_values},
        {"POST", "/api/boards/{board}/services/{service}/commands/{command}", "sendCommand", "Send a command and wait for its answer", Need::kCommand, {kDeadline, kHold}, "Arguments", command_answers(), post_command},
        {"POST", "/api/boards/{board}/raw", "sendRaw", "Send ASIP request lines", Need::kRaw, {kDeadline}, "RawLines", command_answers(), post_raw},
        {"POST", "/api/boards/{board}/labels", "labelBoard", "Set labels of a board, and friendly names of its services and pins; its agent keeps them", Need::kLabel, {kDeadline}, "LabelChange", label_answers(), post_labels},
        {"POST", "/api/boards/{board}/load", "loadBoard", "Let the agent of a board load firmware of its machine into it; how far it is stands in the board's description", Need::kLabel, {kDeadline}, "Load", load_answers(), post_load},
        {"GET", "/api/boards/{board}/links", "getBoardLinks", "The links from and to a board, each as its agent shows it", Need::kRead, {}, "", {{200, "All that you see", "BoardLinks"}, kNotFound, kNotReady}, get_board_links},
        {"POST", "/api/boards/{board}/links", "changeBoardLink", "Set, remove, enable or disable a link to a board; its agent keeps and executes it", Need::kLabel, {kDeadline}, "BoardLinkChange", label_answers(), post_board_links},
        {"GET", "/api/commands/{id}", "getCommand", "What became of a command of yours; kept for a minute", Need::kCommand, {}, "", {{200, "The command, with its answer if there is one", "Command"}, kNotFound}, get_command},
        {"POST", "/api/commands/{id}/renew", "renewCommand", "Go on holding a command that was sent with `hold_ms`", Need::kCommand, {kHold}, "", {{200, "Held for another while", "CommandAnswer"}, fault(404, "No command of yours has this id"), fault(409, "It is not held: `not-held`"), kNotReady, fault(504, "No agent answered")}, post_renew},
        {"POST", "/api/boards/{board}/stop", "stopBoard", "Bring everything on a board into its safe state, ahead of all that waits, and keep it stopped until it is resumed", Need::kStop, {kOnce, kWhy}, "", {{200, "Stopped", "Stopped"}, {207, "The board did not confirm it in time", "Stopped"}, kNotFound, kNotReady}, post_stop_board},
        {"POST", "/api/stop", "stopAll", "The same on every board, or on those that are named", Need::kStop, {kOnce, kWhy}, "BoardNames", {{200, "All of them are stopped", "Stopped"}, {207, "Some did not confirm it in time", "Stopped"}, kNotReady}, post_stop},
        {"POST", "/api/boards/{board}/resume", "resumeBoard", "Let a board that was stopped take commands again", Need::kResume, {}, "", {{200, "Resumed", "Stopped"}, {207, "Its agent did not answer in time", "Stopped"}, kNotFound, kNotReady}, post_resume_board},
        {"POST", "/api/resume", "resumeAll", "The same for every board that is stopped, or for those that are named", Need::kResume, {}, "BoardNames", {{200, "All of them take commands", "Stopped"}, {207, "Some did not answer in time", "Stopped"}, kNotReady}, post_resume},
        {"GET", "/api/dashboards", "listDashboards", "The dashboards that you may see", Need::kRead, {}, "", {{200, "All of them", "Dashboards"}}, get_dashboards},
        {"GET", "/api/dashboards/{dashboard}", "getDashboard", "One dashboard; its version is the ETag", Need::kShown, {}, "", {{200, "The dashboard", "Dashboard"}, kNotFound, kNotReady}, get_dashboard},
        {"PUT", "/api/dashboards/{dashboard}", "putDashboard", "Make a dashboard, or change it: If-Match has the ETag of the version that is changed", Need::kArrange, {}, "Dashboard", {{200, "Changed", "Dashboard"}, {201, "Made", "Dashboard"}, fault(409, "There are as many as may be, or it is being changed"), fault(412, "It was changed or removed meanwhile, or there is one already (If-None-Match: *)"), fault(428, "There is one already: send If-Match"), kNotReady}, put_dashboard},
        {"DELETE", "/api/dashboards/{dashboard}", "deleteDashboard", "Remove a dashboard, and with it its links", Need::kArrange, {}, "", {{204, "Removed", ""}, kNotFound, fault(409, "It is being changed"), fault(412, "It was changed meanwhile (If-Match)"), kNotReady}, delete_dashboard},
        {"POST", "/api/dashboards/{dashboard}/widgets/{widget}", "useWidget", "Set what a switch or a slider controls, or stop the boards of the dashboard", Need::kUse, {}, "WidgetValue", widget_answers(), post_widget},
        {"GET", "/api/dashboards/{dashboard}/widgets/{widget}/kept", "getWidgetKept", "How the property of a plot was", Need::kShown, kept_parameters(false), "", {kKeptPoints, kNotFound, kNotReady, kTooMany}, get_widget_kept},
        {"POST", "/api/dashboards/{dashboard}/links", "makeLink", "A link that shows its holder this dashboard and nothing else", Need::kArrange, {}, "LinkRequest", {{201, "The link, with its token: it is not shown again", "Link"}, kNotFound, fault(409, "There are as many as may be, or it is being changed"), kNotReady}, post_link},
        {"DELETE", "/api/dashboards/{dashboard}/links/{link}", "deleteLink", "End a link at once", Need::kArrange, {}, "", {{204, "Ended", ""}, kNotFound, fault(409, "It is being changed"), kNotReady}, delete_link},
        {"GET", "/api/lessons", "listLessons", "The lessons that are going on, each with its code", Need::kArrange, {}, "", {{200, "All of them", "Lessons"}}, get_lessons},
        {"POST", "/api/lessons", "openLesson", "Lend boards to whoever knows a code, one to each browser, until an end", Need::kArrange, {}, "LessonRequest", {{201, "The lesson, with its code", "Lesson"}, fault(404, "No board is there that is named so or has the labels"), fault(409, "There are as many lessons as may be, or a board belongs to another one"), kNotReady}, post_lessons},
        {"GET", "/api/lessons/{lesson}", "getLesson", "Its boards, and the pupils who have them", Need::kArrange, {}, "", {{200, "The lesson", "Lesson"}, kNotFound}, get_lesson},
        {"POST", "/api/lessons/{lesson}/take", "takeOver", "End what a pupil may do on its board, which becomes free or stays with the teacher", Need::kArrange, {}, "TakeOver", {{200, "The lesson", "Lesson"}, kNotFound}, post_take_over},
        {"DELETE", "/api/lessons/{lesson}", "endLesson", "End a lesson, with all that its pupils may do and have open", Need::kArrange, {}, "", {{204, "Ended", ""}, kNotFound}, delete_lesson},
        {"POST", "/api/join", "joinLesson", "A board of the lesson that has this code, for this browser: the answer sets a cookie", Need::kNothing, {}, "JoinRequest", {{200, "The board, and until when", "Seat"}, fault(404, "No lesson has this code"), fault(409, "No board is free, or this browser is signed in"), fault(429, "Too many wrong codes of this address, or of all of them: Retry-After")}, post_join},
        {"GET", "/metrics", "getMetrics", "What agents, registries and this gateway count, for Prometheus", Need::kRead, metrics_parameters(), "", {{200, "Metrics", "EventStream", "text/plain; version=0.0.4; charset=utf-8"}, fault(400, "A parameter is wrong"), fault(403, "A kiosk sees its boards only"), fault(404, "Metrics are turned off")}, get_metrics},
        {"GET", "/.well-known/wot", "getDirectory", "The Thing Description of the directory", Need::kRead, {}, "", {{200, "The directory", "Thing", "application/td+json"}, fault(404, "Things are turned off")}, get_directory},
        {"GET", "/things", "listThings", "Thing Descriptions of boards, in the order of names; `Link` names the next page", Need::kRead, {{"offset", R"({"type":"integer","minimum":0})", "How many to leave out", "0"}, {"limit", R"({"type":"integer","minimum":1})", "Things a page, at most 250", "10"}}, "", {{200, "One page", "Things", "application/ld+json"}, fault(404, "Things are turned off")}, get_things},
        {"GET", "/things/{id}", "getThing", "The Thing Description of a board, by its id or the board's name", Need::kRead, {}, "", {{200, "The thing", "Thing", "application/td+json"}, kNotFound}, get_thing},
        {"GET", "/things/{id}/properties", "readProperties", "All properties that have a value", Need::kRead, {}, "", {{200, "Values by name", "Properties"}, kNotFound}, get_properties},
        {"GET", "/things/{id}/properties/{property}", "readProperty", "The value of a property; of a board that reports on demand the next one, which takes up to a second", Need::kRead, {}, "", {{200, "The value", "Anything"}, fault(404, "No such thing or property, or no value yet")}, get_property},
        {"PUT", "/things/{id}/properties/{property}", "writeProperty", "Set a property and wait until the board did", Need::kCommand, {kDeadline}, "PropertyValue", setting_answers(), put_property},
        {"GET", "/things/{id}/properties/{property}/stream", "observeProperty", "Values of a property as Server-Sent Events, at most 5 a second", Need::kRead, {kLastEventId}, "", {{200, "A stream without end", "EventStream", "text/event-stream"}, kNotFound, kNotReady, kTooMany}, get_property_stream},
        {"POST", "/things/{id}/actions/{action}", "invokeAction", "Invoke an action and wait until the board did", Need::kCommand, {kDeadline}, "", setting_answers(), post_action},
        {"GET", "/events", "streamThings", "Things that come, change and go, as Server-Sent Events", Need::kRead, {kLastEventId}, "", {{200, "A stream without end", "EventStream", "text/event-stream"}, fault(404, "Things are turned off"), kNotReady, kTooMany}, get_thing_events},
        {"GET", "/events/{type}", "streamThingsOfType", "The same of one type: thing_created, thing_updated or thing_deleted", Need::kRead, {kLastEventId}, "", {{200, "A stream without end", "EventStream", "text/event-stream"}, fault(404, "No such type, or things are turned off"), kNotReady, kTooMany}, get_thing_events},
        {"GET", "/api/models", "listModels", "The service models", Need::kRead, {}, "", {{200, "All of them", "Models"}}, get_models},
        {"GET", "/api/models/{name}", "getModel", "One service model", Need::kRead, {}, "", {{200, "The model", "Model"}, kNotFound}, get_model},
        {"GET", "/api/events", "streamEvents", "Changes of the catalogue as Server-Sent Events", Need::kRead, {{"board", kText, "Pattern of board names", R"("*")"}, kLastEventId}, "", {{200, "A stream without end", "EventStream", "text/event-stream"}, kNotReady, kTooMany}, get_events},
        {"GET", "/api/boards/{board}/services/{service}/stream", "streamValues", "Values of a service as Server-Sent Events", Need::kRead, {{"max_hz", R"({"type":"number","minimum":0,"maximum":1000})", "The newest value at most so often; 0: each, else at least 0.01", "20"}, kLastEventId}, "", {{200, "A stream without end", "EventStream", "text/event-stream"}, kNotFound, kNotReady, kTooMany}, get_service_stream},
        {"GET", "/api/stream", "stream", "WebSocket: many subscriptions, commands and answers", Need::kShown, {{"session", kText, "Names the session to which ids of commands belong", ""}}, "", {{101, "The protocol is WebSocket from here on", ""}, fault(426, "No WebSocket was asked for"), kTooMany}, get_stream},
        {"GET", "/api/cable", "lendBoard", "WebSocket: the cable to a board in the computer of this browser", Need::kLend, {{"vendor", kUsbNumber, "USB vendor of the board's port", R"("2341")"}, {"product", kUsbNumber, "USB product of the board's port", R"("0043")"}, {"cable", R"({"type":"string","pattern":"^[0-9a-f]{16}$"})", "The page's name for this cable: one that has it already ends", R"("0123456789abcdef")"}}, "", {{101, "The protocol is WebSocket from here on", ""}, fault(404, "No agent takes lent boards here"), fault(426, "No WebSocket was asked for"), kTooMany}, get_cable},
        {"GET", "/api/status", "getStatus", "Broker, registries, this gateway, and what you may do", Need::kShown, {}, "", {{200, "How it is", "Status"}}, get_status},
        {"POST", "/api/codes", "makeCode", "A code that logs a browser in, once, within 30 s", Need::kRead, {}, "", {{200, "The code", "Code"}, kTooMany}, post_code},
        {"DELETE", "/api/session", "endSession", "Log out", Need::kNothing, {}, "", {{204, "Logged out", ""}}, delete_session},
        {"GET", "/api/openapi.json", "getOpenapi", "This document", Need::kNothing, {}, "", {{200, "OpenAPI 3.1", "Anything"}}, get_openapi},
        {"GET", "/healthz", "getHealth", "Whether the gateway runs", Need::kNothing, {}, "", {{200, "It runs", "Health"}}, get_healthz},
        {"GET", "/readyz", "getReady", "Whether the bus is heard and the catalogue complete", Need::kNothing, {}, "", {{200, "It is", "Health"}, kNotReady}, get_readyz},
    };
}
// clang-format on

std::vector<Pattern> split_patterns() {
    std::vector<Pattern> patterns;
    for (const auto& route : routes()) {
        auto& levels = patterns.emplace_back(Pattern{&route, {}}).levels;
        for (auto rest = route.path; !rest.empty();) {
            rest.remove_prefix(1);
            levels.push_back(rest.substr(0, rest.find('/')));
            rest.remove_prefix(levels.back().size());
        }
    }
    return patterns;
}

bool is_parameter(std::string_view level) {
    return level.starts_with('{');
}

bool take_prefix(Inner& inner, std::size_t levels) {
    auto& segments = inner.request.segments;
    if (segments.size() < levels) return false;
    for (std::size_t i = 0; i < levels; ++i)
        inner.prefix += "/" + segments[i];
    segments.erase(segments.begin(), segments.begin() + static_cast<std::ptrdiff_t>(levels));
    return true;
}

}  // namespace

const std::vector<Route>& routes() {
    static const std::vector<Route> all = make_routes();
    return all;
}

const std::vector<Pattern>& patterns() {
    static const auto all = split_patterns();
    return all;
}

// From the end: paths that are as long differ there most often.
bool fits(const Pattern& pattern, const std::vector<std::string>& segments) {
    const auto& levels = pattern.levels;
    return levels.size() == segments.size() &&
           std::equal(levels.rbegin(), levels.rend(), segments.rbegin(), [](auto level, const auto& segment) {
               return is_parameter(level) || level == segment;
           });
}

std::map<std::string, std::string, std::less<>> parameters_of(const Pattern& pattern,
                                                              const std::vector<std::string>& segments) {
    std::map<std::string, std::string, std::less<>> path;
    for (std::size_t i = 0; i < segments.size(); ++i)
        if (const auto level = pattern.levels[i]; is_parameter(level))
            path.emplace(level.substr(1, level.size() - 2), segments[i]);
    return path;
}

bool at_root(const http::Request& request, const std::string& base) {
    const bool kiosk = !request.segments.empty() && request.segments[0] == "kiosk";
    return request.is_asterisk() || (base.empty() && !kiosk);
}

std::optional<Inner> inner_of(const http::Request& request, const std::string& base) {
    Inner inner{request, {}, {}};
    const auto& segments = inner.request.segments;
    if (!base.empty() && (segments.empty() || "/" + segments[0] != base || !take_prefix(inner, 1)))
        return std::nullopt;
    if (segments.size() >= 2 && segments[0] == "kiosk") {
        inner.link = segments[1];
        take_prefix(inner, 2);
    }
    return inner;
}

}  // namespace asip::gateway::api
