// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "asip/client/transport.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <memory>

#include "asip/client/address.hpp"
#include "asip/client/options.hpp"
#include "asip/client/pending_calls.hpp"
#include "asip/link/kept_stream.hpp"
#include "asip/model/model_set.hpp"
#include "asip/session/board_session.hpp"
#include "asip/session/service_table.hpp"

namespace asip::client {

/// A board behind a serial port or a TCP connection that carries plain ASIP lines. When the port vanishes or
/// the peer hangs up it is opened again until it is there (by its stable name, so that a board may come back
/// on another port).
class DirectTransport final : public Transport {
  public:
    /// `address` of kind Serial or Tcp.
    DirectTransport(boost::asio::io_context& io, Address address, Options options);
    ~DirectTransport() override;

    boost::asio::any_io_executor executor() const override { return io_.get_executor(); }
    Awaitable<void> open(Listener& listener) override;
    Awaitable<nlohmann::json> command(std::string service, nlohmann::json command) override;
    Awaitable<void> raw(std::string line) override;
    std::string board_name() const override;
    std::vector<ServiceInfo> services() const override;
    void close() override;

  private:
    Awaitable<nlohmann::json> request(std::string line, char answer_tag, model::ModelPtr model);
    void opened(const link::StreamOpened& link);
    void lost(const link::StreamError& error);
    void failed(const link::StreamError& error);
    void perform(const session::Actions& actions);
    void perform_one(const session::Action& action);
    void set_line_rate(unsigned baud);
    void deliver(const protocol::ParsedLine& line);
    void identified();
    void finished(const session::Finished& end);
    void set_presence(bool there);
    void arm();

    boost::asio::io_context& io_;
    Address address_;
    Options options_;
    Listener* listener_ = nullptr;
    std::unique_ptr<link::KeptStream> link_;
    session::BoardSession session_;
    PendingCalls calls_;
    session::ServiceTable services_;
    boost::asio::steady_timer deadline_;
    std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);  // handlers that come too late see it gone
    bool there_ = false;
    bool opened_ = false;
    bool closed_ = false;
};

}  // namespace asip::client
