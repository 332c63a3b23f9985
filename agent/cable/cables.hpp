// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/steady_timer.hpp>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "agent/cable/cable.hpp"
#include "agent/cable/lent.hpp"
#include "asip/time.hpp"

namespace asip::agent {

/// The boards that browsers lend. asip-gateway brings each cable to the Unix socket `FOLDER/gateway`; its
/// board is then at the port `FOLDER/PLACE`, a link to a pseudo-terminal. A place is called after the lender.
/// It stays for an hour when its cable is pulled: the next one of this lender comes there. A cable that its
/// page connects again comes to its own place, whether the connection of before has ended or not. One thread.
class Cables {
  public:
    static constexpr std::size_t kMaxPlaces = 64;
    static constexpr std::size_t kMaxOfOneLender = 16;
    static constexpr Duration kKept = std::chrono::hours(1);
    static constexpr const char* kSocket = "gateway";

    struct Handlers {
        /// A cable is at the place: for the first time, or again.
        std::function<void(const std::string& place, const std::string& port,
                           std::shared_ptr<const Lent> lent)>
            on_plugged;
        /// No cable came back in time.
        std::function<void(const std::string& place)> on_left;
    };

    /// Throws std::runtime_error where it cannot listen there, and where another user may write.
    Cables(boost::asio::io_context& io, std::filesystem::path folder, Handlers handlers);
    ~Cables();

    /// The board at a place is on the bus under this name.
    void named(const std::string& place, const std::string& board);
    void stop();

  private:
    using Protocol = boost::asio::local::stream_protocol;
    struct Place {
        unsigned cable = 0;  // its number; 0: pulled
        std::string by;      // its lender
        std::string name{};  // of the cable, by its page
        std::shared_ptr<Lent> lent;
        Time pulled{};
    };

    void accept();
    void plug(unsigned number, const Cable::Hello& hello);
    void pulled(unsigned number, const std::string& why);
    void refuse(unsigned number, const std::string& why);
    /// Empty: as many are there as may be.
    std::string place_for(const Cable::Hello& hello) const;
    std::string place_of_lender(const std::string& by) const;
    void forget_old();
    /// The pulled place that waits longest; false: there is none.
    bool forget_oldest();
    std::filesystem::path port_of(const std::string& place) const { return folder_ / place; }

    boost::asio::io_context& io_;
    const std::filesystem::path folder_;
    const Handlers handlers_;
    Protocol::acceptor acceptor_;
    boost::asio::steady_timer timer_;
    std::map<unsigned, std::unique_ptr<Cable>> cables_;
    unsigned last_ = 0;
    std::map<std::string, Place> places_;
    std::shared_ptr<const void> alive_ = std::make_shared<char>();  // posted calls hold it weakly
};

}  // namespace asip::agent
