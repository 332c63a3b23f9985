// SPDX-License-Identifier: Apache-2.0
#include "asip/client/blocking_board.hpp"

#include "asip/client/board.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_future.hpp>
#include <csignal>
#include <future>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

namespace asip::client {

using Json = nlohmann::json;
namespace asio = boost::asio;

namespace {

/// TLS writes to a broker that has gone as to a file: the kernel would end the application, which may not
/// have decided about SIGPIPE. This thread alone does not take it.
void ignore_broken_pipes() {
    sigset_t pipes;
    sigemptyset(&pipes);
    sigaddset(&pipes, SIGPIPE);
    pthread_sigmask(SIG_BLOCK, &pipes, nullptr);
}

}  // namespace

/// The loop, its thread, and what lives on that thread. Callers reach it by coroutines only, so that nothing
/// is shared.
class BlockingBoard::Runner {
  public:
    ~Runner() {
        asio::post(io_, [this] {
            board_.close();
            streams_.clear();
            inputs_.clear();
            board_ = Board();
            idle_.reset();
        });
        // What closing the board left to do comes before.
        if (ended_.get_future().wait_for(kMaxClosing) != std::future_status::ready) io_.stop();
        thread_.join();
    }

    /// Runs `make(board)`, a coroutine, on the loop's thread and returns what it returns.
    template <class T, class Make>
    Result<T> call(Make make) {
        auto work = [this, make = std::move(make)]() -> Awaitable<T> { co_return co_await make(*this); };
        return asio::co_spawn(io_, std::move(work), asio::use_future).get();
    }

    asio::io_context& io() { return io_; }
    Board& board() { return board_; }
    std::map<std::string, Stream<Json>>& streams() { return streams_; }
    /// An input that is waited for, and its level as it was told last.
    struct Input {
        Stream<bool> changes;
        bool level = false;
    };
    std::map<int, Input>& inputs() { return inputs_; }

  private:
    static constexpr std::chrono::seconds kMaxClosing{2};

