// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/presence/views.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "asip/bus/registry/query.hpp"
#include "asip/catalogue/bus_view.hpp"
#include "gateway/mirror/mirror.hpp"

namespace truth::presence {

asip::catalogue::Instant instant(Time now) {
    constexpr auto kDay = std::chrono::milliseconds(1'790'000'000'000);
    return {now, asip::text::WallTime(
                     kDay + std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch()))};
}

void View::connect(Time now) {
    client_ = broker_.connect([this](const Message& message, Time at) { on_message(message, at); });
    connected_at_ = now;
    on_connected(now);
}

bool View::heard(Time time) const {
    const Time from = time - std::chrono::seconds(1);
    const Time until = time + std::chrono::seconds(1);
    return (is_connected() && connected_at_ < from) ||
           std::any_of(connections_.begin(), connections_.end(),
                       [&](const auto& one) { return one.first < from && until < one.second; });
}

void View::disconnect(Time now) {
    connections_.emplace_back(connected_at_, now);
    broker_.end(std::exchange(client_, 0), false, now);
    on_disconnected(now);
}

namespace {

constexpr const char* kAnswers = "answers";

}  // namespace

RegistryView::RegistryView(SimBroker& broker, Dice& dice, const asip::registry::RegistryOptions& options,
                           const Files& files, Time now)
    : View(broker, "registry " + options.id), id_(options.id), now_(now) {
    asip::registry::Port port;
    port.publish = [this](Message message) {
        if (message.topic == topics_.registry_events(id_)) return event(message);
        if (message.topic != kAnswers) {
            if (client_ != 0) broker_.publish(client_, std::move(message), now_);
        } else if (auto read = asip::bus::parse_answer(message.payload)) {
            answer_ = std::move(*read);
        }
    };
    port.subscribe = [this](const std::string& filter, bool retained) {
        filters_[filter] = retained;
        if (client_ != 0) broker_.subscribe(client_, filter, false, retained, now_);
    };
    port.unsubscribe = [this](const std::string& filter) {
        filters_.erase(filter);
        broker_.unsubscribe(client_, filter);
    };
    registry_.emplace(
        options, asip::model::ModelSet{}, [&dice] { return dice.draw(); }, port, files.history, instant(now),
        files.values);
}

void RegistryView::tick(Time now) {
    now_ = now;
    registry_->tick(moment(now));
}

const std::optional<asip::bus::Answer>& RegistryView::ask(const std::string& query, Time now) {
    now_ = now;
    Message message;
    message.topic = topics_.registry_query(id_);
    message.payload = query;
    message.response_topic = kAnswers;
    answer_.reset();
    registry_->message(message, moment(now));
    registry_->answer_in_turn(moment(now));
    return answer_;
}

std::optional<asip::bus::BoardItem> RegistryView::board(const std::string& name, Time now) {
    ask(R"({"find":"boards","board":")" + name + R"("})", now);
    if (!answer_ || answer_->boards.empty()) return std::nullopt;
    complete_ = !answer_->settling;
    return answer_->boards.front();
}

std::vector<std::string> RegistryView::changes_of(const std::string& board) const {
    const auto found = changes_.find(board);
    return found == changes_.end() ? std::vector<std::string>() : found->second;
}

void RegistryView::on_connected(Time now) {
    now_ = now;
    complete_ = true;  // an answer says when not
    for (const auto& one : registry_->subscriptions())
        broker_.subscribe(client_, one.filter, false, one.retained, now);
    for (const auto& [filter, retained] : filters_)
        broker_.subscribe(client_, filter, false, retained, now);
    registry_->connected(0, moment(now));
}

void RegistryView::on_message(const Message& message, Time now) {
    now_ = now;
    registry_->message(message, moment(now));
}

void RegistryView::event(const Message& message) {
    const auto change = asip::bus::parse_change_event(message.payload);
    if (!change) return;
    if (change->kind == asip::bus::ChangeEvent::Kind::kReset)
        for (auto& [board, changes] : changes_)
            changes.emplace_back(kReset);
    if (change->kind != asip::bus::ChangeEvent::Kind::kState) return;
    changes_[change->board.board].push_back(change->board.state + " " + change->reason);
}

namespace {

class GatewayView final : public View {
  public:
    GatewayView(SimBroker& broker, Dice& dice)
        : View(broker, "gateway"),
          mirror_(options(), [&dice] { return dice.draw(); },
                  {[this](Message message) {
                       if (client_ != 0) broker_.publish(client_, std::move(message), now_);
                   },
                   [this](const std::string& filter, bool retained) {
                       broker_.subscribe(client_, filter, false, retained, now_);
                   },
                   [this](const std::string& filter) { broker_.unsubscribe(client_, filter); }}) {}

    void tick(Time now) override {
        now_ = now;
        mirror_.tick(both(now));
    }
    bool is_complete() const override { return mirror_.ready(); }
    std::optional<asip::bus::BoardItem> board(const std::string& name, Time now) override {
        return mirror_.board(name, both(now));
    }

  protected:
    void on_connected(Time now) override {
        now_ = now;
        broker_.subscribe(client_, kOwn, false, false, now);
        for (const auto& [filter, retained] : mirror_.subscriptions())
            broker_.subscribe(client_, filter, false, retained, now);
        mirror_.subscribed(both(now));
    }
    void on_disconnected(Time now) override { mirror_.disconnected(both(now)); }
    void on_message(const Message& message, Time now) override {
        now_ = now;
        mirror_.message(message, both(now));
    }

