// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/registry/items.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <nlohmann/json.hpp>

#include "asip/bus/json/json_scanner.hpp"
#include "asip/bus/json/json_text.hpp"
#include "asip/bus/registry/members.hpp"

namespace asip::bus {
namespace {

constexpr std::size_t kBytesOfARow = 96;  // of a usual one

bool same_bytes(std::string_view a, std::string_view b) {
    return a.data() == b.data() && a.size() == b.size();
}

/// A text of a row. In most rows it is that of the row before, which is found without reading it again.
struct RowText {
    std::string_view quoted;  ///< as it stands in the input
    std::string_view text;
    std::string decoded;  ///< behind `text`, where that has escapes

    bool read(JsonScanner& in) {
        if (!in.next_element()) return false;
        if (in.known_value(quoted)) return true;
        std::string_view plain;
        if (in.plain_string(plain)) {
            quoted = {plain.data() - 1, plain.size() + 2};
            text = plain;
            return true;
        }
        if (!in.value(quoted) || quoted.front() != '"') return false;
        const auto value = nlohmann::json::parse(quoted, nullptr, false);
        if (!value.is_string()) return false;
        decoded = value.get<std::string>();
        text = decoded;
        return true;
    }
};

bool is_number(std::string_view raw, double& number) {
    const auto read = std::from_chars(raw.data(), raw.data() + raw.size(), number);
    return read.ec == std::errc() && read.ptr == raw.data() + raw.size();
}

bool read_number(JsonScanner& in, double& number) {
    std::string_view raw;
    return in.next_element() && in.value(raw) && is_number(raw, number);
}

class RowReader {
  public:
    RowReader(JsonScanner& in, BriefRows& rows) : in_(in), rows_(rows) {}

    bool read() {
        BriefBoard row;
        if (!in_.enter_array() || !board_.read(in_) || board_.text.empty() || !state_.read(in_) ||
            !read_number(in_, row.age)) {
            return false;
        }
        const char* const behind_age = in_.position();
        if (!in_.known_rest(rest_)) {
            if (!read_rest()) return false;
            rest_ = in_.since(behind_age);
        }
        add(row);
        return true;
    }

  private:
    bool read_rest() {
        if (!chip_.read(in_) || !sketch_.read(in_) || !services_.read(in_)) return false;
        conflict_ = false;
        has_reason_ = false;
        state_age_ = -1;
        std::string_view more;
        for (int place = 0;; ++place) {
            const JsonScanner before = in_;
            if (!in_.next_element()) return in_.left();
            if (!in_.value(more)) return false;
            if (place == 0) conflict_ = more == "true";
            if (place == 1 && more.front() == '"') {
                in_ = before;
                if (!reason_.read(in_)) return false;
                has_reason_ = true;
            }
            if (place == 2 && !is_number(more, state_age_)) state_age_ = -1;
        }
    }

    void add(BriefBoard row) {
        row.board = board_.text;
        row.state = state_.text;
        row.chip = chip_.text;
        row.sketch = sketch_.text;
        row.services = services_.text;
        row.conflict = conflict_;
        if (has_reason_) row.reason = reason_.text;
        row.state_age = state_age_;
        rows_.add(row);
        const auto& kept = rows_.rows().back();
        state_.text = kept.state;
        chip_.text = kept.chip;
        sketch_.text = kept.sketch;
        services_.text = kept.services;
        if (has_reason_) reason_.text = kept.reason;
    }

