// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "asip/program/broker_log.hpp"
#include "asip/program/options.hpp"
#include "sim/board_file.hpp"
#include "sim/program/world_member.hpp"

namespace asip::sim {

/// Names for rovers: that of the board, with a number for further ones.
class RoverNames {
  public:
    /// Names the rovers that this board brought.
    void made(const BoardFile& board);
    const std::vector<std::string>& names() const { return names_; }

  private:
    std::vector<std::string> names_;
};

/// Keeps a world on the bus, on the io_context's thread. Whatever happens to broker or name is logged; the
/// boards run on.
class WorldPublisher {
  public:
    /// The error is about `name` (impossible, or a board's) or the broker, no world, several, or too many
    /// rovers.
    static Expected<std::unique_ptr<WorldPublisher>> create(boost::asio::io_context& io,
                                                            const std::string& name,
                                                            const program::BrokerOptions& broker,
                                                            const std::vector<BoardFile>& boards,
                                                            const std::vector<std::string>& rovers);

    /// Says goodbye; `ended` is called within a second. Call once.
    void end(std::function<void()> ended);

  private:
    WorldPublisher(boost::asio::io_context& io, const bus::Topics& topics, mqtt::Options options,
                   WorldMember member);

    template <class Call>
    void with(Call&& call);
    mqtt::Client::Handlers handlers();
    void wait();
    bool keeps_up() const;

    bus::Topics topics_;
    bool has_user_ = false;
    WorldMember member_;
    boost::asio::steady_timer timer_;
    program::BrokerLog log_;
    std::unique_ptr<mqtt::Client> client_;
    bool ended_ = false;
    bool denied_ = false;  // on this connection, and written to the log
};

}  // namespace asip::sim
