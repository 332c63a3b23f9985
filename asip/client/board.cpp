// SPDX-License-Identifier: Apache-2.0
#include "asip/client/board.hpp"

#include "asip/client/board_core.hpp"

namespace asip::client {
namespace {

using Json = nlohmann::json;

/// {"write":[13,1]}; built member by member, because g++ 12 cannot keep initializer lists in a coroutine's
/// frame.
Json make_command(const char* name, std::initializer_list<int> arguments) {
    Json command = Json::object();
    command[name] = Json::array();
    for (const int argument : arguments)
        command[name].push_back(argument);
    return command;
}

/// Both end together.
Subscription with_demand(Subscription subscription, std::shared_ptr<void> demand) {
    return Subscription(std::make_shared<std::pair<Subscription, std::shared_ptr<void>>>(
        std::move(subscription), std::move(demand)));
}

/// A stream that `signal` feeds and that ends with the board.
template <class T, class SignalType>
Stream<T> stream_of(Transport& transport, SignalType& signal, Signal<>& ended,
                    std::shared_ptr<void> demand = {}) {
    Stream<T> stream(transport.executor());
    const auto state = stream.state();
    auto feed = with_demand(signal.connect([state](const T& value) { Stream<T>::push(state, value); }),
                            std::move(demand));
    auto end = ended.connect([state] { Stream<T>::close(state); });
    stream.keep(std::make_shared<std::pair<Subscription, Subscription>>(std::move(feed), std::move(end)));
    return stream;
}

}  // namespace

Board::Board(std::shared_ptr<Core> core) {
    // The handles share an owner of their own that closes the core: coroutines in progress hold the core
    // itself.
    auto* const raw = core.get();
    core_ = std::shared_ptr<Core>(raw, [core = std::move(core)](Core*) { core->close(); });
}

Awaitable<Board> Board::open(std::unique_ptr<Transport> transport, const Options& options) {
    return open(std::make_shared<Core>(std::move(transport), options));
}

Awaitable<Board> Board::open(std::shared_ptr<Core> core) {
    const auto opened = co_await core->transport().open(*core);
    if (!opened) {
        core->close();
        co_return Unexpected<Error>(opened.error());
    }
    core->opened();
    co_return Board(core);
}

std::string Board::name() const {
    return core_ ? core_->transport().board_name() : std::string();
}
bool Board::online() const {
    return core_ && core_->online();
}
std::vector<ServiceInfo> Board::services() const {
    return core_ ? core_->transport().services() : std::vector<ServiceInfo>();
}

std::map<std::string, std::string> Board::labels() const {
    return core_ ? core_->transport().labels() : std::map<std::string, std::string>();
}

Awaitable<void> Board::set_pin_mode(int pin, protocol::PinMode mode) const {
    if (core_ && !protocol::is_digital_input(mode)) core_->forget_level(pin);
    return Core::io(owner(), make_command("mode", {pin, static_cast<int>(mode)}));
}

Awaitable<void> Board::digital_write(int pin, bool level) const {
    return Core::io(owner(), make_command("write", {pin, level ? 1 : 0}));
}

Awaitable<void> Board::analog_write(int pin, int value) const {
    return Core::io(owner(), make_command("pwm", {pin, value}));
}

Awaitable<bool> Board::digital_read(int pin) const {
    return Core::digital_read(owner(), pin);
}
Awaitable<int> Board::analog_read(int channel) const {
    return Core::analog_read(owner(), channel);
}

Awaitable<void> Board::set_analog_period(std::chrono::milliseconds period) const {
    return Core::io(owner(), make_command("report", {static_cast<int>(period.count())}));
}

Subscription Board::on_digital(int pin, std::function<void(bool)> changed) const {
    return core_ ? core_->digital(pin).connect(std::move(changed)) : Subscription();
}
Subscription Board::on_analog(int channel, std::function<void(int)> reported) const {
    return core_ ? with_demand(core_->analog(channel).connect(std::move(reported)),
                               core_->transport().demand("io", kUsualHz))
                 : Subscription();
}
Subscription Board::on_presence(std::function<void(bool)> changed) const {
    return core_ ? core_->presence().connect(std::move(changed)) : Subscription();
}
Stream<bool> Board::digital_changes(int pin) const {
    return core_ ? stream_of<bool>(core_->transport(), core_->digital(pin), core_->ended()) : Stream<bool>();
}

Result<Service> Board::service(const std::string& name) const {
    if (!core_) return failure(Error::Kind::kClosed, "the board was closed");
    std::string names;
    for (const ServiceInfo& each : core_->transport().services()) {
        if (each.name == name) return Service(core_, each);
        names += (names.empty() ? "" : ", ") + each.name;
    }
    return failure(Error::Kind::kInvalid,
                   "board " + this->name() + " has no service \"" + name + "\"; it has " + names);
}

Awaitable<void> Board::raw(std::string line) const {
    return Core::raw(owner(), std::move(line));
}

void Board::close() const {
    if (core_) core_->close();
}

std::shared_ptr<Board::Core> Board::owner() const {
    return core_ ? core_->shared_from_this() : nullptr;
}

Service::Service(std::shared_ptr<Board::Core> core, ServiceInfo info)
    : core_(std::move(core)), info_(std::move(info)) {}

Awaitable<nlohmann::json> Service::command(std::string name, nlohmann::json arguments) const {
    Json command = Json::object();
    command[name] = std::move(arguments);
    return Board::Core::command(core_ ? core_->shared_from_this() : nullptr, info_.name, std::move(command));
}

Awaitable<nlohmann::json> Service::command(std::string name) const {
    return command(std::move(name), Json::array());
}

Subscription Service::on_event(std::function<void(const nlohmann::json&)> happened, double wanted_hz) const {
    return core_ ? with_demand(core_->events(info_.name).connect(std::move(happened)),
                               core_->transport().demand(info_.name, wanted_hz))
                 : Subscription();
}

nlohmann::json Service::values() const {
    return core_ ? core_->transport().values(info_.name) : Json();
}

Subscription Service::on_values(std::function<void(const nlohmann::json&)> changed) const {
    return core_ ? core_->values(info_.name).connect(std::move(changed)) : Subscription();
}

Stream<nlohmann::json> Service::events(double wanted_hz) const {
    return core_ ? stream_of<Json>(core_->transport(), core_->events(info_.name), core_->ended(),
                                   core_->transport().demand(info_.name, wanted_hz))
                 : Stream<Json>();
}

}  // namespace asip::client
