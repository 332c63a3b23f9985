// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <linux/filter.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <memory>
#include <regex>
#include <string>
#include <vector>

#include "tests/support/loop.hpp"
#include "tests/support/wait.hpp"

namespace asip::test {

/// Speaks just enough of MQTT 5 and 3.1.1 to accept a connection and to answer SUBSCRIBE, QoS 1 PUBLISH and
/// PINGREQ as it is given: what Mosquitto never does with its own rules. One io_context of its own, run by
/// run().
class ScriptedBroker {
  public:
    ScriptedBroker() : acceptor_(io_, {boost::asio::ip::address_v4::loopback(), 0}) { accept(); }

    std::uint16_t port() const { return acceptor_.local_endpoint().port(); }
    void run() { io_.restart(), io_.poll(); }

    void refuse_subscriptions(int count) { refusals_ = count; }
    /// Each time, whatever is asked for this filter.
    void refuse_filter(std::string filter) { refused_filter_ = std::move(filter); }
    /// CONNECT with the identifier of any other name is refused.
    void let_in_only(std::string name) { let_in_ = std::move(name); }
    /// Whoever subscribes is closed.
    void close_subscribers() { closes_subscribers_ = true; }
    void answer_nothing_after_connect() { silent_ = true; }
    /// Whoever publishes with the identifier of this name is closed, as by a node that has its queue
    /// elsewhere.
    void close_publisher(std::string name) { closed_ = std::move(name); }
    /// From now on, as a node of NATS that cannot store anything: a QoS 1 PUBLISH has no answer and its
    /// connection is closed after this time; a QoS 1 SUBSCRIBE is refused after it.
    void store_nothing(std::chrono::milliseconds time) { gives_up_after_ = time; }
    /// What was held back first, in order.
    void answer_all() {
        silent_ = false;
        for (const auto& [peer, bytes] : held_)
            send(*peer, bytes);
        held_.clear();
    }

    /// The kernel throws away unread what comes from whoever subscribed last, as if the network were cut.
    void cut_off_subscriber() {
        sock_filter nothing{BPF_RET | BPF_K, 0, 0, 0};
        const sock_fprog program{1, &nothing};
        ::setsockopt(subscriber_->socket.native_handle(), SOL_SOCKET, SO_ATTACH_FILTER, &program,
                     sizeof program);
    }
    /// To whoever subscribes next, right behind the answer: a PUBLISH of QoS 1 on topic "t".
    void publish_to_subscriber() { publishes_ = true; }
    /// Whether a QoS 0 PUBLISH is delivered to whoever sent it.
    void deliver_own(bool on) { delivers_own_ = on; }
    /// Whoever publishes is closed, as by rules that deny it.
    void close_publishers() { closes_publishers_ = true; }
    /// Whoever subscribed last is closed.
    void close_subscriber() { subscriber_->socket.close(); }
    /// To whoever subscribed last, who speaks MQTT 5.
    void deliver(bool retained) {
        send(*subscriber_, (retained ? "\x31" : "\x30") + std::string("\x05\x00\x01t\x00!", 6));
    }

    int connects = 0;
    int subscriptions = 0;
    int unsubscriptions = 0;
    int disconnects = 0;
    int acknowledgements = 0;  ///< PUBACKs that came
    std::string connect_packet{};
    /// The identifier of a client of this name in the last CONNECT; empty: there is none.
    std::string identifier(const std::string& name) const {
        std::smatch found;
        return std::regex_search(connect_packet, found, std::regex(name + "-[0-9a-f]{16}(-[0-9a-f]+)*"))
                   ? found.str()
                   : std::string();
    }
    std::vector<int> subscribed_qos{};
    std::vector<int> published_qos{};

  private:
    using Socket = boost::asio::ip::tcp::socket;
    struct Peer {
        explicit Peer(Socket s) : socket(std::move(s)) {}
        Socket socket;
        std::string buffer = std::string(65536, '\0');
        std::string received;
        bool v5 = true;
    };

    /// Whether the last CONNECT had the identifier of a client of this name, with nothing behind it.
    bool is_named(const std::string& name) const { return identifier(name).size() == name.size() + 17; }

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

