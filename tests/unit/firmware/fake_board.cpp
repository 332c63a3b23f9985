// SPDX-License-Identifier: Apache-2.0
#include "fake_board.hpp"

#include <cstring>
#include <new>
#include <utility>

namespace asip {

void FakeBoard::switch_on() {
    // Memory is zero before the constructors run, as the start-up code of a chip leaves it.
    std::memset(static_cast<void*>(&board), 0, sizeof board);
    new (&board) Board;
    Board::readAhead_ = nullptr;
    Board::longLine_ = nullptr;
    Board::longLineSize_ = 0;
    out = Out();
}

void FakeBoard::spoil_old_bytes() {
    static constexpr char kArguments[] = ",1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,";
    static_assert(sizeof kArguments > sizeof board.line_);
    const std::size_t kept = board.length_ == Board::kSpoiled ? 3 : board.length_;
    std::memcpy(board.line_ + kept, kArguments, sizeof board.line_ - kept);
}

FakeBoard::FakeBoard(std::vector<Service*> services, bool strict) {
    hw::reset_fake();
    switch_on();
    for (Service* service : services)
        board.add(*service);
    if (strict) board.useStrictMode();
    board.begin(F("Test"));
    banner_ = take();
    board.io().setPeriod(0);
}

std::string FakeBoard::send(const std::string& bytes) {
    hw::fake.to_board += bytes;
    return settle();
}

std::string FakeBoard::run(int passes) {
    std::string all;
    for (; passes > 0; --passes) {
        board.run();
        all += take();
    }
    return all;
}

std::string FakeBoard::settle() {
    std::string all;
    // The longest silence is that of a name of 32 characters being stored.
    for (int quiet = 0; quiet < 40; ++quiet) {
        const auto waiting = hw::fake.to_board.size();
        board.run();
        const auto sent = take();
        all += sent;
        if (!sent.empty() || hw::fake.to_board.size() != waiting) quiet = 0;
    }
    return all;
}

std::string FakeBoard::pass_time(unsigned milliseconds) {
    std::string all;
    for (unsigned i = 0; i < milliseconds; ++i) {
        ++hw::fake.milliseconds;
        std::string sent;
        do {
            board.run();
            sent = take();
            all += sent;
        } while (!sent.empty());
    }
    return all;
}

std::string FakeBoard::take() {
    hw::fake.room = 63;
    return std::exchange(hw::fake.from_board, {});
}

}  // namespace asip
