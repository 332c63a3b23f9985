// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/values/history.hpp"

#include <map>
#include <optional>
#include <random>

#include "tests/unit/agent/bridge_bench.hpp"
#include "tests/unit/gateway/api_bench.hpp"

namespace truth::values {
namespace {

using namespace asip;
using namespace std::chrono_literals;
using nlohmann::json;

constexpr unsigned kSteps = 24;
constexpr const char* kServo = "servo/0/angle";
constexpr const char* kLamp = "io/3";
constexpr const char* kDistance = "distance/0";
constexpr const char* kReply = "asip/reply/ann/uno1/c1";

/// A gateway that came at some time: what the broker kept is the first that it hears.
struct Gateway final : gateway::ApiTest {
    explicit Gateway(const std::map<std::string, std::string>& retained) {
        for (const auto& [topic, payload] : retained)
            take(topic, payload, true);
    }
    void TestBody() override {}
    void take(const std::string& topic, const std::string& payload, bool stored = false) {
        mqtt::Message message;
        message.topic = topic;
        message.payload = payload;
        message.retain = stored;
        gateway_->message(message);
    }
    using ApiTest::pass;
    json values() { return get("/api/boards/uno1/values")->body().value("values", json::object()); }
};

/// What is so: by the lines that the board executed.
struct Truth {
    std::optional<json> value;  ///< none: since the board's last start nothing set it
    bool proven = false;        ///< its last command was answered: every view must know it
    std::vector<json> all{};    ///< all that it ever was, in order
    std::size_t seen = 0;       ///< up to where a view has shown them
};

class History {
  public:
    History(std::uint64_t seed, bool traced) : random_(seed), traced_(traced) {
        bench_.board.verified_fences = true;
        bench_.go_online();
        carry();
        gateway_.emplace(retained_);
        command("io", {{"mode", {3, 3}}});
    }

    End run() {
        for (unsigned step = 0; step < kSteps && end_.failure.empty(); ++step) {
            one_step();
            if (below(3) == 0) look();
        }
        look();
        return std::move(end_);
    }

    End run_lamp(unsigned reads) {
        command("io", {{"write", {3, 1}}});
        for (unsigned i = 0; i < reads && end_.failure.empty(); ++i) {
            const auto before = bench_.board.executed.size();
            read();
            if (bench_.board.executed.size() != before) fail("a read made the agent send something");
            if (i % 50 == 0) set_servo();
            if (i % 97 == 0) late_joiner();
            if (truth_[kLamp].value != json(true)) fail("the lamp is dark");
            pass(5ms);
        }
        look();
        return std::move(end_);
    }

  private:
    unsigned below(unsigned n) { return static_cast<unsigned>(random_() % n); }
    void note(const std::string& text) {
        if (traced_)
            end_.trace.push_back(std::to_string(bench_.now.time_since_epoch() / 1ms) + " ms  " + text);
    }
    void fail(const std::string& why) {
        if (end_.failure.empty()) end_.failure = why;
    }

    void one_step() {
        switch (below(14)) {
            case 0:
            case 1:
            case 2:
                return set_servo();
            case 3:
            case 4:
                return set_lamp();
            case 5:
            case 6:
                return report();
            case 7:
                return read_many();
            case 8:
                return restart_board();
            case 9:
                return unplug();
            case 10:
                return in_doubt();
            case 11:
                return restart_broker();
            case 12:
                return late_joiner();
            default:
                return pass(std::chrono::milliseconds(below(3000)));
        }
    }

    // --- what happens

    /// As a program on the bus, that waits for the answer.
    bool command(const std::string& service, const json& request) {
        auto answer = bench_.ask("asip/uno1/" + service + "/in", request, std::to_string(++number_));
        if (!answer.is_object()) answer = json::object();
        const bool ok =
            answer.value("status", "") == "ok" && answer.value("id", "") == std::to_string(number_);
        note(service + " " + request.dump() + ": " + answer.value("status", "no answer"));
        carry();
        return ok;
    }

    void send(const std::string& service, const json& request, const std::string& line,
              const std::string& id) {
        switch (below(3)) {
            case 0:
                note("raw " + line);
                bench_.hear("asip/uno1/in", line);
                break;
            case 1:
                note("client " + line);
                bench_.client_says(line);
                break;
            default:
                if (command(service, request)) truth_[id].proven = true;
                return;
        }
        carry();
        truth_[id].proven = false;
    }

    /// Each differs from those around it.
    int next_angle() { return static_cast<int>((truth_[kServo].all.size() * 7 + 1) % 181); }

    void set_servo() {
        const int angle = next_angle();
        send("servo", {{"write", {0, angle}}}, "S,W,0," + std::to_string(angle), kServo);
    }

    void set_lamp() {
        const int level = static_cast<int>(below(2));
        send("io", {{"write", {3, level}}}, "I,d,3," + std::to_string(level), kLamp);
    }

    void report() {
        const int distance = static_cast<int>(below(401));
        note("distance " + std::to_string(distance));
        bench_.say(bench_.board.framed("@D,e,1,{" + std::to_string(distance) + "}"));
        set(kDistance, distance == 0 ? json() : json(distance));
        truth_[kDistance].proven = true;
        carry();
    }

    void read_many() {
        const auto before = bench_.board.executed.size();
        for (unsigned i = below(20); i > 0; --i) {
            read();
            if (below(4) == 0) pass(std::chrono::milliseconds(below(200)));
        }
        if (bench_.board.executed.size() != before) fail("a read made the agent send something");
    }

