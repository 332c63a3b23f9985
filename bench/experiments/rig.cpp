// SPDX-License-Identifier: Apache-2.0
#include "bench/experiments/rig.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "tests/support/loop.hpp"

#include "tests/support/temp_dir.hpp"

namespace asip::experiments {

using namespace std::chrono_literals;

std::vector<Firmware> firmwares(const std::string& other_image) {
    std::vector<Firmware> all{{"ours", ASIP_IMAGES "/asip_uno.elf"}};
    if (!other_image.empty())
        all.push_back({std::filesystem::path(other_image).stem().string(), other_image});
    return all;
}

Simulator::Simulator(const std::vector<Board>& boards) {
    std::vector<std::string> words{ASIP_PROGRAMS "/asip-sim", "--no-socket"};
    for (const auto& board : boards)
        words.push_back(folder_.write(board.name + ".json",
                                      fmt::format(R"({{"name":"{}","image":"{}","link":"{}","parts":{}}})",
                                                  board.name, board.image, port(board.name), board.parts)));
    process_ = std::make_unique<test::ChildProcess>(words);
    for (const auto& board : boards)
        if (!process_->wait_for_output("^" + board.name + " .*port "))
            throw std::runtime_error(process_->errors());
}

unsigned Simulator::times_behind() const {
    const auto text = process_->output();
    unsigned count = 0;
    for (auto at = text.find(" behind "); at != std::string::npos; at = text.find(" behind ", at + 1))
        ++count;
    return count;
}

const char* name_of(Link link) {
    return link == Link::kSerial ? "serial" : link == Link::kTcp ? "TCP" : "MQTT";
}

Way::Way(const test::MosquittoBroker& broker, Link link, bool fast, const std::string& port,
         const std::string& board)
    : fast_(fast), address_(port) {
    if (link == Link::kSerial) return;
    const auto tcp = std::to_string(test::free_port());
    std::vector<std::string> words{ASIP_PROGRAMS "/asip-agent",
                                   "--serial",
                                   port,
                                   "--name",
                                   board,
                                   "--broker",
                                   broker.url(),
                                   "--listen",
                                   tcp + "/lines"};
    if (fast)
        words.insert(words.end(),
                     {"--config", test::settings_file(fmt::format("max-baud = {}\n", kFastBaud))});
    else
        words.push_back("--no-step-up");
    agent_ = std::make_unique<test::ChildProcess>(words);
    const auto line = agent_->wait_for_errors("board identified");
    if (!line) throw std::runtime_error("the image does not answer as an ASIP board: " + agent_->errors());
    stepped_up_ = line->find("baud=57600") == std::string::npos;
    address_ = link == Link::kTcp ? "tcp://127.0.0.1:" + tcp : broker.url() + "/" + board;
}

client::Options Way::options() const {
    client::Options options;
    options.max_baud = fast_ ? kFastBaud : 0;
    options.open_timeout = 15s;
    return options;
}

bool run_until(boost::asio::io_context& io, const std::function<bool()>& condition,
               std::chrono::milliseconds limit) {
    return test::run_until(io, condition, limit);
}

std::string number(double value, int decimals) {
    return fmt::format("{:.{}f}", value, decimals);
}

void note_behind(Results& results, unsigned times_behind) {
    if (times_behind > 0)
        results.notes.push_back(fmt::format(
            "this computer was too busy and could not keep up with the boards {} times: repeat it on a "
            "quiet one",
            times_behind));
}

}  // namespace asip::experiments
