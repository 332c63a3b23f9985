// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <optional>
#include <string>
#include <utility>

#include "tests/truth/presence/views.hpp"
#include "tests/truth/values/views.hpp"
#include "tests/truth/week/resources.hpp"

namespace truth::week {

using namespace std::chrono_literals;
using asip::Duration;
using asip::Time;
using nlohmann::json;
using presence::Message;
using presence::SimBroker;

inline constexpr const char* kServo = "servo/0/angle";

/// Files of a registry.
struct Disk {
    Disk(const std::string& folder, asip::catalogue::Instant now)
        : history(io, {.path = folder + "/history.db", .max_bytes = kHistoryBytes, .own_thread = false},
                  handlers<asip::registry::HistoryKeeper>(), "boot", now),
          values(io, {.path = folder + "/values.db", .max_bytes = kValuesBytes, .own_thread = false},
                 handlers<asip::registry::ValueKeeper>(), now) {}
    template <class Keeper>
    typename Keeper::Handlers handlers() {
        return {[this](const std::string& why) { fault = why; }, [](std::size_t) {},
                [this](const std::string&, const std::string& damage) { fault = damage; }};
    }
    boost::asio::io_context io;
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work{io.get_executor()};
    std::string fault;  ///< empty: none
    asip::registry::HistoryKeeper history;
    asip::registry::ValueKeeper values;
};

/// asip-registry with its files, on a machine whose clock is wrong by `clock_set`.
class RegistryProgram final : Disk, public presence::RegistryView {
  public:
    RegistryProgram(SimBroker& broker, asip::test::Dice& dice, const std::string& folder,
                    const Duration& clock_set, Time now)
        : Disk(folder, presence::instant(now)),
          RegistryView(broker, dice, options(), {&history, &values}, now),
          clock_set_(clock_set) {
        io.poll();
    }

    void tick(Time now) override {
        RegistryView::tick(now);
        io.poll();
    }
    asip::bus::Answer find(const json& query, Time now) {
        ask(query.dump(), now);
        io.poll();
        if (!answer() || !answer()->refused.empty())
            fault = query.dump() + ": " + (answer() ? answer()->error : "no answer");
        return answer().value_or(asip::bus::Answer());
    }
    /// The angle of a servo that was kept last; without a point it is not known. Of what is not `fine` a
    /// point stands for a minute or more.
    struct Kept {
        bool fine;
        std::optional<asip::bus::ValuePoint> point;
    };
    Kept servo(const std::string& board, Time now) {
        const auto to = moment(now).wall;
        const auto found = find({{"find", "values"},
                                 {"board", board},
                                 {"property", kServo},
                                 {"from", asip::text::iso_time(to - 4h)},
                                 {"to", asip::text::iso_time(to)}},
                                now);
        const bool known = !found.values.empty() && found.values.back().known;
        return {found.level == "changes", known ? std::optional(found.values.back()) : std::nullopt};
    }
    /// What it says of its files; empty: nothing.
    const std::string& disk_fault() const { return fault; }

  private:
    static asip::registry::RegistryOptions options() {
        asip::registry::RegistryOptions options;
        options.id = "r1";
        options.values = {std::string("*/") + kServo};
        return options;
    }
    asip::catalogue::Instant moment(Time now) const override {
        auto moment = presence::instant(now);
        moment.wall += std::chrono::duration_cast<std::chrono::milliseconds>(clock_set_);
        return moment;
    }
    const Duration& clock_set_;
};

/// asip-gateway with one of its exports.
class GatewayProgram final : public presence::View {
  public:
    GatewayProgram(SimBroker& broker, unsigned dialect, Time now)
        : View(broker, "gateway"), gateway_(values::Retained()), exports_(dialect), now_(now) {
        gateway_.pass(std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch()));
        exports_.start(gateway_.core());
    }
    ~GatewayProgram() override { exports_.stop(); }

    void tick(Time now) override {
        const auto time = std::chrono::duration_cast<std::chrono::milliseconds>(now - now_);
        now_ += time;
        gateway_.pass(time);
        exports_.pass(time);
        send(now);
    }
    /// The broker comes back empty, also that of the export.
    void lose_stored() { exports_.restart_broker(); }
    bool is_complete() const override { return true; }
    std::optional<asip::bus::BoardItem> board(const std::string& name, Time) override {
        return gateway_.core().mirror().board(name, gateway_.core().now());
    }
    /// The angle of the board's servo; none: it is not known. Of `uno1` the export has to show the same.
    std::optional<int> servo(const std::string& board) {
        const auto values = gateway_.values(board);
        const auto found = values.find(kServo);
        if (found == values.end() || !found->value("value", json()).is_number()) return std::nullopt;
        const int angle = (*found)["value"];
        const bool same = board != "uno1" || exports_.shown(kServo) == exports_.text_of(kServo, angle);
        return same ? angle : -1;
    }

  private:
    void on_connected(Time now) override {
        for (const auto& [filter, retained] : gateway_.core().subscriptions())
            broker_.subscribe(client_, filter, false, retained, now);
        broker_.subscribe(client_, "asip/reply/gate/#", false, false, now);
        for (auto& message : gateway_.back())
            broker_.publish(client_, std::move(message), now);
    }
    void on_disconnected(Time) override { gateway_.lost(); }
    void on_message(const Message& message, Time now) override {
        exports_.ahead(message.topic, message.payload);
        gateway_.take(message.topic, message.payload, message.retain);
        exports_.behind();
        send(now);
    }
    void send(Time now) {
        for (auto& message : gateway_.published())
            if (client_ != 0) broker_.publish(client_, std::move(message), now);
    }

    values::Gateway gateway_;
    values::Exports exports_;
    Time now_;
};

}  // namespace truth::week
