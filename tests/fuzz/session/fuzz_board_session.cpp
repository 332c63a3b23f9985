// A board session that is told anything, in any order: it never has too much in flight, never writes a line
// that is not a request, and ends each request exactly once.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <random>
#include <string_view>

#include "asip/session/board_session.hpp"
#include "tests/fuzz/require.hpp"

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
                session_.link_up({operation & 8 ? 57600u : 0u, (operation & 16) != 0}, now_, actions);
                break;
            case 1:
                session_.link_down(now_, actions);
                break;
            case 2:
            case 3:
                session_.receive(data, now_, actions);
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
                submit(data, {.prove = (operation & 8) != 0, .answer_tag = operation & 16 ? 'e' : '\0'},
                       actions);
                break;
            default:
                now_ += std::chrono::milliseconds(operation);
        }
        check(actions);
        const auto deadline = session_.next_deadline();
        for (const auto& [id, due] : open_)
            REQUIRE(now_ < due || (deadline && *deadline <= now_));
    }

    void end() {
        Actions actions;
        session_.link_down(now_, actions);
        check(actions);
        REQUIRE(open_.empty());
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
    void submit(std::string_view line, RequestOptions wanted, Actions& actions) {
        wanted.client = line.size() % 3;
        wanted.deadline = now_ + std::chrono::milliseconds(50 + 37 * line.size());
        const auto id = session_.submit(line, wanted, now_, actions);
        if (id) REQUIRE(open_.emplace(*id, *wanted.deadline).second);
    }
    void check(const Actions& actions) {
        for (const Action& action : actions) {
            if (const auto* end = std::get_if<Finished>(&action)) REQUIRE(open_.erase(end->id) == 1);
            if (const auto* write = std::get_if<Write>(&action))
                REQUIRE(!write->bytes.empty() && write->bytes.back() == '\n');
        }
        REQUIRE(session_.bytes_in_flight() <= BoardSession::kReceiveBufferBytes);
        REQUIRE(session_.queued() <= BoardSession::kMaxQueued + 512);
    }

    BoardSession session_;
    asip::Time now_{};
    std::map<RequestId, asip::Time> open_;
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
    run.end();
    return 0;
}