    /// Only packets below 128 bytes of content, one length byte, are sent by these tests (CONNECT: two).
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
        if (type == 0x30) published_qos.push_back((packet[0] >> 1) & 3);
        if (type == 0x10) {
            ++connects;
            connect_packet = packet;
            peer->v5 = packet[8] == 5;
            const bool refused = !let_in_.empty() && !is_named(let_in_);
            send(*peer, peer->v5 ? std::string("\x20\x03\x00", 3) + (refused ? '\x85' : '\0') + '\0'
                                 : std::string("\x20\x02\x00", 3) + (refused ? '\x02' : '\0'));
        } else if (type == 0x80) {
            ++subscriptions;
            subscriber_ = peer;
            if (closes_subscribers_) return peer->socket.close();
            subscribed_qos.push_back(packet.back() & 3);
            if (gives_up_after_.count() > 0 && subscribed_qos.back() > 0)
                return later(peer, [this, peer, packet] { reply(peer, suback(*peer, packet, '\x80')); });
            const bool by_name =
                !refused_filter_.empty() && packet.find(refused_filter_) != std::string::npos;
            const bool refused = by_name || refusals_ > 0;
            if (refused && !by_name) --refusals_;
            reply(peer, suback(*peer, packet, refused ? '\x87' : '\x01'));
            if (publishes_) reply(peer, std::string("\x32\x07\x00\x01t\x00\x01\x00!", 9));
        } else if (type == 0xa0) {
            ++unsubscriptions;
        } else if (type == 0xe0) {
            ++disconnects;
        } else if (type == 0x40) {
            ++acknowledgements;
        } else if (type == 0x30 && closes_publishers_) {
            peer->socket.close();
        } else if (type == 0x30 && delivers_own_ && published_qos.back() == 0) {
            send(*peer, packet);
        } else if (type == 0x30 && gives_up_after_.count() > 0 && published_qos.back() > 0) {
            later(peer, [peer] { peer->socket.close(); });
        } else if (type == 0x30 && !closed_.empty() && is_named(closed_)) {
            peer->socket.close();
        } else if (type == 0x30 && (packet[0] & 0x06) != 0) {
            const std::size_t topic = static_cast<unsigned char>(packet[3]);
            reply(peer, std::string("\x40\x02", 2) + packet.substr(4 + topic, 2));
        } else if (type == 0xc0) {
            send(*peer, std::string("\xd0\x00", 2));
        }
    }

    static std::string suback(const Peer& peer, const std::string& packet, char code) {
        const auto id = packet.substr(2, 2);
        return (peer.v5 ? std::string("\x90\x04") + id + '\0' : std::string("\x90\x03") + id) + code;
    }

    template <class Action>
    void later(const std::shared_ptr<Peer>& peer, Action action) {
        auto timer =
            std::make_shared<boost::asio::steady_timer>(peer->socket.get_executor(), gives_up_after_);
        timer->async_wait([timer, action](const boost::system::error_code&) { action(); });
    }

    void reply(const std::shared_ptr<Peer>& peer, const std::string& bytes) {
        if (silent_) {
            held_.emplace_back(peer, bytes);
        } else {
            send(*peer, bytes);
        }
    }
    static void send(Peer& peer, const std::string& bytes) {
        boost::system::error_code ignored;
        boost::asio::write(peer.socket, boost::asio::buffer(bytes), ignored);
    }

    boost::asio::io_context io_;
    boost::asio::ip::tcp::acceptor acceptor_;
    std::shared_ptr<Peer> subscriber_;
    int refusals_ = 0;
    bool silent_ = false;
    bool publishes_ = false;
    bool delivers_own_ = false;
    bool closes_publishers_ = false;
    bool closes_subscribers_ = false;
    std::string refused_filter_;
    std::string let_in_;
    std::chrono::milliseconds gives_up_after_{0};
    std::string closed_;
    std::vector<std::pair<std::shared_ptr<Peer>, std::string>> held_;
};

/// Runs a client, which has an io_context `io` of its own, and scripted brokers until the condition holds.
template <class Bus, class Condition, class... Brokers>
bool until_beside(Bus& bus, Condition condition, std::chrono::milliseconds limit, Brokers&... brokers) {
    return wait_until(
        [&] {
            run_for(bus.io, std::chrono::milliseconds(5));
            (brokers.run(), ...);
            return condition();
        },
        limit);
}

}  // namespace asip::test
