// SPDX-License-Identifier: Apache-2.0
#include "agent/program/loader.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <utility>

#include "asip/time.hpp"

extern char** environ;

namespace asip::agent {
namespace {

// One attempt: the longest is a Mega at 115200 baud, written and read back.
constexpr Duration kAttemptLimit = std::chrono::seconds(60);
constexpr Duration kReapAgain = std::chrono::milliseconds(10);
constexpr Duration kLook = std::chrono::milliseconds(500);

/// Which device is at `path` now; {}: none.
std::pair<dev_t, ino_t> device_at(const std::string& path) {
    struct stat found{};
    return ::stat(path.c_str(), &found) == 0 ? std::pair(found.st_dev, found.st_ino)
                                             : std::pair<dev_t, ino_t>();
}

std::string image_of(const std::filesystem::path& folder, const std::string& firmware,
                     const link::BootLoader& loader) {
    return (folder / (firmware + "-" + std::string(loader.image) + ".hex")).string();
}

}  // namespace

int loadable_version(const std::filesystem::path& folder, const std::string& sketch,
                     const std::string& chip) {
    const auto loader = link::boot_loader_of_chip(chip);
    std::ifstream file(folder / "versions");
    std::string name;
    std::error_code error;
    for (int version = 0; loader && file >> name >> version;)
        if (name == sketch)  // which is no path elsewhere
            return std::filesystem::is_regular_file(image_of(folder, sketch, *loader), error) ? version : 0;
    return 0;
}

class Loader::Impl : public std::enable_shared_from_this<Impl> {
  public:
    Impl(boost::asio::io_context& io, Order order, Handlers handlers)
        : order_(std::move(order)), handlers_(std::move(handlers)), pipe_(io), limit_(io), wait_(io) {}

    void next() {
        output_ = link::AvrdudeOutput();
        const auto& loader = order_.loaders[attempt_];
        const auto image = image_of(order_.folder, order_.firmware, loader);
        std::error_code error;
        if (!std::filesystem::is_regular_file(image, error))
            return done(
                fail("the machine of the board has no firmware " + image +
                     "; it comes with the package asip-agent, or by firmware-dir of the configuration"));
        if (const auto started = start(link::avrdude_call(loader, order_.avrdude, order_.port, image));
            !started)
            return done(fail(started.error()));
        tell();
        read();
        device_ = device_at(order_.port);
        watch(Clock::now() + kAttemptLimit);
    }

    void end() {
        handlers_ = {};
        kill();
        if (pid_ > 0) ::waitpid(pid_, nullptr, 0);
        pid_ = 0;
        boost::system::error_code ignored;
        pipe_.close(ignored);
        limit_.cancel();
        wait_.cancel();
    }

  private:
    Expected<void> start(const std::vector<std::string>& call) {
        std::array<int, 2> ends{};
        if (::pipe2(ends.data(), O_CLOEXEC) != 0)
            return fail(std::string("no pipe: ") + std::strerror(errno));
        std::vector<char*> arguments;
        for (const auto& word : call)
            arguments.push_back(const_cast<char*>(word.c_str()));
        arguments.push_back(nullptr);
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
        posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
        posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
        const int problem = posix_spawnp(&pid_, arguments[0], &actions, nullptr, arguments.data(), environ);
        posix_spawn_file_actions_destroy(&actions);
        ::close(ends[1]);
        if (problem != 0) {
            ::close(ends[0]);
            pid_ = 0;
            if (problem == ENOENT) return fail(output_.failure(127, order_.port, order_.avrdude));
            return fail(order_.avrdude + " cannot be started: " + std::strerror(problem));
        }
        pipe_.assign(ends[0]);
        return {};
    }

    void read() {
        pipe_.async_read_some(
            boost::asio::buffer(bytes_),
            [self = shared_from_this()](boost::system::error_code error, std::size_t bytes) {
                if (self->pid_ == 0) return;
                if (error) return self->reap();
                self->output_.take({self->bytes_.data(), bytes});
                self->tell();
                self->read();
            });
    }

    // On a port that is gone avrdude tries for ever.
    void watch(Time until) {
        limit_.expires_after(kLook);
        limit_.async_wait([weak = weak_from_this(), until](boost::system::error_code ended) {
            const auto self = weak.lock();
            if (!self || ended) return;
            self->unplugged_ = self->device_ != device_at(self->order_.port);
            if (self->unplugged_ || Clock::now() >= until) return self->kill();
            self->watch(until);
        });
    }

    void tell() {
        const std::pair now(output_.step(), output_.percent());
        if (told_ == now || !handlers_.on_progress) return;
        told_ = now;
        handlers_.on_progress(now.first, now.second);
    }

    // It has closed its output, and ends.
    void reap() {
        int status = 0;
        if (::waitpid(pid_, &status, WNOHANG) != pid_) {
            wait_.expires_after(kReapAgain);
            wait_.async_wait([weak = weak_from_this()](boost::system::error_code error) {
                if (const auto self = weak.lock(); self && !error && self->pid_ != 0) self->reap();
            });
            return;
        }
        pid_ = 0;
        limit_.cancel();
        boost::system::error_code ignored;
        pipe_.close(ignored);
        const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
        if (code == 0) return done({});
        if (unplugged_)
            return done(fail("the board was unplugged while it was loaded; plug it in, and load it again"));
        output_.take("\n");
        const bool silent = code == 128 + SIGKILL;
        if ((output_.may_be_another() || silent) && ++attempt_ < order_.loaders.size()) return next();
        done(fail(output_.failure(code, order_.port, order_.avrdude)));
    }

    void kill() {
        if (pid_ > 0) ::kill(pid_, SIGKILL);
    }

    void done(const Expected<void>& result) {
        if (handlers_.on_done) std::exchange(handlers_.on_done, {})(result);
    }

    Order order_;
    Handlers handlers_;
    std::size_t attempt_ = 0;
    pid_t pid_ = 0;
    std::pair<dev_t, ino_t> device_;
    bool unplugged_ = false;
    link::AvrdudeOutput output_;
    std::optional<std::pair<std::string_view, int>> told_;
    boost::asio::posix::stream_descriptor pipe_;
    boost::asio::steady_timer limit_;
    boost::asio::steady_timer wait_;
    std::array<char, 512> bytes_{};
};

Loader::Loader(boost::asio::io_context& io, Order order, Handlers handlers)
    : impl_(std::make_shared<Impl>(io, std::move(order), std::move(handlers))) {
    boost::asio::post(io, [weak = std::weak_ptr(impl_)] {
        if (const auto impl = weak.lock()) impl->next();
    });
}

Loader::~Loader() {
    impl_->end();
}

}  // namespace asip::agent
