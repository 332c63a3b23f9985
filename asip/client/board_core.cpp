// SPDX-License-Identifier: Apache-2.0
#include "asip/client/board_core.hpp"

#include <charconv>

namespace asip::client {
namespace {

namespace asio = boost::asio;

Unexpected<Error> closed() {
    return failure(Error::Kind::kClosed, "the board was closed");
}
Unexpected<Error> away(const std::string& name) {
    return failure(Error::Kind::kUnreachable, "board " + name + " is not there now");
}

/// Calls `take(number, value)` for each member of {"2":1,"3":0}.
template <class Take>
void for_each_number(const nlohmann::json& members, Take take) {
    if (!members.is_object()) return;
    for (const auto& [key, value] : members.items()) {
        int number = 0;
        const auto [end, code] = std::from_chars(key.data(), key.data() + key.size(), number);
        if (code == std::errc{} && end == key.data() + key.size() && value.is_number_integer())
            take(number, value.template get<int>());
    }
}

/// The mode of a pin in the answer to `modes`; nothing when the board did not report it.
std::optional<protocol::PinMode> mode_of(const nlohmann::json& answer, int pin) {
    std::optional<protocol::PinMode> mode;
    const auto modes = answer.is_object() ? answer.find("modes") : answer.end();
    if (modes == answer.end()) return mode;
    if (modes->is_array() && pin >= 0 && static_cast<std::size_t>(pin) < modes->size() &&
        (*modes)[static_cast<std::size_t>(pin)].is_number_integer()) {
        return protocol::pin_mode_from_number((*modes)[static_cast<std::size_t>(pin)].get<int>());
    }
    for_each_number(*modes, [&](int number, int value) {
        if (number == pin) mode = protocol::pin_mode_from_number(value);
    });
    return mode;
}

}  // namespace

Board::Core::Core(std::unique_ptr<Transport> transport, Options options)
    : transport_(std::move(transport)), options_(std::move(options)) {}

Board::Core::~Core() {
    close();
}

nlohmann::json Transport::values(const std::string&) const {
    return {};
}

void Board::Core::opened() {
    online_ = true;
}

void Board::Core::close() {
    if (closed_) return;
    closed_ = true;
    transport_->close();
    wake();
    ended_.emit();
}

void Board::Core::on_event(const std::string& service, const Json& event) {
    if (closed_) return;
    const auto self = shared_from_this();  // a callback may drop the last Board
    if (service == "io" && event.is_object()) {
        if (const auto levels = event.find("digital"); levels != event.end()) take_digital(*levels);
        if (const auto values = event.find("analog"); values != event.end()) take_analog(*values);
    }
    if (const auto found = events_.find(service); found != events_.end()) found->second.emit(event);
    wake();
}

void Board::Core::on_presence(bool there) {
    if (closed_ || there == online_) return;
    const auto self = shared_from_this();
    online_ = there;
    levels_.clear();
    samples_.clear();
    presence_.emit(there);
    wake();
}

void Board::Core::on_values(const std::string& service) {
    if (closed_) return;
    const auto self = shared_from_this();
    if (const auto found = values_.find(service); found != values_.end())
        found->second.emit(transport_->values(service));
    wake();
}

void Board::Core::take_digital(const Json& levels) {
    for_each_number(levels, [this](int pin, int value) {
        const bool level = value != 0;
        const auto [place, is_new] = levels_.try_emplace(pin, level);
        if (!is_new && place->second == level) return;
        place->second = level;
        if (const auto found = digital_.find(pin); found != digital_.end()) found->second.emit(level);
    });
}

void Board::Core::take_analog(const Json& values) {
    const Time now = Clock::now();
    for_each_number(values, [this, now](int channel, int value) {
        samples_.insert_or_assign(channel, Sample{value, now});
        if (const auto found = analog_signals_.find(channel); found != analog_signals_.end())
            found->second.emit(value);
    });
}

std::optional<int> Board::Core::fresh_sample(int channel) const {
    const auto found = samples_.find(channel);
    if (found == samples_.end() || Clock::now() - found->second.when > options_.analog_max_age)
        return std::nullopt;
    return found->second.value;
}

void Board::Core::wake() {
    for (asio::steady_timer* waiter : waiters_)
        waiter->cancel();
}

template <class Condition>
asio::awaitable<bool> Board::Core::wait_for(std::shared_ptr<Core> core, Condition holds, Duration limit) {
    asio::steady_timer timer(core->transport_->executor(), Clock::now() + limit);
    // The frame may be destroyed while it is suspended, by the end of its io_context.
    const auto leave = [&core](asio::steady_timer* waiter) { core->waiters_.erase(waiter); };
    const std::unique_ptr<asio::steady_timer, decltype(leave)> waiting(&timer, leave);
    core->waiters_.insert(&timer);
    while (!holds() && core->online() && Clock::now() < timer.expiry()) {
        boost::system::error_code woken;
        co_await timer.async_wait(asio::redirect_error(asio::use_awaitable, woken));
    }
    co_return holds();
}

Awaitable<nlohmann::json> Board::Core::command(std::shared_ptr<Core> core, std::string service,
                                               Json command) {
    if (!core || core->closed_) co_return closed();
    if (!core->online_) co_return away(core->transport_->board_name());
    co_return co_await core->transport_->command(std::move(service), std::move(command));
}

Awaitable<void> Board::Core::raw(std::shared_ptr<Core> core, std::string line) {
    if (!core || core->closed_) co_return closed();
    if (!core->online_) co_return away(core->transport_->board_name());
    co_return co_await core->transport_->raw(std::move(line));
}

Awaitable<void> Board::Core::io(std::shared_ptr<Core> core, Json command) {
    const auto done = co_await Core::command(std::move(core), "io", std::move(command));
    if (!done) co_return Unexpected<Error>(done.error());
    co_return Result<void>();
}

Awaitable<bool> Board::Core::digital_read(std::shared_ptr<Core> core, int pin) {
    if (!core || core->closed_) co_return closed();
    if (const auto known = core->levels_.find(pin); core->online_ && known != core->levels_.end())
        co_return known->second;
    Json ask = Json::object();
    ask["modes"] = Json::array();
    const auto answer = co_await command(core, "io", std::move(ask));
    if (!answer) co_return Unexpected<Error>(answer.error());
    const auto mode = mode_of(*answer, pin);
    if (!mode || !protocol::is_digital_input(*mode)) {
        co_return failure(Error::Kind::kInvalid,
                          "pin " + std::to_string(pin) + " is not a digital input" +
                              (mode ? ", its mode is " + std::string(to_text(*mode)) : "") +
                              "; set_pin_mode makes it one");
    }
    // A board of ours tells its levels when it is asked; others when they change. Nothing is set to learn
    // one.
    ask = Json::object();
    ask["levels"] = Json::array();
    if (const auto told = co_await command(core, "io", std::move(ask)); told && told->contains("levels"))
        core->take_digital((*told)["levels"]);
    const auto known = [core, pin] { return core->levels_.contains(pin); };
    if (co_await wait_for(core, known, core->options_.read_timeout)) co_return core->levels_.at(pin);
    co_return core->closed_ ? closed()
    : core->online_ ? failure(Error::Kind::kTimeout, "the board did not report pin " + std::to_string(pin))
                    : away(core->transport_->board_name());
}

Awaitable<int> Board::Core::analog_read(std::shared_ptr<Core> core, int channel) {
    if (!core || core->closed_) co_return closed();
    if (!core->online_) co_return away(core->transport_->board_name());
    const auto demand = core->transport_->demand("io", kUsualHz);
    const auto known = [core, channel] { return core->fresh_sample(channel).has_value(); };
    if (co_await wait_for(core, known, core->options_.read_timeout)) co_return *core->fresh_sample(channel);
    co_return core->closed_ ? closed()
    : core->online_         ? failure(Error::Kind::kTimeout,
                                      "the board did not report analog channel " + std::to_string(channel) +
                                          "; is its pin in analog mode, and are reports on (set_analog_period)?")
                            : away(core->transport_->board_name());
}

}  // namespace asip::client
