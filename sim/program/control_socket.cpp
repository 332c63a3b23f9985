// SPDX-License-Identifier: Apache-2.0
#include "sim/program/control_socket.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/buffers_iterator.hpp>
#include <boost/asio/connect.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/streambuf.hpp>
#include <boost/asio/write.hpp>
#include <cstdlib>
#include <istream>

#include "asip/protocol/request.hpp"

namespace asip::sim {
namespace {

using Protocol = boost::asio::local::stream_protocol;
using boost::system::error_code;

constexpr std::size_t kMaxCommandBytes = 1024;
constexpr std::size_t kMaxPathBytes = sizeof(sockaddr_un::sun_path) - 1;

std::string answer_text(const Expected<std::string>& answer) {
    if (!answer) return "error " + answer.error() + "\n";
    std::string text;
    std::string_view rest = *answer;
    while (!rest.empty()) {
        const auto end = std::min(rest.find('\n'), rest.size());
        text += fmt::format(" {}\n", rest.substr(0, end));
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return text + "ok\n";
}

using Place = boost::asio::buffers_iterator<boost::asio::streambuf::const_buffers_type>;

std::pair<Place, bool> line_end(Place begin, Place end) {
    using protocol::kRequestEnds;
    const auto at = std::find_first_of(begin, end, kRequestEnds.begin(), kRequestEnds.end());
    return {at == end ? end : std::next(at), at != end};
}

bool somebody_answers(boost::asio::io_context& context, const std::filesystem::path& path) {
    Protocol::socket probe(context);
    error_code error;
    probe.connect(Protocol::endpoint(path.string()), error);
    return !error;
}

}  // namespace

class ControlSocket::Connection : public std::enable_shared_from_this<Connection> {
  public:
    Connection(boost::asio::io_context& context, Protocol::socket socket, Execute execute)
        : context_(context),
          socket_(std::move(socket)),
          input_(kMaxCommandBytes),
          execute_(std::move(execute)) {}

    void read() {
        boost::asio::async_read_until(
            socket_, input_, line_end, [self = shared_from_this()](error_code error, std::size_t size) {
                if (error) return;
                const auto begin = boost::asio::buffers_begin(self->input_.data());
                const std::string line(begin, begin + static_cast<std::ptrdiff_t>(size - 1));
                self->input_.consume(size);
                if (line.empty()) return self->read();
                self->execute_(line, [self](Expected<std::string> answer) {
                    boost::asio::post(self->context_,
                                      [self, text = answer_text(answer)] { self->write(text); });
                });
            });
    }

  private:
    void write(std::string text) {
        output_ = std::move(text);
        boost::asio::async_write(socket_, boost::asio::buffer(output_),
                                 [self = shared_from_this()](error_code error, std::size_t) {
                                     if (!error) self->read();
                                 });
    }

    boost::asio::io_context& context_;
    Protocol::socket socket_;
    boost::asio::streambuf input_;
    std::string output_;
    Execute execute_;
};

Expected<std::unique_ptr<ControlSocket>> ControlSocket::open(boost::asio::io_context& context,
                                                             const std::filesystem::path& path,
                                                             Execute execute) {
    if (path.string().size() > kMaxPathBytes)
        return fail(
            fmt::format("{}: the path of a socket has at most {} bytes", path.string(), kMaxPathBytes));
    std::error_code error;
    if (std::filesystem::exists(path, error)) {
        if (!std::filesystem::is_socket(path, error))
            return fail(path.string() + ": exists and is not a socket");
        if (somebody_answers(context, path))
            return fail(path.string() + ": another asip-sim listens there; choose one with --socket");
        std::filesystem::remove(path, error);
    }
    std::unique_ptr<ControlSocket> socket(new ControlSocket(context, path, std::move(execute)));
    error_code failed;
    socket->acceptor_.open(Protocol(), failed);
    const auto mask = ::umask(0077);  // only the user who started the boards may press buttons
    if (!failed) socket->acceptor_.bind(Protocol::endpoint(path.string()), failed);
    ::umask(mask);
    if (failed) {
        socket->path_.clear();
        return fail(path.string() + ": cannot listen there: " + failed.message());
    }
    socket->acceptor_.listen(boost::asio::socket_base::max_listen_connections, failed);
    socket->accept();
    return socket;
}

ControlSocket::ControlSocket(boost::asio::io_context& context, std::filesystem::path path, Execute execute)
    : context_(context), acceptor_(context), path_(std::move(path)), execute_(std::move(execute)) {}

ControlSocket::~ControlSocket() {
    if (!path_.empty()) ::unlink(path_.c_str());
}

void ControlSocket::accept() {
    acceptor_.async_accept([this](error_code error, Protocol::socket socket) {
        if (error) return;
        std::make_shared<Connection>(context_, std::move(socket), execute_)->read();
        accept();
    });
}

std::filesystem::path usual_control_socket() {
    const char* runtime = std::getenv("XDG_RUNTIME_DIR");
    if (runtime != nullptr && *runtime != '\0') return std::filesystem::path(runtime) / "asip-sim.sock";
    return fmt::format("/tmp/asip-sim-{}.sock", ::getuid());
}

Expected<std::string, ControlError> send_control(const std::filesystem::path& path, std::string_view line) {
    const auto failed = [](bool reached, std::string text) {
        return Unexpected<ControlError>(ControlError{reached, std::move(text)});
    };
    if (path.string().size() > kMaxPathBytes)
        return failed(false, path.string() + ": too long for a socket's path");
    boost::asio::io_context context;
    Protocol::socket socket(context);
    error_code error;
    socket.connect(Protocol::endpoint(path.string()), error);
    if (error)
        return failed(false,
                      fmt::format("{}: no asip-sim answers there ({})", path.string(), error.message()));
    boost::asio::write(socket, boost::asio::buffer(std::string(line) + "\n"), error);
    boost::asio::streambuf input;
    std::istream stream(&input);
    std::string text;
    while (!error) {
        boost::asio::read_until(socket, input, '\n', error);
        std::string answer;
        if (error || !std::getline(stream, answer)) break;
        if (answer == "ok") return text;
        if (answer.rfind("error ", 0) == 0) return failed(true, answer.substr(6));
        text += answer.substr(1) + "\n";
    }
    return failed(true, "asip-sim ended before it answered");
}

}  // namespace asip::sim
