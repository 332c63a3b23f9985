// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace asip::test {

/// How an ASIP 0.4 board takes requests out of a stream of bytes, with its known faults: nothing of it is
/// ours. A number ends at the first character that is none, or after a second of silence; until its first
/// digit everything is skipped, a line end and the next request, too. Nothing is read before four bytes are
/// there. Time in milliseconds.
class Model04 {
  public:
    void receive(std::string_view bytes) {
        waiting_ += bytes;
        quiet_ms_ = 0;
        run();
    }
    void pass(long ms) {
        quiet_ms_ += ms;
        run();
    }
    /// Each request in the form S,t,number,...
    const std::vector<std::string>& executed() const { return executed_; }
    /// The same, once.
    std::vector<std::string> take_executed() { return std::exchange(executed_, {}); }

    /// Something that was received is not executed.
    bool waits() const { return !waiting_.empty(); }

  private:
    static constexpr long kSilenceMs = 1000;
    static constexpr std::size_t kLeast = 4;

    /// How many numbers the board reads for this request; -1: text behind one number.
    static int numbers(char service, char tag) {
        if (service == '#') return 0;
        if (tag == 'A') return 1;
        if (service == 'L') return tag == 'W' ? -1 : 0;
        if (service == 'I') return tag == 'P' || tag == 'd' || tag == 'a' ? 2 : 0;
        if (service == 'M') return tag == 'm' || tag == 'M' ? 2 : tag == 's' ? 1 : 0;
        if (service == 'S' || service == 'T') return 2;
        if (service == 'W') return tag == 'w' ? 1 : 0;  // of the truth test
        return 0;
    }

    void run() {
        while (step()) {
        }
    }
    bool step() {
        std::size_t at = 0;
        while (at < waiting_.size() && (waiting_[at] == '\n' || waiting_[at] == '\r'))
            ++at;
        waiting_.erase(0, at);
        if (waiting_.size() < kLeast) return false;
        const char service = waiting_[0], tag = waiting_[2];
        if (waiting_[1] != ',' || !(service == '#' || (service >= 'A' && service <= 'Z'))) {
            waiting_.erase(0, 1);
            return true;
        }
        std::string request{service, ',', tag};
        at = 3;
        for (int left = numbers(service, tag); left > 0; --left) {
            std::string number;
            if (!read_number(at, number)) return false;
            request += ',' + number;
        }
        executed_.push_back(std::move(request));
        waiting_.erase(0, at);
        return true;
    }
    /// False: the board waits for more.
    bool read_number(std::size_t& at, std::string& number) {
        const auto digit = [&](std::size_t i) { return waiting_[i] >= '0' && waiting_[i] <= '9'; };
        while (at < waiting_.size() && !digit(at) && waiting_[at] != '-')
            ++at;
        std::size_t end = at;
        if (end < waiting_.size() && waiting_[end] == '-') ++end;
        while (end < waiting_.size() && digit(end))
            ++end;
        if (end == waiting_.size() && quiet_ms_ < kSilenceMs) return false;
        number = waiting_.substr(at, end - at);
        if (number.empty()) number = "0";
        at = end;
        return true;
    }

    std::string waiting_;
    long quiet_ms_ = 0;
    std::vector<std::string> executed_;
};

}  // namespace asip::test
