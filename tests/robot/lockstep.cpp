// SPDX-License-Identifier: Apache-2.0
#include "tests/robot/lockstep.hpp"

#include <fmt/format.h>

#include <deque>
#include <optional>
#include <random>
#include <stdexcept>

#include "asip/protocol/body.hpp"
#include "asip/session/board_session.hpp"
#include "sim/board.hpp"
#include "sim/world/world_file.hpp"

namespace asip::test {

using namespace std::chrono_literals;

Path serial_path() {
    return {};
}
Path tcp_path() {
    return {"tcp", 500us, 500us, 0};
}
Path mqtt_path() {
    return {"mqtt", 1ms, 2ms, 0};
}

double Driven::mean(double sim::world::Lap::* value) const {
    const std::size_t first = laps.size() > 1 ? 1 : 0;
    double sum = 0;
    for (std::size_t i = first; i < laps.size(); ++i)
        sum += laps[i].*value;
    return laps.empty() ? 0 : sum / static_cast<double>(laps.size() - first);
}

namespace {

constexpr auto kSlice = 100us;

/// Messages on their way in one direction.
template <class T>
class Delay {
  public:
    Delay(const Path& path, unsigned seed) : path_(path), random_(seed) {}

    void send(T message, Time now) {
        if (share() < path_.loss) return;
        const auto jitter = std::chrono::duration_cast<Duration>(path_.jitter * share());
        const auto due = now + path_.latency + jitter;
        queue_.push_back({queue_.empty() ? due : std::max(due, queue_.back().due), std::move(message)});
    }
    std::optional<T> take(Time now) {
        if (queue_.empty() || queue_.front().due > now) return std::nullopt;
        auto message = std::move(queue_.front().message);
        queue_.pop_front();
        return message;
    }

  private:
    struct Item {
        Time due;
        T message;
    };
    double share() { return static_cast<double>(random_()) / 4294967296.0; }

    Path path_;
    std::mt19937 random_;
    std::deque<Item> queue_;
};

using Sensors = std::array<int, 3>;

std::optional<Sensors> reflectance(const protocol::ParsedLine& line) {
    if (!line.is_event() || line.event().service != 'R' || line.event().tag != 'e') return std::nullopt;
    const auto body = protocol::parse_body(line.event().body);
    if (!body || body->items.size() != 3) return std::nullopt;
    Sensors sensors{};
    for (std::size_t i = 0; i < 3; ++i)
        sensors[i] = static_cast<int>(protocol::parse_integer(body->items[i]).value_or(0));
    return sensors;
}

class Lockstep {
  public:
    Lockstep(const Drive& how, const std::string& image, const std::string& world_file)
        : how_(how),
          controller_(how.gains),
          session_(session::SessionOptions{}, std::mt19937_64(how.seed)),
          up_(how.path, how.seed),
          down_(how.path, how.seed + 1) {
        auto world = sim::world::load_world(world_file);
        if (!world) throw std::runtime_error(world.error());
        world_ = std::move(*world);
        sim::BoardConfig config;
        config.image = image;
        config.parts = {{"rover", nlohmann::json::object(), "rover"}};
        config.world = world_;
        auto board = sim::Board::create(config);
        if (!board) throw std::runtime_error(board.error());
        board_ = std::move(*board);
    }

    Driven run() {
        session::Actions actions;
        session_.link_up({57600, true}, now(), actions);
        perform(actions);
        run_until_ready();
        submit(fmt::format("R,A,{}", how_.period / 1ms));
        const auto began = board_->now();
        while (driven_.laps.size() < how_.laps && driven_.stayed && board_->now() - began < how_.limit) {
            step();
            judge();
        }
        driven_.took = board_->now() - began;
        return driven_;
    }

  private:
    Time now() const { return Time{} + 1h + board_->now(); }

    void run_until_ready() {
        while (session_.state() != session::BoardSession::State::kReady || session_.baud() < 500'000) {
            step();
            if (board_->now() > 20s) throw std::runtime_error("the board does not become ready");
        }
    }

    /// A slice of the board's time, and all that is due then.
    void step() {
        board_->run_for(kSlice);
        session::Actions actions;
        if (const auto bytes = board_->take_output(); !bytes.empty()) session_.receive(bytes, now(), actions);
        if (rate_ && board_->sending() == 0) {
            board_->set_host_baud(*rate_);
            rate_.reset();
            session_.line_rate_set(true, now(), actions);
        }
        if (const auto due = session_.next_deadline(); due && *due <= now()) session_.tick(now(), actions);
        perform(actions);
        while (const auto sensors = up_.take(now())) {
            const auto powers = controller_.drive(*sensors);
            ++driven_.reports;
            down_.send(fmt::format("M,M,{},{}", powers[0], powers[1]), now());
        }
        while (const auto command = down_.take(now()))
            submit(*command);
    }

    void submit(const std::string& line) {
        session::Actions actions;
        if (!session_.submit(line, {}, now(), actions)) ++driven_.unproven;
        perform(actions);
    }

    void perform(const session::Actions& actions) {
        for (const auto& action : actions) {
            if (const auto* write = std::get_if<session::Write>(&action)) board_->send(write->bytes);
            if (const auto* rate = std::get_if<session::SetLineRate>(&action)) rate_ = rate->baud;
            if (const auto* end = std::get_if<session::Finished>(&action))
                ++(end->ending == session::Ending::kExecuted ? driven_.commands : driven_.unproven);
            if (const auto* line = std::get_if<session::BoardLine>(&action))
                if (const auto sensors = reflectance(line->line)) up_.send(*sensors, now());
        }
    }

    void judge() {
        const auto rover = world_->state(0);
        driven_.stayed = rover.on_track;
        if (rover.laps > driven_.laps.size()) driven_.laps.push_back(rover.last_lap);
    }

    Drive how_;
    LineController controller_;
    std::shared_ptr<sim::world::World> world_;
    std::unique_ptr<sim::Board> board_;
    session::BoardSession session_;
    Delay<Sensors> up_;
    Delay<std::string> down_;
    std::optional<unsigned> rate_;
    Driven driven_;
};

}  // namespace

Driven drive(const Drive& how, const std::string& image, const std::string& world_file) {
    return Lockstep(how, image, world_file).run();
}

}  // namespace asip::test
