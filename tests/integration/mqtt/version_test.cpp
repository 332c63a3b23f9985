// SPDX-License-Identifier: Apache-2.0
// A scripted broker, for what Mosquitto 2.0.11 never does: refuse MQTT 5, or say why it closes a connection.
#include <gtest/gtest.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>

#include "tests/integration/mqtt/recorder.hpp"

namespace asip::test {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using Kind = mqtt::ConnectionFailure::Kind;

constexpr std::size_t kVersionOffset = 8;  // CONNECT: type, length, 0 4 M Q T T, version

/// Answers each CONNECT by its version, with the bytes it was given; no bytes: closes.
class VersionBroker {
  public:
    VersionBroker(asio::io_context& io, std::string to_v5, std::string to_v311)
        : acceptor_(io, tcp::endpoint(asio::ip::address_v4::loopback(), 0)),
          to_v5_(std::move(to_v5)),
          to_v311_(std::move(to_v311)) {
        accept();
    }
    std::uint16_t port() const { return acceptor_.local_endpoint().port(); }

    std::vector<int> versions;

  private:
    void accept() {
        acceptor_.async_accept([this](const boost::system::error_code& error, tcp::socket socket) {
            if (error) return;
            auto peer = std::make_shared<tcp::socket>(std::move(socket));
            peers_.push_back(peer);
            read(peer);
            accept();
        });
    }
    void read(const std::shared_ptr<tcp::socket>& peer) {
        auto buffer = std::make_shared<std::string>(1024, '\0');
        peer->async_read_some(asio::buffer(*buffer),
                              [=, this](const boost::system::error_code& error, std::size_t n) {
                                  if (error) return;
                                  if (n > kVersionOffset && buffer->at(0) == 0x10) {
                                      versions.push_back(buffer->at(kVersionOffset));
                                      const auto& answer = versions.back() == 5 ? to_v5_ : to_v311_;
                                      if (answer.empty()) {
                                          peer->close();
                                          return;
                                      }
                                      asio::write(*peer, asio::buffer(answer));
                                  }
                                  read(peer);
                              });
    }

    tcp::acceptor acceptor_;
    std::string to_v5_;
    std::string to_v311_;
    std::vector<std::shared_ptr<tcp::socket>> peers_;
};

const std::string kAccepted311("\x20\x02\x00\x00", 4);
const std::string kRefusedVersion311("\x20\x02\x00\x01", 4);
const std::string kRefusedVersion5("\x20\x03\x00\x84\x00", 5);
const std::string kAccepted5("\x20\x03\x00\x00\x00", 5);
const std::string kFirstSubscriptionNotAuthorised5("\x90\x04\x00\x01\x00\x87", 6);
const std::string kTakenOver5("\xe0\x02\x8e\x00", 4);

class MqttVersion : public testing::Test {
  protected:
    bool connects(const std::string& to_v5, const std::string& to_v311,
                  mqtt::Version version = mqtt::Version::kBest) {
        mqtt::Options options;
        options.version = version;
        options.connect_timeout = 300ms;
        options.brokers.clear();
        options.brokers.push_back({"127.0.0.1", 1, false});
        asio::io_context io;
        VersionBroker broker(io, to_v5, to_v311);
        options.brokers[0].port = broker.port();
        mqtt::Client::Handlers handlers;
        handlers.on_disconnected = [&](const mqtt::ConnectionFailure& f) { losses.push_back(f); };
        handlers.on_connect_failed = [&](const mqtt::ConnectionFailure& f) { failures.push_back(f); };
        handlers.on_subscribe_refused = [&](const std::string& filter, const std::string& reason) {
            refused_filters.push_back(filter + ": " + reason);
        };
        mqtt::Client client(io, options, handlers);
        client.subscribe("secret/#");
        client.start();
        const bool connected = run_until(io, [&] {
            return (client.connected() && !client.v5()) || failures.size() > 2 || !losses.empty() ||
                   !refused_filters.empty();
        });
        versions = broker.versions;
        return connected && client.connected() && !client.v5();
    }

    std::vector<int> versions;
    std::vector<mqtt::ConnectionFailure> failures;
    std::vector<mqtt::ConnectionFailure> losses;
    std::vector<std::string> refused_filters;
};

TEST_F(MqttVersion, RefusedInTheWordsOf5_FallsBackUnnoticed) {
    EXPECT_TRUE(connects(kRefusedVersion5, kAccepted311));
    EXPECT_EQ(versions, (std::vector<int>{5, 4}));
    EXPECT_TRUE(failures.empty());
}

TEST_F(MqttVersion, DisconnectedBecauseOfAnotherClientWithOurId_IsTakenOver) {
    EXPECT_FALSE(connects(kAccepted5 + kTakenOver5, {}));
    ASSERT_FALSE(losses.empty());
    EXPECT_EQ(losses[0].kind, Kind::kTakenOver);
    EXPECT_TRUE(losses[0].fatal());
}

TEST_F(MqttVersion, SubscriptionNotAllowed_IsReportedByItsFilter) {
    EXPECT_FALSE(connects(kAccepted5 + kFirstSubscriptionNotAuthorised5, {}));
    EXPECT_EQ(refused_filters, (std::vector<std::string>{"secret/#: Not authorized"}));
}

TEST_F(MqttVersion, SpeaksSomethingElse_FailsAndTriesOn) {
    EXPECT_FALSE(connects("HTTP/1.1 400 Bad Request\r\n\r\n", "HTTP/1.1 400 Bad Request\r\n\r\n"));
    EXPECT_FALSE(failures.empty());
}

}  // namespace
}  // namespace asip::test