    JsonScanner& in_;
    BriefRows& rows_;
    RowText board_, state_, chip_, sketch_, services_, reason_;
    bool conflict_ = false;
    bool has_reason_ = false;
    double state_age_ = -1;
    std::string_view rest_;  ///< of the row before, behind its age: most rows end alike
};

Expected<BriefRows> read_rows(JsonScanner& in, std::size_t bytes) {
    BriefRows boards;
    boards.reserve(std::min<std::size_t>(bytes / kBytesOfARow * 3 / 2, 1000));
    RowReader reader(in, boards);
    bool good = in.enter_array();
    while (good && in.next_element())
        good = reader.read();
    if (good && in.left()) return boards;
    return fail("items: row " + std::to_string(boards.size() + (good ? 0 : 1)) +
                " is not that of a brief answer");
}

}  // namespace

bool BriefBoard::like(const BriefBoard& other) const {
    return conflict == other.conflict && reason.empty() && other.reason.empty() &&
           same_bytes(chip, other.chip) && same_bytes(sketch, other.sketch) &&
           same_bytes(services, other.services);
}

std::string_view BriefRows::kept(std::string_view text, std::string_view above) {
    if (same_bytes(text, above) || text == above) return above;
    if (text.empty()) return {};
    if (!texts_) texts_ = std::make_shared<std::pmr::monotonic_buffer_resource>();
    auto* copy = static_cast<char*>(texts_->allocate(text.size(), 1));
    std::memcpy(copy, text.data(), text.size());
    return {copy, text.size()};
}

void BriefRows::add(const BriefBoard& row) {
    const auto above = rows_.empty() ? BriefBoard{} : rows_.back();
    rows_.push_back({kept(row.board, above.board), kept(row.state, above.state), row.age,
                     kept(row.chip, above.chip), kept(row.sketch, above.sketch),
                     kept(row.services, above.services), row.conflict, kept(row.reason, above.reason),
                     row.state_age});
}

void append_brief_rows(std::string& text, const BriefRows& boards) {
    text.reserve(text.size() + boards.size() * kBytesOfARow + 2);
    text += '[';
    const BriefBoard* above = nullptr;
    std::size_t rest = 0;  // of the row above, behind its age
    std::size_t rest_size = 0;
    for (const BriefBoard& board : boards.rows()) {
        text += above == nullptr ? "[" : ",[";
        append_json_text(text, board.board);
        text += ',';
        append_json_text(text, board.state);
        text += ',';
        append_json_seconds(text, std::max(board.age, -1.0));
        const auto begin = text.size();
        if (above != nullptr && board.like(*above)) {
            text.append(text, rest, rest_size);
        } else {
            for (const auto member : {board.chip, board.sketch, board.services}) {
                text += ',';
                append_json_text(text, member);
            }
            if (board.reason.empty()) {
                text += board.conflict ? ",true]" : "]";
            } else {
                text += board.conflict ? ",true," : ",false,";
                append_json_text(text, board.reason);
                text += ',';
                append_json_seconds(text, std::max(board.state_age, -1.0));
                text += ']';
            }
        }
        rest = begin;
        rest_size = text.size() - begin;
        above = &board;
    }
    text += ']';
}

Expected<BriefRows> read_brief_rows(std::string_view rows) {
    JsonScanner in(rows);
    auto boards = read_rows(in, rows.size());
    if (boards && !in.at_end()) return fail("items: more than an array of rows");
    return boards;
}

std::optional<BriefSplit> split_brief(std::string_view payload) {
    JsonScanner in(payload);
    if (payload.size() > members::kMaxPayload || !in.enter_object()) return std::nullopt;
    std::string envelope = "{";
    std::optional<Expected<BriefRows>> rows;
    std::string_view unread;  // rows in front of the mark
    bool brief = false;
    std::string_view key;
    std::string_view value;
    while (in.next_member(key)) {
        const bool items = key == "items";
        if (items && (rows || !unread.empty())) return std::nullopt;
        if (items && brief) {
            const auto begin = in;
            rows = read_rows(in, payload.size());
            if (*rows) continue;
            in = begin;
        }
        if (!in.value(value)) return std::nullopt;
        if (items) {
            unread = value;
            continue;
        }
        if (key == "brief") brief = value == "true";
        envelope.append(envelope.size() > 1 ? ",\"" : "\"").append(in.raw_key()).append("\":").append(value);
    }
    if (!in.left() || !in.at_end() || !brief || !(rows || !unread.empty())) return std::nullopt;
    envelope += '}';
    if (!rows) rows = read_brief_rows(unread);
    return BriefSplit{std::move(envelope), std::move(*rows)};
}

}  // namespace asip::bus
