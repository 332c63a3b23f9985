// SPDX-License-Identifier: Apache-2.0
#include "sim/program/input_commands.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <boost/asio/read_until.hpp>
#include <csignal>
#include <iostream>
#include <utility>

#include "asip/text/file_text.hpp"

namespace asip::sim {
namespace {

constexpr std::size_t kMaxLineBytes = 1024;

bool is_file(int descriptor) {
    struct stat status{};
    return ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

}  // namespace

InputCommands::InputCommands(boost::asio::io_context& context, Execute execute)
    : descriptor_(context), input_(kMaxLineBytes), execute_(std::move(execute)) {
    if (is_file(STDIN_FILENO)) {  // epoll refuses files
        for (std::string line; std::getline(std::cin, line);)
            execute(line);
        return;
    }
    // In a shell's background reading the terminal would stop the program; ignored, it fails instead.
    std::signal(SIGTTIN, SIG_IGN);
    boost::system::error_code error;
    descriptor_.assign(::dup(STDIN_FILENO), error);
    if (!error) read();
}

void InputCommands::execute(const std::string& line) {
    execute_(std::exchange(first_, false) ? std::string(text::without_mark(line)) : line);
}

void InputCommands::read() {
    boost::asio::async_read_until(descriptor_, input_, '\n',
                                  [this](boost::system::error_code error, std::size_t) {
                                      if (error) return;
                                      std::string line;
                                      std::istream stream(&input_);
                                      std::getline(stream, line);
                                      execute(line);
                                      read();
                                  });
}

}  // namespace asip::sim
