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

/// Names for the rovers of a world whose boards are made one after the other: that of the board, and for a
/// further one on the same board that name with a number.
class RoverNames {
  public:
    /// A board was made: the rovers that its world has got by it are named.
    void made(const BoardFile& board);
    const std::vector<std::string>& names() const { return names_; }

  private:
    std::vector<std::string> names_;
};

/// Keeps the world of some boards on the bus, on the io_context's thread. Whatever becomes of the broker or
/// the name, the boards run on: it is written to the log.
class WorldPublisher {
  public:
    /// The error is a sentence about `name` or the broker options: a name that no board may have or that one
    /// of these boards has, no world, more than one, more rovers than a description has room for.
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