    asio::io_context io_;
    asio::executor_work_guard<asio::io_context::executor_type> idle_ = asio::make_work_guard(io_);
    Board board_;
    std::map<std::string, Stream<Json>> streams_;
    std::map<int, Input> inputs_;
    std::promise<void> ended_;
    // Last: it runs as soon as it is made.
    std::thread thread_{[this] {
        ignore_broken_pipes();
        io_.run();
        ended_.set_value();
    }};
};

namespace {

Unexpected<Error> none() {
    return failure(Error::Kind::kClosed, "no board was opened");
}

}  // namespace

BlockingBoard::BlockingBoard() = default;
BlockingBoard::BlockingBoard(std::unique_ptr<Runner> runner) : runner_(std::move(runner)) {}
BlockingBoard::~BlockingBoard() = default;
BlockingBoard::BlockingBoard(BlockingBoard&&) noexcept = default;
BlockingBoard& BlockingBoard::operator=(BlockingBoard&&) noexcept = default;

Result<BlockingBoard> BlockingBoard::open(const std::string& address, Options options) {
    auto runner = std::make_unique<Runner>();
    const auto opened = runner->call<bool>([address, options](Runner& own) -> Awaitable<bool> {
        auto board = co_await Board::open(own.io(), address, options);
        if (!board) co_return Unexpected<Error>(board.error());
        own.board() = std::move(*board);
        co_return true;
    });
    if (!opened) return Unexpected<Error>(opened.error());
    return BlockingBoard(std::move(runner));
}

template <class T, class Make>
Result<T> BlockingBoard::call(Make make) const {
    return runner_ ? runner_->call<T>(std::move(make)) : Result<T>(none());
}

std::string BlockingBoard::name() const {
    return call<std::string>([](Runner& own) -> Awaitable<std::string> { co_return own.board().name(); })
        .value_or("");
}

bool BlockingBoard::online() const {
    return call<bool>([](Runner& own) -> Awaitable<bool> { co_return own.board().online(); }).value_or(false);
}

std::vector<ServiceInfo> BlockingBoard::services() const {
    using Infos = std::vector<ServiceInfo>;
    return call<Infos>([](Runner& own) -> Awaitable<Infos> { co_return own.board().services(); })
        .value_or(Infos());
}

std::map<std::string, std::string> BlockingBoard::labels() const {
    using Labels = std::map<std::string, std::string>;
    return call<Labels>([](Runner& own) -> Awaitable<Labels> { co_return own.board().labels(); })
        .value_or(Labels());
}

Result<void> BlockingBoard::set_pin_mode(int pin, protocol::PinMode mode) {
    return call<void>([=](Runner& own) { return own.board().set_pin_mode(pin, mode); });
}
Result<void> BlockingBoard::digital_write(int pin, bool level) {
    return call<void>([=](Runner& own) { return own.board().digital_write(pin, level); });
}
Result<void> BlockingBoard::analog_write(int pin, int value) {
    return call<void>([=](Runner& own) { return own.board().analog_write(pin, value); });
}
Result<bool> BlockingBoard::digital_read(int pin) {
    return call<bool>([=](Runner& own) { return own.board().digital_read(pin); });
}
Result<int> BlockingBoard::analog_read(int channel) {
    return call<int>([=](Runner& own) { return own.board().analog_read(channel); });
}
Result<void> BlockingBoard::set_analog_period(std::chrono::milliseconds period) {
    return call<void>([=](Runner& own) { return own.board().set_analog_period(period); });
}
Result<void> BlockingBoard::raw(const std::string& line) {
    return call<void>([line](Runner& own) { return own.board().raw(line); });
}

Result<Json> BlockingBoard::command(const std::string& service, const std::string& name,
                                    const Json& arguments) {
    return call<Json>([=](Runner& own) -> Awaitable<Json> {
        const auto found = own.board().service(service);
        if (!found) co_return Unexpected<Error>(found.error());
        co_return co_await found->command(name, arguments);
    });
}

Result<Json> BlockingBoard::command(const std::string& service, const std::string& name) {
    return command(service, name, Json::array());
}

Json BlockingBoard::values(const std::string& service) const {
    return call<Json>([service](Runner& own) -> Awaitable<Json> {
               const auto found = own.board().service(service);
               co_return found ? found->values() : Json();
           })
        .value_or(Json());
}

Result<bool> BlockingBoard::wait_for_change(int pin, std::chrono::milliseconds timeout) {
    return call<bool>([=](Runner& own) -> Awaitable<bool> {
        const Time end = Clock::now() + timeout;
        if (!own.inputs().contains(pin)) {
            Runner::Input input{own.board().digital_changes(pin)};
            const auto level = co_await own.board().digital_read(pin);
            if (!level) co_return Unexpected<Error>(level.error());
            input.level = *level;
            own.inputs().emplace(pin, std::move(input));
        }
        auto& input = own.inputs().at(pin);
        while (true) {
            const auto level = co_await input.changes.next(end - Clock::now());
            if (!level) co_return Unexpected<Error>(level.error());
            if (std::exchange(input.level, *level) != *level) co_return *level;
        }
    });
}

Result<void> BlockingBoard::watch(const std::string& service, double wanted_hz) {
    return call<void>([service, wanted_hz](Runner& own) -> Awaitable<void> {
        const auto found = own.board().service(service);
        if (!found) co_return Unexpected<Error>(found.error());
        own.streams().try_emplace(service, found->events(wanted_hz));
        co_return Result<void>();
    });
}

Result<Json> BlockingBoard::next_event(const std::string& service, std::chrono::milliseconds timeout) {
    return call<Json>([=](Runner& own) -> Awaitable<Json> {
        const auto found = own.streams().find(service);
        if (found == own.streams().end())
            co_return failure(Error::Kind::kInvalid, "call watch(\"" + service + "\") first");
        co_return co_await found->second.next(timeout);
    });
}

}  // namespace asip::client
