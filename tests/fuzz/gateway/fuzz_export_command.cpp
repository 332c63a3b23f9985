// SPDX-License-Identifier: Apache-2.0
// What other systems send to an export, and what may be retained where its documents are: the topic of a
// command, and behind the first line its payload. A command is refused, or becomes requests that are JSON.
#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "gateway/export/home_assistant.hpp"
#include "gateway/export/homie.hpp"
#include "gateway/export/turn.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace asip::gateway::exports;

constexpr std::size_t kMaxRequestBytes = 2 * kMaxCommandBytes;
constexpr double kMin = -90, kMax = 90;

Property property(Kind kind, const std::string& id) {
    Property made;
    made.id = made.name = id;
    made.kind = kind;
    made.write = asip::property::Call{"thing", "write", {0, std::nullopt}};
    return made;
}

ExportedBoard make_board() {
    ExportedBoard board;
    board.board = "uno1";
    for (const auto kind : {Kind::kSensor, Kind::kBinarySensor, Kind::kSwitch, Kind::kNumber, Kind::kLight,
                            Kind::kButton, Kind::kText, Kind::kSelect})
        board.properties.push_back(property(kind, "thing-" + std::to_string(static_cast<int>(kind))));
    for (auto& each : board.properties) {
        if (each.kind == Kind::kSensor || each.kind == Kind::kBinarySensor) {
            each.write.reset();
            each.read = asip::property::Place{"thing", "/value"};
        }
        if (each.kind == Kind::kNumber) {
            each.min = kMin;
            each.max = kMax;
        }
        if (each.kind == Kind::kText) each.max_length = 16;
        if (each.kind == Kind::kButton) each.write->arguments.pop_back();
        if (each.kind == Kind::kSwitch || each.kind == Kind::kSelect) each.choices = {{"off", 0}, {"on", 1}};
    }
    auto colored = property(Kind::kLight, "colored");
    colored.color = asip::property::Call{"thing", "fill", {std::nullopt}};
    board.properties.push_back(colored);
    return board;
}

void check(const Dialect& dialect, const ExportedBoard& board, const std::string& topic,
           const std::string& payload) {
    if (const auto command = dialect.command_of(topic)) {
        REQUIRE(!command->property.empty() && command->property.find('/') == std::string::npos);
        REQUIRE(command->board.find('/') == std::string::npos);
    }
    for (const auto& each : board.properties) {
        const auto value = dialect.value_of(each, payload);
        if (!value) {
            REQUIRE(!value.error().empty() && value.error().size() < 300);
            continue;
        }
        REQUIRE(each.settable());
        const auto requests = requests_for(each, *value);
        REQUIRE(!requests.empty());
        for (const auto& request : requests) {
            REQUIRE(request.payload.size() <= kMaxRequestBytes);
            REQUIRE(!nlohmann::json::parse(request.payload, nullptr, false).is_discarded());
        }
        if (each.kind == Kind::kNumber) REQUIRE(value->is_number() && *value >= kMin && *value <= kMax);
        if (each.kind != Kind::kButton) dialect.state_text(each, *value);
    }
    // Any text may be retained where a document was.
    const auto next = dialect.next_document(board, payload);
    if (!dialect.document_topic(board.board).empty())
        REQUIRE(next.text == payload || !nlohmann::json::parse(next.text, nullptr, false).is_discarded());
    dialect.gateway_document({board.board}, payload);
    dialect.is_ours({{topic, payload}}, topic, dialect.place());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const auto board = make_board();
    const std::string bytes(reinterpret_cast<const char*>(data), size);
    const auto end = std::min(bytes.find('\n'), bytes.size());
    const auto topic = bytes.substr(0, end);
    const auto payload = end < bytes.size() ? bytes.substr(end + 1) : std::string();
    check(HomeAssistant(HomeAssistant::Options{}), board, topic, payload);
    check(Homie(Homie::Options{}), board, topic, payload);
    Turn lease({"gateway", 0, "host", {"homeassistant"}}, [] { return std::uint64_t{1}; });
    lease.subscribed({});
    lease.said(payload, true, {});
    lease.state(payload, {});
    return 0;
}
