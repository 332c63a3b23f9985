// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "gateway/gateway.hpp"

namespace asip::gateway::api {

struct Route;

/// One request on its way through the API. It is valid while the route serves it: what is answered later
/// keeps copies of `reply` and of what it needs.
struct Call {
    Gateway& gateway;
    const http::Request& request;
    http::Reply reply;
    Principal principal;
    http::Peer peer;  ///< behind a trusted proxy its client, else the connected program
    const Route& route;
    std::map<std::string, std::string, std::less<>> path;  ///< "board" -> "uno1"

    /// The parameters of the path; only for routes that have them.
    const std::string& board() const { return path.find("board")->second; }
    const std::string& service() const { return path.find("service")->second; }
    Instant now() const { return gateway.now(); }
    bool sees(std::string_view board) const { return principal.rights.sees_board(board); }
    /// The client that is served, for limits: the name of the token, else the address (of IPv6 its network).
    std::string client() const;
    /// What is held for it, beyond what is sent at once.
    Budget::Part part() const { return gateway.budget().part(client()); }
};

/// application/problem+json (RFC 9457).
http::Response problem(int status, const std::string& detail);
http::Response problem(int status, const std::string& detail, nlohmann::json members);
/// It belongs to one asker: a cache may keep it for no other.
http::Response json_response(const nlohmann::json& body, int status = 200);
http::Response text_response(std::string json_text, int status = 200);

/// Answers now, with a sentence for a person or with JSON.
void send_problem(const Call& call, int status, const std::string& detail);
/// A command for a board in such a state.
void send_not_there(const Call& call, const std::string& board, const std::string& state);
void send_json(const Call& call, const nlohmann::json& body);

/// Answers 503 and returns false while the bus is not heard.
bool bus_is_there(const Call& call);
/// Answers 429 and returns false where its client has as many streams as it may.
bool has_room(const Call& call);
/// The board with its state and services (its times may be old), or a 404 that names the nearest.
std::shared_ptr<const bus::BoardItem> board_of(const Call& call);
/// The service of a board, or a 404 that names the nearest.
const bus::ServiceItem* service_of(const Call& call, const bus::BoardItem& board);
/// Null: none describes it.
model::ModelPtr model_of(Gateway& gateway, const bus::BoardItem& board, const std::string& service);

/// The version of what the catalogue says to this asker: another one for other rights.
std::string catalogue_etag(const Call& call);
/// Answers 304 and returns true when the client has this version already.
bool not_modified(const Call& call, const std::string& etag);

/// A number within bounds from a query parameter; `fallback` where it is missing. Error: a sentence.
Expected<double> number_parameter(const Call& call, std::string_view name, double fallback, double min,
                                  double max);
/// The same of a whole number.
Expected<std::int64_t> whole_parameter(const Call& call, std::string_view name, std::int64_t fallback,
                                       std::int64_t min, std::int64_t max);

}  // namespace asip::gateway::api
