// SPDX-License-Identifier: Apache-2.0
// A board session that receives anything, in any order: it never has too much in flight, never writes a line
// that is not a request, ends each request exactly once and in time, sends none after its end or its
// deadline, proves none without its fence or where the line showed damage, and is silent where there is no
// link.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <random>
#include <string_view>

#include "asip/session/board_session.hpp"
#include "tests/fuzz/require.hpp"
#include "tests/fuzz/session/marks.hpp"

namespace {

using namespace asip::session;

class Run {
  public:
    explicit Run(std::uint8_t flags)
        : session_(options(flags), [engine = std::mt19937_64(flags)]() mutable { return engine(); }) {}

    void step(std::uint8_t operation, std::string_view data) {
        Actions actions;
        switch (operation % 8) {
            case 0:
                if (linked_) break;
                linked_ = true;
                session_.link_up({operation & 8 ? 57600u : 0u, (operation & 16) != 0}, now_, actions);
                break;
            case 1:
                return unlink();
            case 2:
            case 3:
                receive(data, actions);
                break;
            case 4:
                if (const auto deadline = session_.next_deadline(); deadline && *deadline > now_)
                    now_ = *deadline;
                session_.tick(now_, actions);
                break;
            case 5:
                session_.line_rate_set((operation & 8) != 0, now_, actions);
                break;
            case 6:
                submit(operation & 32 ? std::string(data) : marks_.next(data), (operation & 32) == 0,
                       {.prove = (operation & 8) != 0, .answer_tag = operation & 16 ? 'e' : '\0'}, actions);
                break;
            default:
                now_ += std::chrono::milliseconds(operation);
        }
        check(actions);
        const auto deadline = session_.next_deadline();
        for (const auto& [id, due] : open_)
            REQUIRE(now_ < due || (deadline && *deadline <= now_));
    }

    void unlink() {
        Actions actions;
        session_.link_down(now_, actions);
        linked_ = false;
        marks_.doubt();
        check(actions);
        REQUIRE(open_.empty());
        REQUIRE(!session_.next_deadline());
    }

  private:
    static SessionOptions options(std::uint8_t flags) {
        SessionOptions options;
        options.checksum = flags & 1   ? ChecksumPolicy::kAlways
                           : flags & 4 ? ChecksumPolicy::kNever
                                       : ChecksumPolicy::kAuto;
        if (flags & 2) options.max_baud = 0;
        return options;
    }
    void submit(const std::string& line, bool is_mark, RequestOptions wanted, Actions& actions) {
        if (!is_mark && line.starts_with("W,w,")) return;
        wanted.client = line.size() % 3;
        wanted.deadline = now_ + std::chrono::milliseconds(50 + 37 * line.size());
        const auto id = session_.submit(line, wanted, now_, actions);
        if (id) REQUIRE(linked_ && open_.emplace(*id, *wanted.deadline).second);
        if (id && is_mark) marks_.accepted(*id, line, *wanted.deadline);
        if (!id && is_mark) marks_.refused();
    }
    // Line by line: what a line makes the session write is not answered by the next one.
    void receive(std::string_view bytes, Actions& actions) {
        while (!bytes.empty()) {
            const auto size = std::min(bytes.find('\n'), bytes.size() - 1) + 1;
            if (linked_) marks_.heard(bytes.substr(0, size));
            session_.receive(bytes.substr(0, size), now_, actions);
            bytes.remove_prefix(size);
            if (bytes.empty()) return;
            check(actions);
            actions.clear();
        }
    }
    void wrote(std::string_view bytes) {
        REQUIRE(linked_ && !bytes.empty() && bytes.back() == '\n');
        for (; !bytes.empty(); bytes.remove_prefix(bytes.find('\n') + 1))
            marks_.wrote(bytes.substr(0, bytes.find('\n')), now_);
    }
    void check(const Actions& actions) {
        for (const Action& action : actions) {
            if (const auto* end = std::get_if<Finished>(&action)) {
                REQUIRE(open_.erase(end->id) == 1);
                marks_.ended(*end);
            }
            if (std::holds_alternative<Garbage>(action) || std::holds_alternative<BoardReset>(action))
                marks_.doubt();
            if (const auto* write = std::get_if<Write>(&action)) wrote(write->bytes);
        }
        REQUIRE(session_.bytes_in_flight() <= BoardSession::kReceiveBufferBytes);
        REQUIRE(session_.queued() <= BoardSession::kMaxQueued + 512);
    }

    BoardSession session_;
    asip::Time now_{};
    std::map<RequestId, asip::Time> open_;
    Marks marks_;
    bool linked_ = false;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    std::string_view rest(reinterpret_cast<const char*>(data), size);
    Run run(static_cast<std::uint8_t>(rest[0]));
    rest.remove_prefix(1);
    while (rest.size() >= 2) {
        const auto operation = static_cast<std::uint8_t>(rest[0]);
        const auto length = std::min<std::size_t>(static_cast<std::uint8_t>(rest[1]), rest.size() - 2);
        run.step(operation, rest.substr(2, length));
        rest.remove_prefix(2 + length);
    }
    run.unlink();
    return 0;
}
