// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/line_reader.hpp"

#include "asip/protocol/body.hpp"

namespace asip::protocol {

LineReader::LineReader(std::size_t max_line_bytes, std::string_view ends)
    : max_line_bytes_(max_line_bytes), ends_(ends) {}

void LineReader::reset() {
    line_.clear();
    dropping_ = false;
}

bool LineReader::take_line(std::string_view& bytes) {
    while (!bytes.empty()) {
        const auto end = find_any(bytes, ends_);
        const auto piece = bytes.substr(0, end);
        bytes.remove_prefix(end == std::string_view::npos ? bytes.size() : end + 1);
        // One byte more than the limit may be held: the \r that does not count.
        if (!dropping_ && line_.size() + piece.size() > max_line_bytes_ + 1) {
            dropping_ = true;
            ++overlong_lines_;
            line_.clear();
        }
        if (!dropping_) line_.append(piece);
        if (end == std::string_view::npos) return false;
        if (dropping_) {
            dropping_ = false;
            continue;
        }
        if (!line_.empty() && line_.back() == '\r') line_.pop_back();
        if (line_.size() > max_line_bytes_) {
            ++overlong_lines_;
            line_.clear();
        }
        if (!line_.empty()) return true;
    }
    return false;
}

}  // namespace asip::protocol
