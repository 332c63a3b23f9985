// SPDX-License-Identifier: Apache-2.0
#include <asip/client/blocking_board.hpp>
#include <chrono>
#include <cstdio>

#include "others.hpp"

int main() {
    const auto address = "tcp://127.0.0.1:" + std::to_string(others::take_one_connection());
    asip::client::Options options;
    options.open_timeout = std::chrono::seconds(2);
    const auto board = asip::client::BlockingBoard::open(address, options);
    others::wait();
    if (board) return 1;
    std::printf("%s\n", to_string(board.error()).c_str());
    return 0;
}
