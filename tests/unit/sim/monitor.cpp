// SPDX-License-Identifier: Apache-2.0
#include "monitor.hpp"

#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace asip::sim {

using namespace std::chrono_literals;

TemporaryFolder::TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "asip-sim-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("mkdtemp");
    path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
}

void write_file(const std::filesystem::path& file, std::string_view content) {
    std::ofstream(file, std::ios::binary) << content;
}

BoardConfig Monitor::config(const std::string& board) {
    BoardConfig config;
    config.board = board;
    config.image = std::string(SKETCH_FOLDER "/monitor_") + BoardKind::find(board)->chip + ".elf";
    return config;
}

namespace {

BoardConfig with_parts(BoardConfig config, std::vector<PartConfig> parts) {
    config.parts = std::move(parts);
    return config;
}

}  // namespace

Monitor::Monitor(std::vector<PartConfig> parts, const std::string& board)
    : Monitor(with_parts(config(board), std::move(parts))) {}

Monitor::Monitor(BoardConfig config) {
    auto board = Board::create(config);
    if (!board) throw std::runtime_error(board.error());
    board_ = std::move(*board);
    if (!board_->read_line(100ms)) throw std::runtime_error("the sketch does not start");
}

void Monitor::send(std::string_view command) {
    board_->send(command);
    board_->run_until([&] { return board_->sending() == 0; }, 1s);
    board_->run_for(100us);
}

std::string Monitor::ask(std::string_view command, std::size_t count) {
    board_->take_output();
    board_->send(command);
    std::string answer;
    board_->run_until(
        [&] {
            answer += board_->take_output();
            return answer.size() >= count;
        },
        1s);
    return answer;
}

unsigned Monitor::ask_word(std::string_view command) {
    const auto answer = ask(command, 2);
    if (answer.size() != 2) throw std::runtime_error("no answer");
    return static_cast<unsigned char>(answer[0]) | static_cast<unsigned char>(answer[1]) << 8;
}

void Monitor::write_register(unsigned address, unsigned value) {
    const char command[] = {'W', static_cast<char>(address), static_cast<char>(address >> 8),
                            static_cast<char>(value)};
    send({command, 4});
}

unsigned Monitor::read_register(unsigned address) {
    const char command[] = {'R', static_cast<char>(address), static_cast<char>(address >> 8)};
    return static_cast<unsigned char>(ask({command, 3}, 1).at(0));
}

}  // namespace asip::sim