  private:
    static constexpr const char* kOwn = "gateway/mark";
    static asip::gateway::Instant both(Time now) {
        const auto moment = instant(now);
        return {moment.time, moment.wall};
    }
    static asip::gateway::Mirror::Options options() {
        asip::gateway::Mirror::Options options;
        options.own_topic = kOwn;
        return options;
    }

    Time now_{};
    asip::gateway::Mirror mirror_;
};

class ViewOfBus : public View {
  public:
    explicit ViewOfBus(SimBroker& broker) : View(broker, "bus view"), view_(asip::bus::Topics()) {}

    void tick(Time now) override { view_.expired(now); }  // as asipctl watch does
    bool is_complete() const override { return complete_; }
    std::optional<asip::bus::BoardItem> board(const std::string& name, Time now) override {
        return view_.board(name, instant(now));
    }

  protected:
    void on_connected(Time now) override {
        view_.connected(now);
        broker_.subscribe(client_, "asip/servicebus/#", false, true, now);
        own_ = "view/" + std::to_string(client_);
        broker_.subscribe(client_, own_, false, false, now);
        Message mark;
        mark.topic = own_;
        broker_.publish(client_, std::move(mark), now);
    }
    void on_disconnected(Time) override { view_.disconnected(); }
    void on_message(const Message& message, Time now) override {
        if (message.topic == own_) complete_ = true;
        view_.apply(message, now);
    }

  private:
    std::string own_;
    bool complete_ = false;
    asip::catalogue::BusView view_;
};

class RecordedView final : public ViewOfBus {
  public:
    RecordedView(SimBroker& broker, std::vector<std::string>& recorded)
        : ViewOfBus(broker), recorded_(recorded) {}
    RecordedView(const RecordedView&) = delete;
    RecordedView& operator=(const RecordedView&) = delete;
    ~RecordedView() override {
        for (const auto& [board, steps] : steps_)
            recorded_.push_back(json{{"about", name()}, {"board", board}, {"steps", steps}}.dump());
    }

    /// A turn that changes nothing that is seen is no step.
    void tick(Time now) override {
        ViewOfBus::tick(now);
        add_changes(now);
    }
    /// A question has the leases of all boards judged, too.
    std::optional<asip::bus::BoardItem> board(const std::string& name, Time now) override {
        add_changes(now);
        return ViewOfBus::board(name, now);
    }

  protected:
    void on_connected(Time now) override {
        ViewOfBus::on_connected(now);
        for (const auto* board : kBoards)
            add(board, {{"heard", true}}, now);
    }
    void on_disconnected(Time now) override {
        ViewOfBus::on_disconnected(now);
        for (const auto* board : kBoards)
            add(board, {{"heard", false}}, now);
    }
    void on_message(const Message& message, Time now) override {
        const bool of_names = message.topic.starts_with("asip/") && !message.topic.ends_with("/$state") &&
                              !message.topic.ends_with("/$description");
        if (of_names) return;
        add_changes(now);
        ViewOfBus::on_message(message, now);
        for (const std::string board : kBoards)
            for (const auto* kind : {"state", "description"}) {
                if (message.topic != "asip/servicebus/" + board + "/$" + kind) continue;
                json step{{std::string(kind) == "state" ? kind : "text", message.payload}};
                if (message.retain) step["kept"] = true;
                if (message.expiry_seconds) step["expiry"] = *message.expiry_seconds;
                add(board, std::move(step), now);
            }
    }

  private:
    using json = nlohmann::json;
    static constexpr const char* kBoards[] = {"b0", "b1"};

    json shown(const std::string& name, Time now) {
        const auto item = ViewOfBus::board(name, now);
        if (!item) return nullptr;
        return {item->state, item->reason, item->state_age < 0 ? json() : json(item->state_age)};
    }
    static bool is_another(const json& a, const json& b) {
        return a.is_null() || b.is_null() ? a != b : a[0] != b[0] || a[1] != b[1];
    }
    void add_changes(Time now) {
        for (const auto& [board, steps] : steps_)
            if (is_another(shown(board, now), steps.back().at("then"))) add(board, json::object(), now);
    }
    void add(const std::string& board, json step, Time now) {
        step["at"] = std::chrono::duration<double>(now.time_since_epoch()).count();
        step["then"] = shown(board, now);
        steps_[board].push_back(std::move(step));
    }

    std::vector<std::string>& recorded_;
    std::map<std::string, json> steps_;
};

}  // namespace

std::unique_ptr<View> make_registry(SimBroker& broker, Dice& dice, const std::string& id, Time now) {
    asip::registry::RegistryOptions options;
    options.id = id;
    options.stats_interval = std::chrono::hours(1);
    return std::make_unique<RegistryView>(broker, dice, options, RegistryView::Files(), now);
}
std::unique_ptr<View> make_gateway(SimBroker& broker, Dice& dice) {
    return std::make_unique<GatewayView>(broker, dice);
}
std::unique_ptr<View> make_bus_view(SimBroker& broker) {
    return std::make_unique<ViewOfBus>(broker);
}
std::unique_ptr<View> make_recorded_view(SimBroker& broker, std::vector<std::string>& recorded) {
    return std::make_unique<RecordedView>(broker, recorded);
}

}  // namespace truth::presence
