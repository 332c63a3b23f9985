// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gateway/api/call.hpp"

namespace asip::gateway::api {

/// The right that a client needs. That an answer holds only what the client may see is the operation's own
/// duty: see limits.hpp.
/// kShown: to read something, of the own dashboard if nothing else; kUse: to use a control of a dashboard;
/// kArrange: to make and share dashboards, and to hold lessons.
enum class Need {
    kNothing,
    kShown,
    kRead,
    kCommand,
    kUse,
    kStop,
    kResume,
    kLabel,
    kRaw,
    kLend,
    kArrange,
    kForget
};

/// A parameter behind `?`. One that no route has is refused, and so is one that is given twice.
struct Parameter {
    std::string_view name;
    std::string_view schema;  ///< JSON
    std::string_view about;
    std::string_view example;  ///< JSON; empty: none
};

/// A status that an operation may answer, for the document.
struct Answer {
    int status;
    std::string_view about;
    std::string_view schema;  ///< name of a schema of the document; empty: no body
    std::string_view type = "application/json";
};

/// One operation. The server serves what stands here, and the OpenAPI document is made from it.
struct Route {
    std::string_view method;
    std::string_view path;  ///< "/api/boards/{board}"
    std::string_view id;
    std::string_view about;
    Need need;
    std::vector<Parameter> query;
    std::string_view body;  ///< name of a schema; empty: none
    std::vector<Answer> answers;
    void (*serve)(Call& call);
};

/// Every operation of the gateway. Problems that any of them may answer (400, 401, 403, 421, 429) are not
/// repeated in each.
const std::vector<Route>& routes();

/// Whose request it is; a stop that its asker may send is urgent.
http::Asker asker_of(Gateway& gateway, const http::Request& request);
/// Finds the route and serves the request; also what is none: 404, 405, OPTIONS.
void serve(Gateway& gateway, const http::Request& request, const http::Reply& reply);

// The operations, by file.
void get_boards(Call& call);
void get_board(Call& call);
void delete_board(Call& call);
void get_board_history(Call& call);
void get_board_properties(Call& call);
void get_board_values(Call& call);
void put_board_values(Call& call);
void get_board_values_stream(Call& call);
void get_board_values_kept(Call& call);
void get_history(Call& call);
void get_services(Call& call);
void get_service(Call& call);
void get_value(Call& call);
void get_values(Call& call);
void get_models(Call& call);
void get_model(Call& call);
void post_command(Call& call);
void post_raw(Call& call);
void post_labels(Call& call);
void post_load(Call& call);
void get_board_links(Call& call);
void post_board_links(Call& call);
void get_command(Call& call);
void post_renew(Call& call);
void post_stop_board(Call& call);
void post_stop(Call& call);
void post_resume_board(Call& call);
void post_resume(Call& call);
void get_dashboards(Call& call);
void get_dashboard(Call& call);
void put_dashboard(Call& call);
void delete_dashboard(Call& call);
void post_widget(Call& call);
void get_widget_kept(Call& call);
void get_lessons(Call& call);
void get_lesson(Call& call);
void post_lessons(Call& call);
void post_take_over(Call& call);
void delete_lesson(Call& call);
void post_join(Call& call);
void post_link(Call& call);
void delete_link(Call& call);
void get_events(Call& call);
void get_service_stream(Call& call);
void get_stream(Call& call);
void get_cable(Call& call);
/// Answers 404 and returns false where no agent takes lent boards.
bool has_cables(const Call& call);
void get_status(Call& call);
void post_code(Call& call);
void delete_session(Call& call);
void get_openapi(Call& call);
void get_things(Call& call);
void get_thing(Call& call);
void get_directory(Call& call);
void get_properties(Call& call);
void get_property(Call& call);
void put_property(Call& call);
void get_property_stream(Call& call);
void post_action(Call& call);
void get_thing_events(Call& call);
void get_metrics(Call& call);
void get_healthz(Call& call);
void get_readyz(Call& call);
/// `/` and the files of the page. `kiosk`: whose link it is below; null: none.
void serve_page(Gateway& gateway, const http::Request& request, const http::Reply& reply,
                const http::Peer& peer, const Rights* kiosk);

/// `/?code=CODE`: logs a browser in.
void log_in(Gateway& gateway, const http::Request& request, const http::Peer& peer, const std::string& code,
            const http::Reply& reply);

/// The header Set-Cookie that keeps a session in a browser.
std::string cookie_text(const Gateway& gateway, const std::string& name, const std::string& value,
                        std::string_view max_age_s, bool secure);

std::string openapi_document(const std::vector<Route>& routes, const std::string& base_path);

/// What a session of `who` is called in topics: what a client calls it could be anything.
const std::string& session_name(Gateway& gateway, const std::string& who);
/// Whether a client may call a session so: what it is called is kept.
bool valid_session(std::string_view name);
inline const std::string kSessionForm = "a name of at most 64 bytes";
/// Answers 400 and returns false where the header Asip-Session names none.
bool session_is_valid(const Call& call);
/// The name of the session to which the ids of a request belong: a level of a topic.
std::string session_of(const Call& call);
/// `base_path`: of a proxy; `Location` begins with it.
http::Response response_for(const CommandRecord& record, const std::string& base_path);

/// A command of this request, but for target, topic and payload; or the request is answered: it has a wrong
/// deadline or key, or its client sent too many.
std::optional<Commands::Start> start_of(Call& call);
/// Null where there is none. Fails with a sentence.
Expected<nlohmann::json> body_of(const http::Request& request);
/// Sends it and answers the call with what becomes of it.
void send(Call& call, std::string target, std::string topic, const nlohmann::json& payload);
/// Answers 503 and returns false where the board has no agent that could keep anything.
bool has_agent(const Call& call, const bus::BoardItem& board);
/// Sends a command and answers the call with what becomes of it; `arguments` as its body would have them.
void send_command(Call& call, const bus::BoardItem& board, const bus::ServiceItem& service,
                  const std::string& command, nlohmann::json arguments);
/// Sets a property and answers the call when the board did, with what became of it otherwise.
void set_property(Call& call, const Things::Found& board, const property::Property& property,
                  const nlohmann::json& value);
/// Answers with how it was from `from` to `to` of the request, as a registry kept it; nothing before
/// `oldest`.
void ask_kept(Call& call, const std::string& board, const std::string& property, text::WallTime oldest);
/// Stops these boards and answers when all have answered.
void stop_boards(Call& call, const std::vector<std::string>& boards);

/// For `{"command":"uno1/servo",...}` of a WebSocket. `client`: for limits, Call::client().
void websocket_command(Gateway& gateway, const Principal& principal, const std::string& client,
                       const std::string& session, const nlohmann::json& request,
                       const std::function<void(std::string)>& answer);

/// A route's path in its levels: taken apart once, since each request is compared with many.
struct Pattern {
    const Route* route;
    std::vector<std::string_view> levels;
};
/// The patterns of all routes.
const std::vector<Pattern>& patterns();
bool fits(const Pattern& pattern, const std::vector<std::string>& segments);
/// The parameters in a path that fits.
std::map<std::string, std::string, std::less<>> parameters_of(const Pattern& pattern,
                                                              const std::vector<std::string>& segments);

/// A request as it is behind the prefixes of its path.
struct Inner {
    http::Request request;
    std::string prefix;               ///< "/asip/kiosk/TOKEN"
    std::optional<std::string> link;  ///< the token of a kiosk's link
};
/// Its path has no prefix. `base`: of a proxy, "/asip"; empty: none.
bool at_root(const http::Request& request, const std::string& base);
/// Nothing: it is not below the base path.
std::optional<Inner> inner_of(const http::Request& request, const std::string& base);

}  // namespace asip::gateway::api
