// SPDX-License-Identifier: Apache-2.0
#include "asip/session/wire.hpp"

#include <algorithm>
#include <utility>

#include "asip/protocol/checksum.hpp"
#include "asip/protocol/request.hpp"

namespace asip::session {

namespace {

constexpr Duration kCheapLine = std::chrono::microseconds(100);
constexpr int kBitsPerByte = 10;

}  // namespace

void Wire::open(unsigned baud) {
    start_baud_ = baud_ = baud;
    checksums_ = Checksums::kOff;
    had_checksums_ = false;
    reader_.reset();
}

void Wire::set_rate(unsigned baud, std::string why, Actions& out) {
    if (baud == baud_ || !has_rates()) return;
    baud_ = baud;
    reader_.reset();
    out.emplace_back(SetLineRate{baud});
    if (!why.empty()) out.emplace_back(LineRateChanged{baud, std::move(why)});
}

Duration Wire::byte_time() const {
    if (baud_ == 0) return {};
    return std::chrono::duration_cast<Duration>(
        std::chrono::nanoseconds(1'000'000'000LL * kBitsPerByte / baud_));
}

bool Wire::is_fast() const {
    return baud_ != 0 && byte_time() * kChecksumBytes < kCheapLine;
}

void Wire::write(const std::vector<std::string>& lines, Actions& out) {
    if (lines.empty()) return;
    std::string bytes;
    for (const std::string& line : lines) {
        bytes += writes_checksums() && !line.empty() ? protocol::append_checksum(line) : line;
        bytes += '\n';
        if (line == protocol::set_checksum(true) && checksums_ == Checksums::kOff)
            checksums_ = Checksums::kTurningOn;
        if (line == protocol::set_checksum(false)) checksums_ = Checksums::kOff;
    }
    bytes_out_ += bytes.size();
    out.emplace_back(Write{std::move(bytes)});
}

std::vector<std::string> Wire::switching_lines(bool on) {
    // In both forms: one of them is the board's. The empty line ends whatever was cut off before.
    checksums_ = on ? Checksums::kOff : Checksums::kOn;
    const std::string line = protocol::set_checksum(on);
    return {"", line, line};
}

Wire::Received Wire::unpack(std::string_view line) {
    const bool marked = line.size() >= kChecksumBytes && line[line.size() - kChecksumBytes] == '*';
    if (marked) {
        if (const auto text = protocol::verify_checksum(line)) {
            had_checksums_ = true;
            if (checksums_ == Checksums::kTurningOn) checksums_ = Checksums::kOn;
            return {*text, false, true};
        }
    }
    // A banner has none: the board restarted and knows nothing of checksums any more.
    const bool may_lack =
        checksums_ != Checksums::kOn || (!marked && line.find(" with Services:") != std::string_view::npos);
    // What is left of one, on a line that was sent before they were turned off.
    const bool remains = had_checksums_ && (line.starts_with('@') || line.starts_with('~')) &&
                         line.find('*', line.size() - std::min(line.size(), kChecksumBytes + 1)) != line.npos;
    return {line, !may_lack || remains, false};
}

}  // namespace asip::session