    void restart_board() {
        note("board restarts");
        begin_anew();
        bench_.say(bench_.board.reboot());
        wait_for_board();
    }

    void unplug() {
        note("unplugged");
        bench_.unplug();
        pass(std::chrono::milliseconds(below(2000)));
        begin_anew();
        bench_.board.reboot();
        bench_.plug();
        wait_for_board();
    }

    /// The line to the board loses what is sent: a command may or may not be executed.
    void in_doubt() {
        note("the line loses some");
        bench_.board.lose_lines = static_cast<int>(1 + below(3));
        command("servo", {{"write", {0, next_angle()}}, {"deadline_ms", 500}});
        pass(3s);
        bench_.board.lose_lines = 0;
        for (auto& [id, truth] : truth_)
            truth.proven = false;
        wait_for_board();
    }

    void restart_broker() {
        note("broker restarts, empty");
        bench_.bridge.bus_disconnected();
        retained_.clear();
        if (below(2) == 0) set_servo();
        pass(std::chrono::milliseconds(below(3000)));
        bench_.connect();
        carry();
        late_joiner();
    }

    void late_joiner() {
        note("another gateway");
        gateway_.emplace(retained_);
    }

    void read() {
        ++end_.reads;
        bench_.hear("asip/servicebus/uno1/$demand/ann/c1",
                    json{{"services", {{"*", 0}}}, {"reply_to", kReply}, {"id", "7"}, {"list", true}}.dump());
        carry();
        if (below(4) == 0) gateway_->values();
    }

    void pass(std::chrono::milliseconds time) {
        bench_.pass(time);
        gateway_->pass(time);
        carry();
    }

    void wait_for_board() {
        for (int i = 0; i < 120; ++i) {
            pass(500ms);
            if (bench_.bridge.session().accepts_requests()) return;
        }
        fail("the board does not come back");
    }

    // --- what is so

    void set(const std::string& id, json value) {
        auto& truth = truth_[id];
        truth.value = value;
        truth.all.push_back(std::move(value));
    }

    void begin_anew() {
        for (auto& [id, truth] : truth_) {
            truth.value.reset();
            truth.proven = false;
        }
    }

    void take_executed() {
        const auto& lines = bench_.board.executed;
        for (; taken_ < lines.size(); ++taken_) {
            int a = 0, b = 0;
            const auto& line = lines[taken_];
            if (std::sscanf(line.c_str(), "S,W,%d,%d", &a, &b) == 2 && a == 0)
                set(kServo, b);
            else if (std::sscanf(line.c_str(), "I,d,%d,%d", &a, &b) == 2 && a == 3)
                set(kLamp, b != 0);
            else if (std::sscanf(line.c_str(), "I,P,%d,%d", &a, &b) == 2 && a == 3)
                truth_[kLamp].value.reset();  // a mode ends the level
        }
    }

    /// What was published goes to the broker, and from there to the gateway.
    void carry() {
        take_executed();
        for (const auto& [message, priority] : bench_.published) {
            if (message.topic == kReply) answered_ = json::parse(message.payload)["answer"]["values"];
            if (message.topic == "asip/uno1/$values") told(json::parse(message.payload)["values"]);
            if (message.retain) {
                if (message.payload.empty())
                    retained_.erase(message.topic);
                else
                    retained_[message.topic] = message.payload;
            }
            if (gateway_) gateway_->take(message.topic, message.payload);
        }
        bench_.published.clear();
    }

    // --- what is looked at

    /// No view goes back to an older value.
    void told(const json& values) {
        const auto found = values.find(kServo);
        if (found == values.end() || !found->contains("value")) return;
        auto& truth = truth_[kServo];
        auto at = truth.seen;
        while (at < truth.all.size() && truth.all[at] != (*found)["value"])
            ++at;
        if (at == truth.all.size())
            fail("the servo goes back to, or never was at, " + (*found)["value"].dump());
        else
            truth.seen = at;
    }

    void judge(const std::string& view, const json& values) {
        for (const std::string id : {kServo, kLamp, kDistance}) {
            const auto& truth = truth_[id];
            const auto found = values.find(id);
            const bool known = found != values.end() && found->contains("value");
            ++end_.looks;
            end_.known += known ? 1 : 0;
            const auto shown = known ? (*found)["value"].dump() : std::string("unknown");
            const auto is = truth.value ? truth.value->dump() : std::string("not known to anybody");
            if (known ? (!truth.value || (*found)["value"] != *truth.value)
                      : truth.proven && truth.value.has_value())
                fail(view + " says that " + id + " is " + shown + ", and it is " + is);
        }
    }

    void look() {
        if (!end_.failure.empty()) return;
        pass(1100ms);  // numbers that flow are told once a second
        read();
        judge("the agent", answered_);
        const auto stored = retained_.find("asip/uno1/$values");
        if (stored == retained_.end()) return fail("the broker has no values");
        judge("the broker", json::parse(stored->second)["values"]);
        judge("the gateway", gateway_->values());
    }

    std::mt19937_64 random_;
    const bool traced_;
    agent::BridgeBench bench_;
    std::optional<Gateway> gateway_;
    std::map<std::string, std::string> retained_;
    std::map<std::string, Truth> truth_;
    json answered_ = json::object();
    std::size_t taken_ = 0;
    unsigned number_ = 0;
    End end_;
};

}  // namespace

End run_history(std::uint64_t seed, bool traced) {
    return History(seed, traced).run();
}

End run_lamp(std::uint64_t seed, unsigned reads) {
    return History(seed, false).run_lamp(reads);
}

}  // namespace truth::values
