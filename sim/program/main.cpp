// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "asip/program/exit_status.hpp"
#include "asip/program/open_files.hpp"
#include "asip/protocol/line_reader.hpp"
#include "asip/protocol/request.hpp"
#include "asip/text/file_text.hpp"
#include "sim/program/control_socket.hpp"
#include "sim/program/options.hpp"
#include "sim/program/running_boards.hpp"
#include "sim/program/world_publisher.hpp"

namespace asip::sim {
namespace {

/// Commands on standard input. Its end ends nothing: a service has none.
class InputCommands {
  public:
    using Execute = std::function<void(std::string line)>;

    /// A file is executed at once. A program in the background of a shell reads no terminal.
    InputCommands(boost::asio::io_context& context, Execute execute);

  private:
    void read();
    void take(std::size_t size);
    void take_end();

    boost::asio::posix::stream_descriptor descriptor_;
    std::array<char, 1024> input_;
    protocol::LineReader lines_{protocol::kMaxBoardLineBytes, protocol::kRequestEnds};
    Execute execute_;
    bool first_ = true;  // some editors put a mark before it
};

bool is_file(int descriptor) {
    struct stat status{};
    return ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

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

int report(int status, const std::string& text) {
    std::cerr << "asip-sim: " << text << '\n';
    return status;
}

/// By its first byte: builds name their .elf files as they like. By its name, too: it may be damaged.
bool is_image(const std::filesystem::path& file) {
    const int first = std::ifstream(file, std::ios::binary).get();
    const auto name = file.extension();
    return name != ".json" && (first == 0x7f || first == ':' || name == ".elf" || name == ".hex");
}

/// Boards that name the same world file share one world.
void share_worlds(std::vector<BoardFile>& files) {
    std::map<std::filesystem::path, std::shared_ptr<world::World>> worlds;
    for (auto& file : files) {
        if (file.world.empty()) continue;
        std::error_code error;
        const auto path = std::filesystem::weakly_canonical(file.world, error);
        file.board.world = worlds.try_emplace(path, file.board.world).first->second;
    }
}

Expected<std::vector<BoardFile>> load_boards(const Options& options) {
    std::vector<BoardFile> files;
    std::set<std::string> names;
    for (const auto& path : options.boards) {
        BoardFile file;
        if (is_image(path)) {
            file.board.name = std::filesystem::path(path).stem().string();
            file.board.image = path;
            file.board.board = options.board;
        } else {
            auto loaded = load_board_file(path);
            if (!loaded) return fail(loaded.error());
            file = std::move(*loaded);
        }
        const auto i = files.size();
        if (i < options.links.size()) file.link = options.links[i];
        if (i < options.tcp_ports.size()) file.tcp_port = options.tcp_ports[i];
        if (!names.insert(file.board.name).second)
            return fail(
                fmt::format("{}: another board is called {} too; give it a \"name\"", path, file.board.name));
        files.push_back(std::move(file));
    }
    share_worlds(files);
    if (options.links.size() > files.size()) return fail("--link: more links than boards");
    if (options.tcp_ports.size() > files.size()) return fail("--tcp: more ports than boards");
    return files;
}

int run_control(const Options& options) {
    const auto path = options.socket.value_or(usual_control_socket());
    const auto answer = send_control(path, fmt::format("{}", fmt::join(options.command, " ")));
    if (answer) {
        std::cout << *answer;
        return 0;
    }
    return report(answer.error().reached ? program::kExitFailure : program::kExitNoAnswer,
                  answer.error().text);
}

void write_stdout(std::string_view line) {
    std::fwrite(line.data(), 1, line.size(), stdout);
    std::fputc('\n', stdout);
    // The reader has gone. Boards that nothing watches must not run for ever.
    if (std::fflush(stdout) != 0) ::kill(::getpid(), SIGTERM);
}

std::chrono::microseconds slice_for(const Options& options, std::size_t boards, unsigned threads) {
    if (options.slice.count() > 0) return options.slice;
    return std::chrono::microseconds(boards <= threads ? 200 : 1000);
}

int run_boards(const Options& options) {
    auto files = load_boards(options);
    if (!files) return report(program::kExitUsage, files.error());

    Reporter reporter(options.json ? Reporter::Format::kJson : Reporter::Format::kText, write_stdout);
    std::vector<std::unique_ptr<LiveBoard>> boards;
    RoverNames rovers;
    for (std::size_t i = 0; i < files->size(); ++i) {
        auto board = LiveBoard::create((*files)[i], reporter);
        if (!board) {
            const auto& source = options.boards[i];
            const bool has_place = board.error().rfind(source, 0) == 0;
            return report(program::kExitUsage, has_place ? board.error() : source + ": " + board.error());
        }
        boards.push_back(std::move(*board));
        rovers.made((*files)[i]);
    }
    const unsigned threads =
        options.threads != 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());

    boost::asio::io_context context;
    std::unique_ptr<WorldPublisher> publisher;
    if (!options.publish_world.empty()) {
        auto created =
            WorldPublisher::create(context, options.publish_world, options.broker, *files, rovers.names());
        if (!created) return report(program::kExitUsage, created.error());
        publisher = std::move(*created);
    }
    boost::asio::signal_set signals(context, SIGINT, SIGTERM, SIGHUP);
    signals.async_wait([&](boost::system::error_code, int) { context.stop(); });
    RunningBoards running(std::move(boards), threads, slice_for(options, files->size(), threads));
    const auto execute = [&](std::string_view line, RunningBoards::Reply reply) {
        if (line.rfind("quit", 0) != 0) return running.execute(line, std::move(reply));
        reply(std::string());
        boost::asio::post(context, [&] { context.stop(); });
    };

    std::unique_ptr<ControlSocket> socket;
    if (!options.no_socket) {
        auto opened = ControlSocket::open(context, options.socket.value_or(usual_control_socket()), execute);
        if (opened)
            socket = std::move(*opened);
        else if (options.socket)
            return report(program::kExitUsage, opened.error());
        else
            std::cerr << "asip-sim: no control socket: " << opened.error() << '\n';
    }
    InputCommands input(context, [&](const std::string& line) {
        execute(line, [](const Expected<std::string>& answer) {
            if (!answer) std::cerr << "asip-sim: " << answer.error() << '\n';
            if (answer && !answer->empty()) std::cerr << *answer;
        });
    });
    context.run();
    if (publisher) {
        context.restart();
        publisher->end([&] { context.stop(); });
        context.run();
    }
    return 0;
}

}  // namespace
}  // namespace asip::sim

int main(int argc, char** argv) {
    asip::program::prepare_process();
    const auto options = asip::sim::read_options(argc, argv);
    if (!options) return options.error();
    return options->command.empty() ? asip::sim::run_boards(*options) : asip::sim::run_control(*options);
}
