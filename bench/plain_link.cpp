// SPDX-License-Identifier: Apache-2.0
// What a link does, by programs that do nothing else: level of pin 2 of one board to a pin of another.
//   plain_link ports DESK LAMP PIN    both boards at this program
//   plain_link pub BROKER DESK        one publishes, the other subscribes
//   plain_link sub BROKER LAMP PIN
// A board is a serial port, or a TCP port of this machine.
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "bench/mqtt_client.hpp"

namespace {

using namespace asip::bench;

constexpr const char* kTopic = "plain/lamp";

int open_board(const std::string& where) {
    int fd = -1;
    if (where.starts_with("/")) {
        fd = open(where.c_str(), O_RDWR | O_NOCTTY);
        termios settings{};
        tcgetattr(fd, &settings);
        cfmakeraw(&settings);
        cfsetspeed(&settings, B57600);
        tcsetattr(fd, TCSANOW, &settings);
    } else {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        address.sin_port = htons(static_cast<std::uint16_t>(std::stoi(where)));
        fd = socket(AF_INET, SOCK_STREAM, 0);
        if (connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) fd = -1;
        const int on = 1;
        setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    }
    if (fd < 0) throw std::runtime_error("cannot open " + where);
    return fd;
}

void send(int fd, const std::string& line) {
    if (write(fd, line.data(), line.size()) < 0) throw std::runtime_error("cannot write");
}

/// Calls `pressed` with each level that the board tells, until it hangs up.
void read_levels(int fd, const std::function<void(bool)>& pressed) {
    constexpr std::string_view kLevels = "@I,d,4,";
    send(fd, "\nI,P,2,2\n");
    std::string pending;
    char buffer[512];
    for (ssize_t count = 0; (count = read(fd, buffer, sizeof buffer)) > 0;) {
        pending.append(buffer, static_cast<std::size_t>(count));
        for (std::size_t end = 0; (end = pending.find('\n')) != std::string::npos; pending.erase(0, end + 1))
            if (pending.starts_with(kLevels)) pressed((std::atoi(pending.c_str() + kLevels.size()) & 4) == 0);
    }
}

std::string level_of(const std::string& pin, bool on) {
    return "I,d," + pin + (on ? ",1\n" : ",0\n");
}

void begin_lamp(int fd, const std::string& pin) {
    send(fd, "\nI,P," + pin + ",3\n");
}

}  // namespace

int main(int count, char** words) {
    const std::string how = count > 3 ? words[1] : "";
    const auto broker = [&] { return static_cast<std::uint16_t>(std::atoi(words[2])); };
    if (how == "ports" && count == 5) {
        const std::string pin = words[4];
        const int lamp = open_board(words[3]);
        begin_lamp(lamp, pin);
        read_levels(open_board(words[2]), [&](bool on) { send(lamp, level_of(pin, on)); });
        return 0;
    }
    mosquitto_lib_init();
    if (how == "pub" && count == 4) {
        MqttClient client(broker());
        read_levels(open_board(words[3]), [&](bool on) { client.publish(kTopic, on ? "1" : "0"); });
        return 0;
    }
    if (how != "sub" || count != 5) return 2;
    const int lamp = open_board(words[3]);
    begin_lamp(lamp, words[4]);
    MqttClient client(broker());
    client.subscribe(kTopic);
    for (;;) {
        client.wait(std::chrono::hours(1));
        for (const auto& [topic, payload] : client.take())
            send(lamp, level_of(words[4], payload == "1"));
    }
}
