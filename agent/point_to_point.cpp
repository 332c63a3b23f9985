#include "agent/point_to_point.hpp"

#include "asip/program/log.hpp"

namespace asip::agent {

namespace log = program::log;

Expected<std::uint16_t, link::StreamError> PointToPoint::listen(const link::TcpAddress& address) {
    auto listener = link::listen_tcp(io_, address, [this](auto stream) { accepted(std::move(stream)); });
    if (!listener) return Unexpected<link::StreamError>(listener.error());
    listener_ = std::move(*listener);
    return listener_->port();
}

void PointToPoint::accepted(std::unique_ptr<link::ByteStream> stream) {
    if (clients_.size() >= kMostClients) {
        log::warning("client refused: too many", {{"client", stream->describe()}, {"most", kMostClients}});
        return;
    }
    log::info("client connected", {{"client", stream->describe()}});
    const auto client = clients_.insert(clients_.end(), Client{std::move(stream), {}});
    client->stream->start({[this, client](std::string_view bytes) {
                               for (const auto& line : client->framing.decode(bytes))
                                   on_line_(line);
                           },
                           [this, client](const link::StreamError&) { drop(client, "closed"); }});
}

void PointToPoint::drop(std::list<Client>::iterator client, const char* why) {
    log::info("client gone", {{"client", client->stream->describe()}, {"why", why}});
    clients_.erase(client);
}

void PointToPoint::broadcast(std::string_view line) {
    for (auto client = clients_.begin(); client != clients_.end();) {
        const auto here = client++;
        if (here->stream->unsent_bytes() > kMostUnsentBytes) {
            drop(here, "too slow");
        } else {
            here->stream->write(here->framing.encode(line));
        }
    }
}

void PointToPoint::close() {
    listener_.reset();
    clients_.clear();
}

}  // namespace asip::agent
