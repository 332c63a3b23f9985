// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/child_process.hpp"
#include "tests/support/patterns.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {

/// Real firmware on simulated Unos, each with a button on pin 2, a LED on pin 13 and a potentiometer on A0,
/// each at a serial port and a TCP port.
class SimulatedBoards {
  public:
    /// `images` name firmware images, "asip_uno_services"; the boards are called uno, uno2, ...
    explicit SimulatedBoards(const std::vector<std::string>& images) : process_(arguments(images)) {
        for (std::size_t i = 0; i < images.size(); ++i) {
            const auto line = process_.wait_for_output("^" + name(i) + " .*tcp=[0-9]+");
            const auto match = first_match(line.value_or(""), "tcp=([0-9]+)");
            if (!match) throw std::runtime_error("asip-sim: " + process_.errors());
            tcp_ports_.push_back(match->at(1));
        }
    }

    static std::string name(std::size_t board) {
        return board == 0 ? "uno" : "uno" + std::to_string(board + 1);
    }
    std::string serial(std::size_t board = 0) const { return folder_.file(name(board) + ".tty"); }
    std::string tcp_port(std::size_t board = 0) const { return tcp_ports_[board]; }

    void press(std::size_t board = 0) { process_.write_input("press " + name(board) + "/button2\n"); }
    void release(std::size_t board = 0) { process_.write_input("release " + name(board) + "/button2\n"); }
    void set_potentiometer(const std::string& fraction) {
        process_.write_input("set uno/potentiometer14 " + fraction + "\n");
    }
    void command(const std::string& line) { process_.write_input(line + "\n"); }

    /// How often the LED on pin 13 has changed to `state`, "on" or "off".
    int led_changes(const std::string& state, std::size_t board = 0) const {
        const auto changes =
            all_matches(process_.output(), "(^|\n)" + name(board) + " [0-9.]+ led13 " + state);
        return static_cast<int>(changes.size());
    }
    bool wait_for_led(const std::string& state, std::size_t board = 0) {
        return wait_until([&] { return led_changes(state, board) > 0; });
    }
    std::string output() const { return process_.output(); }

  private:
    std::vector<std::string> arguments(const std::vector<std::string>& images) const {
        std::vector<std::string> all{ASIP_TEST_SIM, "--no-socket"};
        for (std::size_t i = 0; i < images.size(); ++i) {
            all.push_back(folder_.write(
                name(i) + ".json",
                R"({"board":"uno","name":")" + name(i) + R"(","image":")" + ASIP_TEST_IMAGES "/" + images[i] +
                    R"(.elf","parts":[{"kind":"led","pin":13},)" +
                    R"({"kind":"button","pin":2,"steady":true},{"kind":"potentiometer","pin":14}]})"));
        }
        for (std::size_t i = 0; i < images.size(); ++i)
            all.insert(all.end(), {"--link", serial(i), "--tcp", "0"});
        return all;
    }

    TempDir folder_;
    ChildProcess process_;
    std::vector<std::string> tcp_ports_;
};

}  // namespace asip::test
