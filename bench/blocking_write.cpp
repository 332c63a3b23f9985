// SPDX-License-Identifier: Apache-2.0
// How long `servo.write` takes from call to return with BlockingBoard: what bench_python compares with.
//
//     blocking_write ADDRESS COUNT      prints p50 and p99 in milliseconds
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "asip/client/blocking_board.hpp"
#include "figures.hpp"

int main(int argc, char** argv) {
    using namespace asip::client;
    if (argc != 3) {
        std::fprintf(stderr, "usage: blocking_write ADDRESS COUNT\n");
        return 2;
    }
    std::signal(SIGPIPE, SIG_IGN);
    auto board = BlockingBoard::open(argv[1]);
    if (!board) {
        std::fprintf(stderr, "blocking_write: %s\n", to_string(board.error()).c_str());
        return 1;
    }
    std::vector<double> samples;
    for (int i = 0; i < std::atoi(argv[2]); ++i) {
        const auto began = std::chrono::steady_clock::now();
        const auto written = board->command("servo", "write", {0, i % 180});
        if (!written) {
            std::fprintf(stderr, "blocking_write: %s\n", to_string(written.error()).c_str());
            return 1;
        }
        samples.push_back(asip::bench::Milliseconds(std::chrono::steady_clock::now() - began).count());
    }
    const auto [p50, p99] = asip::bench::summary(std::move(samples));
    std::printf("%.4f %.4f\n", p50, p99);
    return 0;
}
