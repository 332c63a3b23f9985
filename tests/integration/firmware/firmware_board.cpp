// SPDX-License-Identifier: Apache-2.0
#include "firmware_board.hpp"

#include <stdexcept>

namespace asip::firmware {

using std::chrono::milliseconds;

FirmwareBoard::FirmwareBoard(const std::string& image, std::string kind, std::vector<sim::PartConfig> parts,
                             std::uint32_t frequency) {
    sim::BoardConfig config;
    config.board = std::move(kind);
    config.image = ASIP_IMAGES "/" + image + ".elf";
    config.parts = std::move(parts);
    config.frequency = frequency;
    auto board = sim::Board::create(config);
    if (!board) throw std::runtime_error(board.error());
    board_ = std::move(*board);
    banner_ = next_line(milliseconds(500));
    if (image.find("_04") != std::string::npos) {
        fence_ = "#,?";
        fenced_ = "@#,?,";
    }
    ask("I,A,0");
}

std::string FirmwareBoard::ask(std::string_view line) {
    board_->send(std::string(line) + "\n" + fence_ + "\n");
    std::string all;
    for (;;) {
        const auto got = next_line(milliseconds(1000));
        if (got.starts_with(fenced_)) return all;
        if (!all.empty()) all += '|';
        all += got;
        if (got == "(none)") return all;
    }
}

std::vector<std::string> FirmwareBoard::lines_within(milliseconds time) {
    std::vector<std::string> lines;
    const auto end = board_->now() + time;
    while (board_->now() < end)
        if (auto line = board_->read_line(end - board_->now())) lines.push_back(line->text);
    return lines;
}

std::string FirmwareBoard::next_line(milliseconds limit) {
    const auto line = board_->read_line(limit);
    return line ? line->text : "(none)";
}

void FirmwareBoard::step_up(unsigned baud) {
    board_->send("#,B," + std::to_string(baud) + "\n");
    const auto answer = next_line();
    if (answer != "@#,B," + std::to_string(baud)) throw std::runtime_error("rate not taken: " + answer);
    board_->run_for(milliseconds(1));
    if (ask("#,E,up") != "@#,E,up") throw std::runtime_error("no fence at the new rate");
}

}  // namespace asip::firmware
