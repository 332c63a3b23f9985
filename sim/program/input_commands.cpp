// SPDX-License-Identifier: Apache-2.0
#include "sim/program/input_commands.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <boost/asio/buffer.hpp>
#include <csignal>
#include <iostream>
#include <string_view>
#include <utility>

#include "asip/text/file_text.hpp"

namespace asip::sim {
namespace {

bool is_file(int descriptor) {
    struct stat status{};
    return ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

}  // namespace

InputCommands::InputCommands(boost::asio::io_context& context, Execute execute)
    : descriptor_(context), execute_(std::move(execute)) {
    if (is_file(STDIN_FILENO)) {  // epoll refuses files
        for (ssize_t read = 0; (read = ::read(STDIN_FILENO, input_.data(), input_.size())) > 0;)
            take(static_cast<std::size_t>(read));
        take_end();
        return;
    }
    // In a shell's background reading the terminal would stop the program; ignored, it fails instead.
    std::signal(SIGTTIN, SIG_IGN);
    boost::system::error_code error;
    descriptor_.assign(::dup(STDIN_FILENO), error);
    if (!error) read();
}

void InputCommands::take(std::size_t size) {
    const auto overlong = lines_.overlong_lines();
    lines_.push(std::string_view(input_.data(), size), [this](std::string_view line) {
        execute_(std::string(std::exchange(first_, false) ? text::without_mark(line) : line));
    });
    if (lines_.overlong_lines() != overlong) std::cerr << "asip-sim: a command is too long\n";
}

// The last line of a file may have no end.
void InputCommands::take_end() {
    input_[0] = '\n';
    take(1);
}

void InputCommands::read() {
    descriptor_.async_read_some(boost::asio::buffer(input_),
                                [this](boost::system::error_code error, std::size_t size) {
                                    take(size);
                                    if (error) return take_end();
                                    read();
                                });
}

}  // namespace asip::sim
