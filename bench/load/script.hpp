// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "asip/time.hpp"

namespace asip::load {

/// What happens to boards.
enum class Verb {
    kJoin,   ///< an agent starts: claims the name, announces; boards that are not on the bus
    kDie,    ///< the connection breaks and does not come back: the will is published
    kFlap,   ///< the connection breaks and comes back after Step::down: the same agent announces again
    kHang,   ///< nothing is said any more, the connection stays: the lease runs out
    kLeave,  ///< says goodbye
};
/// "join", "die", "flap", "hang", "leave"
std::string_view name_of(Verb verb);

/// How many boards: a number of them, or a part of all.
struct Amount {
    std::size_t number = 0;
    double part = 0;  ///< 0: `number` counts

    std::size_t of(std::size_t boards) const;
};

/// One line of a script: `30s flap 1% over 2s down 5s every 10s`, or `then die 5`.
struct Step {
    Duration at{};      ///< since the start
    bool then = false;  ///< `at` counts from when the steps before it are done and the boards are settled
    Verb verb = Verb::kJoin;
    Amount amount{};
    Duration over{};                          ///< spread evenly over this time
    Duration down = std::chrono::seconds(1);  ///< kFlap: for so long away
    Duration every{};                         ///< again and again; 0: once
};

/// `AT VERB BOARDS [over TIME] [down TIME] [every TIME]`; AT is a time, `then` or `then+TIME`; BOARDS is a
/// number, a percentage or `all`. Fails
/// with a sentence that names the word and says what may stand there.
Expected<Step> parse_step(std::string_view text);
/// A file of steps, one a line; what follows `#` is a comment. Fails with the file and the number of the
/// line.
Expected<std::vector<Step>> read_script(const std::string& path);

/// Which steps are due: time in, numbers of boards out. Pure.
class Plan {
  public:
    /// `boards`: what a percentage is of.
    Plan(std::vector<Step> steps, std::size_t boards);

    struct Due {
        Verb verb;
        std::size_t count;
        Duration down;
    };
    /// What became due since the last call; `now`, since the start, does not decrease. In the order of the
    /// script. `settled`: no board is away for a while, and the broker has the description of each that is
    /// present.
    std::vector<Due> due(Duration now, bool settled);
    /// When to ask next; nothing: never again.
    std::optional<Duration> next(Duration now) const;

  private:
    /// A step of the script while it runs; one with `every` never ends.
    struct Running {
        Step step;
        std::size_t total;  // boards each time
        std::uint64_t round = 0;
        std::size_t done = 0;            // of this round
        std::optional<Duration> from{};  // what its times count from

        Duration begins() const { return *from + step.at + step.every * static_cast<Duration::rep>(round); }
        bool once_done() const { return round > 0 || done >= total; }
    };
    std::vector<Running> steps_;
};

}  // namespace asip::load
