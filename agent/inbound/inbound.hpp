// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "agent/inbound/arrival.hpp"
#include "asip/bus/request/agent_requests.hpp"
#include "asip/bus/request/request_envelope.hpp"
#include "asip/bus/topics.hpp"
#include "asip/model/labels.hpp"
#include "asip/session/service_table.hpp"

namespace asip::agent {

class CommandAge;

/// A request on BOARD/in, BOARD/SERVICE/in or BOARD/$stop, without its envelope.
struct BusRequest {
    std::string topic;
    std::string service;  ///< name in the topic; empty: the request is for the whole board
    std::string payload;
    bool retained = false;
    bus::RequestEnvelope envelope;  ///< of an unreadable request only `reply` is filled in
    std::string fault{};            ///< why the request cannot be read, for a person; empty: it can
    Arrival arrival{};

    const bus::ReplyTo& reply() const { return envelope.reply; }
    Time deadline() const { return arrival.deadline(envelope.deadline); }
    /// For logs and reports.
    std::string shown() const { return fault.empty() ? envelope.shown() : payload; }
};

// The kinds of messages that an agent gets. Each message is exactly one of them.

/// A command for the board. Stored (retained) and unreadable requests are commands, too: Control refuses
/// them.
struct Command : BusRequest {
    bool stopped = false;  ///< the board was stopped after this command came: it must not be executed
    std::string link{};    ///< the link of this agent that sends it; empty: it came over the bus
};
/// `{"renew":"7"}` or `{"renew":true}` on BOARD/SERVICE/in, where the service has no such command.
struct Renewal : BusRequest {
    std::optional<std::string> id{};  ///< of the command whose hold is renewed; none: all of this client
};
struct Stop : BusRequest {
    std::size_t waiting = 0;  ///< commands that came before this stop and were not handled yet
    bool latch = false;       ///< `"latch":true`: the board stays stopped until it is resumed
    std::string why{};        ///< in the sender's words
};
/// `{"resume":true}` on BOARD/in: a stopped board takes commands again. It overtakes what came meanwhile.
struct Resume : BusRequest {};
struct PortRequest : BusRequest {
    Expected<bus::PortRequest> wanted;
};
struct LabelRequest : BusRequest {
    Expected<model::LabelChange> change;
};
/// On BOARD/$link/USER/CLIENT: USER, as the broker proves it, sets, changes or removes links.
struct LinkRequest : BusRequest {
    std::string user{};
    bool stopped = false;  ///< as of a command: it must not make a link, which may act at once
};
/// How often a client wants values; ReportPeriods parses it.
struct DemandMessage {
    std::string demander;  ///< USER/CLIENT
    std::string payload;
};
/// Retained and to be cleared: a demand, or a topic `set` of an earlier build.
struct Leftover {
    std::string topic;
};
/// For the announcer, which parses it: a probe, or another announcement of this board.
struct Announcement {
    mqtt::Message message;
};

using Inbound = std::variant<Command, Renewal, Stop, Resume, PortRequest, LabelRequest, LinkRequest,
                             DemandMessage, Leftover, Announcement>;

/// What of the board and its agent decides what a message is.
struct Addressee {
    const bus::Topics& topics;
    std::string_view board;
    const session::ServiceTable& services;
    bool client_side = false;  ///< see BridgeOptions::context
};

/// Reads topic and envelope, once; nothing: it is not for this board. Any bytes may be given. Pure.
std::optional<Inbound> read_inbound(const mqtt::Message& message, const Addressee& addressee,
                                    const CommandAge& age, Time now);

/// Null for a demand and an announcement.
const BusRequest* request_of(const Inbound& inbound);
/// One program of one user sent both: answers to both go to the same client.
bool same_client(const BusRequest& a, const BusRequest& b);
/// By the agent's clock in both, `message` was sent behind `stop`.
bool sent_behind(const Stop& stop, const Inbound& message);
/// Whether such a message takes its turn behind earlier ones: commands, and requests for port, labels and
/// links. All other kinds are handled at once; a stop and a renewal must not wait.
bool takes_turns(const Inbound& inbound);
/// In memory, about.
std::size_t bytes_of(const Inbound& inbound);

}  // namespace asip::agent
