#pragma once
#include <memory>
#include <string>

#include "asip/bus/answer.hpp"
#include "asip/bus/query.hpp"
#include "asip/expected.hpp"
#include "asip/text/wall_time.hpp"
#include "asip/time.hpp"
#include "registry/catalogue/catalogue.hpp"

namespace asip::registry {

/// Changes of the catalogue with their times of day, kept in an SQLite file: bounded by age and by size, the
/// oldest give way. Written in batches, at most a second behind; a crash loses that second and leaves the
/// file whole.
class History {
  public:
    struct Options {
        std::string path;
        Duration max_age = std::chrono::hours(90 * 24);
        std::size_t max_bytes = 256u << 20;
    };

    /// Opens or makes the file. Throws std::runtime_error that names the file and says what is wrong with it.
    explicit History(Options options);
    ~History();
    History(const History&) = delete;
    History& operator=(const History&) = delete;

    void add(const Event& event, text::WallTime at);
    /// Call now and then: writes what waits, and drops what is too old or too much.
    void tick(Time now);

    /// Changes of the boards that `query.board` matches, newest first; `query.state` limits to changes into
    /// these states.
    Expected<bus::Answer> find(const bus::Query& query);

    struct Seen {
        text::WallTime first{};
        text::WallTime last{};
    };
    /// When a board was first known, and when something last changed, over all runs of the registry.
    std::optional<Seen> seen(const std::string& board);

  private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace asip::registry
