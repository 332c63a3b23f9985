// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <linux/filter.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/loop.hpp"

namespace asip::test {

/// Speaks just enough of MQTT 5 to accept a connection and to grant subscriptions, and shows what Mosquitto
/// does not: bytes, a host that is cut off, and a broker that is slow to acknowledge. It has an io_context of
/// its own, which run() runs.
class ScriptedBroker {
  public:
    ScriptedBroker() : acceptor_(io_, {boost::asio::ip::address_v4::loopback(), 0}) { accept(); }

    std::uint16_t port() const { return acceptor_.local_endpoint().port(); }
    void run() { io_.restart(), io_.poll(); }

    /// The kernel throws away unread what comes from the last subscriber, as if the network were cut.
    void cut_off_subscriber() {
        sock_filter nothing{BPF_RET | BPF_K, 0, 0, 0};
        const sock_fprog program{1, &nothing};
        ::setsockopt(subscriber_->socket.native_handle(), SOL_SOCKET, SO_ATTACH_FILTER, &program,
                     sizeof program);
    }
    /// The next subscriber gets a PUBLISH of QoS 1 on topic "t" right behind the answer.
    void publish_to_subscriber() { publishes_ = true; }

    /// The oldest messages of QoS 1 that have no PUBACK yet get one.
    void acknowledge(std::size_t count) {
        for (; count > 0 && !waiting_.empty(); --count, waiting_.erase(waiting_.begin()))
            send(*subscriber_, std::string("\x40\x02") + waiting_.front());
    }

    int acknowledgements = 0;              ///< PUBACKs that came
    std::vector<std::string> published{};  ///< topics of messages of QoS 1 that came
    std::string connect_packet{};

  private:
    using Socket = boost::asio::ip::tcp::socket;
    struct Peer {
        explicit Peer(Socket s) : socket(std::move(s)) {}
        Socket socket;
        std::string buffer = std::string(65536, '\0');
        std::string received;
    };

    void accept() {
        acceptor_.async_accept([this](const boost::system::error_code& error, Socket socket) {
            if (error) return;
            read(std::make_shared<Peer>(std::move(socket)));
            accept();
        });
    }

    void read(const std::shared_ptr<Peer>& peer) {
        peer->socket.async_read_some(boost::asio::buffer(peer->buffer),
                                     [this, peer](const boost::system::error_code& error, std::size_t n) {
                                         if (error) return;
                                         peer->received.append(peer->buffer, 0, n);
                                         while (take_packet(peer)) {
                                         }
                                         read(peer);
                                     });
    }

    /// These tests send only packets with less than 128 bytes of content, so one length byte.
    bool take_packet(const std::shared_ptr<Peer>& peer) {
        auto& in = peer->received;
        if (in.size() < 2) return false;
        const std::size_t size = static_cast<unsigned char>(in[1]) + std::size_t{2};
        if (in.size() < size) return false;
        const std::string packet = in.substr(0, size);
        in.erase(0, size);
        answer(peer, packet);
        return true;
    }

    void answer(const std::shared_ptr<Peer>& peer, const std::string& packet) {
        const auto type = static_cast<unsigned char>(packet[0]) & 0xf0;
        if (type == 0x10) {
            connect_packet = packet;
            send(*peer, std::string("\x20\x03\x00\x00\x00", 5));
        } else if (type == 0x80) {
            subscriber_ = peer;
            send(*peer, std::string("\x90\x04") + packet.substr(2, 2) + std::string("\x00\x01", 2));
            if (publishes_) send(*peer, std::string("\x32\x07\x00\x01t\x00\x01\x00!", 9));
        } else if (type == 0x30) {
            const auto size = static_cast<unsigned char>(packet[3]);
            published.push_back(packet.substr(4, size));
            waiting_.push_back(packet.substr(4 + size, 2));
        } else if (type == 0x40) {
            ++acknowledgements;
        } else if (type == 0xc0) {
            send(*peer, std::string("\xd0\x00", 2));
        }
    }

    static void send(Peer& peer, const std::string& bytes) {
        boost::system::error_code ignored;
        boost::asio::write(peer.socket, boost::asio::buffer(bytes), ignored);
    }

    boost::asio::io_context io_;
    boost::asio::ip::tcp::acceptor acceptor_;
    std::shared_ptr<Peer> subscriber_;
    bool publishes_ = false;
    std::vector<std::string> waiting_;  // packet identifiers
};

}  // namespace asip::test
