// SPDX-License-Identifier: Apache-2.0
#include "agent/clients/point_to_point.hpp"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <utility>

#include "asip/protocol/request_end.hpp"

namespace asip::agent {

namespace {

constexpr Duration kBetweenRefusalLogs = std::chrono::seconds(10);
constexpr Duration kRunsLate = std::chrono::milliseconds(100);

std::string half_error(std::string_view half) {
    const auto letter = [&](std::size_t index) {
        return half.size() > index && half[index] > ' ' && half[index] <= '~' ? half[index] : '?';
    };
    return std::string{'~', letter(0), ',', letter(2)} + ",2{UNKNOWN_REQUEST}";
}

}  // namespace

PointToPoint::PointToPoint(boost::asio::io_context& io, BoardLog& log, Duration silence, ReadsOld reads_old,
                           LineHandler on_line)
    : io_(io),
      log_(log),
      silence_(silence),
      reads_old_(std::move(reads_old)),
      on_line_(std::move(on_line)),
      silence_timer_(io),
      ended_timer_(io) {}

Expected<std::uint16_t, link::StreamError> PointToPoint::listen(const link::TcpAddress& address,
                                                                ClientFraming::Kind framing) {
    using Kind = ClientFraming::Kind;
    const auto silent = address.port == kJavaPort ? Kind::kFrames : Kind::kLines;
    auto listener = link::listen_tcp(
        io_, address, [this, framing, silent](auto stream) { accepted(std::move(stream), framing, silent); });
    if (!listener) return Unexpected<link::StreamError>(listener.error());
    listeners_.push_back(std::move(*listener));
    return listeners_.back()->port();
}

bool PointToPoint::make_room() {
    if (living() < kMaxClients) return true;
    const auto idle =
        std::min_element(clients_.begin(), clients_.end(), [](const Client& a, const Client& b) {
            return std::pair(a.gone, a.heard) < std::pair(b.gone, b.heard);
        });
    const Time now = Clock::now();
    if (now - idle->heard >= kMayBeDropped) {
        drop(*idle, "sent nothing for longest, and another wants its place");
        return true;
    }
    ++refused_;
    if (!refusal_logged_ || now >= *refusal_logged_ + kBetweenRefusalLogs) {
        refusal_logged_ = now;
        log_.warning("client refused: too many", {{"maximum", kMaxClients}, {"refused", refused_}});
    }
    return false;
}

void PointToPoint::accepted(std::unique_ptr<link::ByteStream> stream, ClientFraming::Kind framing,
                            ClientFraming::Kind silent) {
    if (!make_room()) return;
    log_.info("client connected", {{"client", stream->describe()}});
    const Time now = Clock::now();
    const auto client = clients_.insert(
        clients_.end(), Client{next_id_++, std::move(stream), ClientFraming(framing), silent, now, now});
    client->stream->start({[this, client](std::string_view bytes) { received(*client, bytes); },
                           [this, client](const link::StreamError& error) {
                               const bool vanished = error.kind == link::StreamError::Kind::kUnreachable;
                               drop(*client, vanished ? "it does not read, or vanished" : "closed");
                           },
                           [this, client] { input_ended(*client); }});
    watch_silence();
}

void PointToPoint::received(Client& client, std::string_view bytes) {
    client.heard = client.read_until = Clock::now();
    if (const auto since = reads_old_()) client.reads_since = since;
    take(client, client.framing.decode(bytes));
    if (bytes.size() < link::ByteStream::kMaxAtOnce) client.reads_since.reset();
}

void PointToPoint::take(Client& client, std::vector<std::string> lines) {
    for (auto& line : lines)
        client.waiting.push_back({std::move(line), client.reads_since});
    for (const auto& half : client.framing.take_halves()) {
        log_.debug("half a request of a client is not executed", {{"half", half}});
        send(half_error(half), client.id);
    }
    give(client);
}

void PointToPoint::give(Client& client) {
    if (std::exchange(giving_, true)) return;
    while (!client.gone && !client.waiting.empty() &&
           on_line_(client.id, client.waiting.front().text, client.waiting.front().sent)) {
        client.waiting.pop_front();
        client.served = Clock::now();
    }
    if (!client.gone) {
        if (client.waiting.empty() && client.framing.waits_for_silence()) {
            client.read_until = Clock::now();
            watch_silence();
        }
        client.stream->pause_reading(!client.waiting.empty());
    }
    giving_ = false;
}

void PointToPoint::resume() {
    for (Client& client : clients_)
        if (!client.gone && !client.waiting.empty()) give(client);
}

std::size_t PointToPoint::living() const {
    return static_cast<std::size_t>(
        std::count_if(clients_.begin(), clients_.end(), [](const Client& client) { return !client.gone; }));
}

void PointToPoint::drop(Client& client, const char* why) {
    if (std::exchange(client.gone, true)) return;
    log_.info("client gone", {{"client", client.stream->describe()}, {"why", why}});
    client.stream->close();
    boost::asio::post(io_, [this] { clients_.remove_if([](const Client& each) { return each.gone; }); });
}

void PointToPoint::send(std::string_view line, std::optional<session::ClientId> to) {
    for (Client& client : clients_) {
        if (client.gone || (to && *to != client.id)) continue;
        if (client.stream->unsent_bytes() > kMaxUnsentBytes) {
            drop(client, "it does not read");
        } else if (const std::string bytes = client.framing.encode(line); !bytes.empty()) {
            client.stream->write(bytes);
            if (to) client.served = Clock::now();
        }
    }
}

// When what a client sent without line end is complete. While it is read more slowly, and while this process
// did not run, what it sent may wait to be read.
std::optional<Time> PointToPoint::end_of_request(Client& client, Time now) {
    if (!client.framing.waits_for_silence() || !client.waiting.empty()) return std::nullopt;
    if (now >= client.read_until + protocol::kRequestSilence + kRunsLate) client.read_until = now;
    return client.read_until + protocol::kRequestSilence;
}

void PointToPoint::watch_silence() {
    Time next = Time::max();
    const Time now = Clock::now();
    for (Client& client : clients_) {
        if (client.gone) continue;
        if (const auto end = end_of_request(client, now)) {
            if (now < *end)
                next = std::min(next, *end);
            else
                take(client, client.framing.after_silence());
        }
        if (client.framing.kind() != ClientFraming::Kind::kUnknown) continue;
        if (now >= client.connected + silence_)
            client.framing.assume(client.silent);
        else
            next = std::min(next, client.connected + silence_);
    }
    if (next == Time::max()) return;
    silence_timer_.expires_at(next);
    silence_timer_.async_wait([this](boost::system::error_code error) {
        if (!error) watch_silence();
    });
}

void PointToPoint::input_ended(Client& client) {
    client.ended = Clock::now();
    client.heard = {};  // its place is the first that another gets
    close_ended();
}

Time PointToPoint::end_of(const Client& client) {
    const Time latest = *client.ended + kLongestAfterEnd;
    if (!client.waiting.empty()) return latest;
    return std::min(latest, std::max(*client.ended, client.served) + kQuietAfterEnd);
}

void PointToPoint::close_ended() {
    Time next = Time::max();
    const Time now = Clock::now();
    for (Client& client : clients_) {
        if (client.gone || !client.ended) continue;
        if (const Time end = end_of(client); now < end)
            next = std::min(next, end);
        else
            drop(client, "closed");
    }
    if (next == Time::max()) return;
    // What is taken or answered meanwhile moves an end; lines that wait may be taken before the last moment.
    ended_timer_.expires_at(std::min(next, now + kQuietAfterEnd));
    ended_timer_.async_wait([this](boost::system::error_code error) {
        if (!error) close_ended();
    });
}

void PointToPoint::close() {
    silence_timer_.cancel();
    ended_timer_.cancel();
    listeners_.clear();
    // A handler of one of them may be running.
    for (Client& client : clients_)
        if (!std::exchange(client.gone, true)) client.stream->close();
}

}  // namespace asip::agent
