// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/values/world.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "asip/bus/request/reply.hpp"
#include "asip/property/documents.hpp"
#include "cli/commands/get_all.hpp"

namespace truth::values {

using namespace asip;
using namespace std::chrono_literals;
using nlohmann::json;

namespace {

constexpr const char* kReply = "asip/reply/ann/uno1/c1";
constexpr const char* kList = "asip/servicebus/uno1/$properties";
constexpr const char* kValues = "asip/uno1/$values";
/// A gateway takes the turn of one that was killed, reads what the broker retains, and shows the values.
constexpr auto kExportsBegin = 15s;

}  // namespace

World::World(std::uint64_t seed, bool traced) : traced_(traced), exports_(seed) {
    bench_.board.verified_fences = true;
    bench_.go_online();
    carry();
    late_joiner();
}

void World::note(const std::string& text) {
    if (traced_) end_.trace.push_back(std::to_string(bench_.now.time_since_epoch() / 1ms) + " ms  " + text);
}

void World::fail(const std::string& why) {
    if (end_.failure.empty()) end_.failure = why;
}

void World::pass(std::chrono::milliseconds time) {
    bench_.pass(time);
    carry();
    gateway_->pass(time);
    registry_->pass(time);
    exports_.pass(time);
    carry();
}

void World::wait_for_board() {
    for (int i = 0; i < 120; ++i) {
        pass(500ms);
        if (bench_.bridge.session().accepts_requests()) return;
    }
    fail("the board does not come back");
}

bool World::command(const std::string& service, const json& request) {
    auto answer = bench_.ask("asip/uno1/" + service + "/in", request, std::to_string(++number_));
    if (!answer.is_object()) answer = json::object();
    const bool ok = answer.value("status", "") == "ok" && answer.value("id", "") == std::to_string(number_);
    note(service + " " + request.dump() + ": " + answer.value("status", "no answer"));
    carry();
    return ok;
}

void World::label(const json& meanings) {
    note("meanings " + meanings.dump());
    bench_.ask("asip/uno1/in", {{"meanings", meanings}}, std::to_string(++number_));
    carry();
}

void World::read() {
    ++end_.reads;
    reply_.clear();
    bench_.hear("asip/servicebus/uno1/$demand/ann/c1",
                json{{"services", {{"*", 0}}}, {"reply_to", kReply}, {"id", "7"}, {"list", true}}.dump());
    carry();
    if (end_.reads % 4 == 0) gateway_->values();
}

void World::ask_agent() {
    read();
    if (!reply_.empty()) return;
    pass(1s);  // it was asked too often
    read();
    if (reply_.empty()) fail("the agent does not answer");
}

void World::late_joiner() {
    exports_.stop();
    gateway_.emplace(retained_);
    registry_.emplace(retained_);
    exports_.start(gateway_->core());
    exports_are_new_ = true;
}

void World::broker_is_lost() {
    bench_.bridge.bus_disconnected();
    retained_.clear();
    exports_.restart_broker();
}

void World::carry() {
    take_executed();
    for (; kept_ < bench_.to_keep.size(); ++kept_)
        bench_.labels_kept();
    for (const auto& [message, priority] : std::exchange(bench_.published, {})) {
        if (message.topic == kReply) reply_ = message.payload;
        if (message.topic == kValues) told(json::parse(message.payload)["values"]);
        if (message.retain) {
            if (message.payload.empty())
                retained_.erase(message.topic);
            else
                retained_[message.topic] = message.payload;
        }
        if (!gateway_) continue;
        exports_.ahead(message.topic, message.payload);
        gateway_->take(message.topic, message.payload);
        exports_.behind();
        registry_->take(message.topic, message.payload);
    }
}

// --- what is so

void World::set(const std::string& id, json value) {
    auto& truth = truth_[id];
    truth.value = value;
    truth.all.push_back(std::move(value));
}

void World::begin_anew() {
    for (auto& [id, truth] : truth_) {
        truth.value.reset();
        truth.proven = false;
    }
}

void World::take_executed() {
    const auto& lines = bench_.board.executed;
    for (; taken_ < lines.size(); ++taken_) {
        int a = 0, b = 0;
        const auto& line = lines[taken_];
        note("board executes " + line);
        if (std::sscanf(line.c_str(), "S,W,%d,%d", &a, &b) == 2 && a == 0)
            set(kServo, b);
        else if (std::sscanf(line.c_str(), "I,d,%d,%d", &a, &b) == 2 && a == 3)
            set(kLamp, b != 0);
        else if (std::sscanf(line.c_str(), "I,P,%d,%d", &a, &b) == 2 && a == 3)
            truth_[kLamp].value.reset();  // a mode ends the level
    }
}

// --- what is looked at

/// No view goes back to an older value.
void World::told(const json& values) {
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

void World::judge(const std::string& view, const json& values) {
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

/// They have no other word for a value that is none than for one that is not known.
void World::judge_exports() {
    for (const std::string id : {kServo, kLamp, kDistance}) {
        const auto& truth = truth_[id];
        const auto shown = exports_.shown(id), unknown = exports_.text_of(id, nullptr);
        const auto is = truth.value ? exports_.text_of(id, *truth.value) : unknown;
        ++end_.looks;
        end_.known += shown != unknown ? 1 : 0;
        note(exports_.name() + " shows \"" + shown + "\" as " + id);
        if (shown != unknown ? shown != is : truth.proven && is != unknown)
            fail(exports_.name() + " shows \"" + shown + "\" as " + id + ", and it is \"" + is + "\"");
    }
}

/// What `asipctl get BOARD -o json` prints, by id.
json World::records_of_asipctl() {
    auto records = json::object();
    const auto reply = bus::parse_reply(reply_);
    const auto document = property::parse_values(reply ? reply->answer : std::string());
    if (!document) return records;
    for (const auto& each : document->properties)
        if (const auto shown = document->values.find(each.id); shown != document->values.end())
            records[each.id] = cli::value_record("uno1", each, shown->second);
    return records;
}

json World::listed_by_broker() {
    const auto stored = retained_.find(kList);
    return stored == retained_.end() ? json() : json::parse(stored->second)["properties"];
}

/// A description is announced at most once a second.
void World::judge_registry() {
    auto list = registry_->list();
    if (list != listed_by_broker()) pass(2s), list = registry_->list();
    ++end_.looks;
    end_.known += list.empty() ? 0 : 1;
    if (list != listed_by_broker())
        fail("by the registry the properties are " + list.dump() + ", and its agent says " +
             listed_by_broker().dump());
}

void World::look() {
    if (!end_.failure.empty()) return;
    pass(1100ms);  // numbers that flow are told once a second
    for (auto waited = 0ms; exports_are_new_ && waited < kExportsBegin; waited += 500ms) {
        exports_are_new_ = !exports_.is_active();
        pass(exports_are_new_ ? 500ms : 2500ms);  // the document, and what follows it
    }
    if (exports_are_new_) return fail(exports_.name() + " is not shown anything");
    ask_agent();
    if (!end_.failure.empty()) return;
    judge("the agent", json::parse(reply_)["answer"]["values"]);
    judge("asipctl get", records_of_asipctl());
    const auto stored = retained_.find(kValues);
    if (stored == retained_.end()) return fail("the broker has no values");
    judge("the broker", json::parse(stored->second)["values"]);
    judge("the gateway", gateway_->values());
    judge_exports();
    judge_registry();
}

void World::judge_clash(bool refused) {
    pass(200ms);
    ask_agent();
    if (!end_.failure.empty()) return;
    for (const auto& [view, list] :
         {std::pair("the agent", json::parse(reply_)["answer"]["properties"]),
          std::pair("the broker", listed_by_broker()), std::pair("the gateway", gateway_->list())}) {
        const auto found =
            std::find_if(list.begin(), list.end(), [](const json& each) { return each["id"] == kLamp; });
        if (found == list.end()) return fail(std::string(view) + " does not list the lamp");
        if (found->contains("refused") != refused)
            fail(std::string(view) + (refused ? " lets" : " does not let") +
                 " the lamp be set: " + found->dump());
    }
    const auto before = bench_.board.executed.size();
    const auto [status, commands] = gateway_->put({{kLamp, true}});
    if (refused && (status != 409 || commands != 0 || bench_.board.executed.size() != before))
        fail("the gateway sets a lamp that is refused: " + std::to_string(status));
    if (!refused && commands == 0) fail("the gateway does not set the lamp: " + std::to_string(status));
    ++end_.looks;
    ++end_.known;
}

}  // namespace truth::values
