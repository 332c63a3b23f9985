// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/brief.hpp"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "asip/bus/json_scanner.hpp"
#include "asip/bus/json_text.hpp"
#include "asip/bus/members.hpp"
#include "asip/model/json.hpp"

namespace asip::bus {
namespace {

constexpr std::size_t kBytesOfARow = 96;  // of a usual one

bool read_text(JsonScanner& in, std::string& text) {
    if (!in.next_element()) return false;
    std::string_view plain;
    if (in.plain_string(plain)) {
        text = plain;
        return true;
    }
    if (!in.value(plain) || plain.front() != '"') return false;
    const auto value = nlohmann::json::parse(plain, nullptr, false);
    if (!value.is_string()) return false;
    text = value.get<std::string>();
    return true;
}

bool read_number(JsonScanner& in, double& number) {
    std::string_view raw;
    if (!in.next_element() || !in.value(raw)) return false;
    const auto read = std::from_chars(raw.data(), raw.data() + raw.size(), number);
    return read.ec == std::errc() && read.ptr == raw.data() + raw.size();
}

bool read_row(JsonScanner& in, BriefBoard& row) {
    if (!in.enter_array() || !read_text(in, row.board) || row.board.empty() || !read_text(in, row.state) ||
        !read_number(in, row.age) || !read_text(in, row.chip) || !read_text(in, row.sketch) ||
        !read_text(in, row.services)) {
        return false;
    }
    std::string_view more;
    for (bool first = true; in.next_element(); first = false) {
        if (!in.value(more)) return false;
        if (first) row.conflict = more == "true";
    }
    return in.left();
}

}  // namespace

void append_brief_rows(std::string& text, const std::vector<BriefBoard>& boards) {
    text.reserve(text.size() + boards.size() * kBytesOfARow + 2);
    text += '[';
    for (const BriefBoard& board : boards) {
        text += text.back() == '[' ? "[" : ",[";
        append_json_text(text, board.board);
        text += ',';
        append_json_text(text, board.state);
        text += ',';
        append_json_seconds(text, std::max(board.age, -1.0));
        for (const std::string* member : {&board.chip, &board.sketch, &board.services}) {
            text += ',';
            append_json_text(text, *member);
        }
        text += board.conflict ? ",true]" : "]";
    }
    text += ']';
}

Expected<std::vector<BriefBoard>> read_brief_rows(std::string_view rows) {
    std::vector<BriefBoard> boards;
    boards.reserve(std::min<std::size_t>(rows.size() / kBytesOfARow * 3 / 2, 1000));
    JsonScanner in(rows);
    bool good = in.enter_array();
    while (good && in.next_element())
        good = read_row(in, boards.emplace_back());
    if (good && in.left() && in.at_end()) return boards;
    return fail("items: row " + std::to_string(boards.size()) + " is not that of a brief answer");
}

std::optional<BriefSplit> split_brief(std::string_view payload) {
    JsonScanner in(payload);
    if (payload.size() > members::kMaxPayload || !in.enter_object()) return std::nullopt;
    BriefSplit split{"{", {}};
    bool brief = false;
    std::string_view key;
    std::string_view value;
    while (in.next_member(key)) {
        if (!in.value(value)) return std::nullopt;
        if (key == "items") {
            if (!split.rows.empty()) return std::nullopt;
            split.rows = value;
            continue;
        }
        if (key == "brief") brief = value == "true";
        split.envelope.append(split.envelope.size() > 1 ? ",\"" : "\"")
            .append(key)
            .append("\":")
            .append(value);
    }
    if (!in.left() || !in.at_end() || !brief || split.rows.empty()) return std::nullopt;
    split.envelope += '}';
    return split;
}

}  // namespace asip::bus
