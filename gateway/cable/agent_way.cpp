// SPDX-License-Identifier: Apache-2.0
#include "gateway/cable/agent_way.hpp"

#include <sys/socket.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/post.hpp>
#include <utility>

#include "asip/link/stream_base.hpp"

namespace asip::gateway {
namespace {

using Protocol = boost::asio::local::stream_protocol;

class AgentWay final : public CableWay {
  public:
    AgentWay(boost::asio::io_context& io, Handlers handlers) : io_(io), handlers_(std::move(handlers)) {}

    void open(const std::string& path) {
        Protocol::socket socket(io_);
        boost::system::error_code error;
        socket.open(Protocol(), error);
        if (!error) socket.non_blocking(true, error);
        // At once, or refused: connect() of Asio would wait for an agent that takes no connections now.
        const Protocol::endpoint agent(path);
        if (error ||
            ::connect(socket.native_handle(), agent.data(), static_cast<socklen_t>(agent.size())) != 0)
            return boost::asio::post(io_, [this, alive = std::weak_ptr(alive_)] {
                if (!alive.expired()) handlers_.on_end("no agent takes lent boards now");
            });
        stream_ = std::make_unique<link::CoreStream<Protocol::socket>>(std::move(socket), path);
        stream_->start(
            {[this](std::string_view bytes) { received(bytes); },
             [this](const link::StreamError&) { handlers_.on_end("the agent of lent boards has ended"); }});
    }

    void send(link::CableKind kind, std::string_view payload) override {
        if (stream_) stream_->write(link::cable_frame(kind, payload));
    }
    std::size_t unsent_bytes() const override { return stream_ ? stream_->unsent_bytes() : 0; }

  private:
    void received(std::string_view bytes) {
        reader_.take(bytes);
        const auto alive = std::weak_ptr(alive_);
        while (const auto message = alive.expired() ? std::nullopt : reader_.next())
            handlers_.on_message(*message);
    }

    boost::asio::io_context& io_;
    const Handlers handlers_;
    std::unique_ptr<link::ByteStream> stream_;
    link::CableReader reader_;
    std::shared_ptr<const void> alive_ = std::make_shared<char>();
};

}  // namespace

std::unique_ptr<CableWay> agent_way(boost::asio::io_context& io, const std::string& folder,
                                    CableWay::Handlers handlers) {
    auto way = std::make_unique<AgentWay>(io, std::move(handlers));
    way->open(folder + "/gateway");
    return way;
}

}  // namespace asip::gateway
