// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "agent/bridge/board.hpp"
#include "agent/bridge/effects.hpp"
#include "agent/reports/line_watch.hpp"
#include "asip/expected.hpp"
#include "asip/protocol/message.hpp"

namespace asip::agent {

/// How lines of the board are published.
struct ContextOptions {
    std::string terminator;      ///< put behind each raw line
    bool retain_values = false;  ///< decoded values are retained
    bool client_side = false;    ///< raw lines go to `/in`, see BridgeOptions
};

/// Publishes lines of the board: each raw, an event also decoded by its service's model, an error also on its
/// service's error topic. An event that its model cannot decode stays raw.
class Context {
  public:
    Context(const Board& board, ContextOptions options) : board_(board), options_(std::move(options)) {}

    /// An event, by the model of its service.
    struct Decoded {
        std::string service;
        Expected<nlohmann::json> value;
    };
    /// Nothing: the line is no event of a service of the board.
    std::optional<Decoded> decode(const protocol::ParsedLine& line) const;
    /// `decoded`: of the line. `by`: the sender whose request failed; empty: not known.
    void publish(const protocol::ParsedLine& line, const std::optional<Decoded>& decoded, Effects& out,
                 std::string_view by = {});

    LineWatch& line() { return line_; }
    const LineWatch& line() const { return line_; }
    /// What goes over the line, when it is time.
    void publish_line(Time now, Effects& out);

    std::uint64_t undecoded() const { return undecoded_; }
    /// What people are to know of a service whose events often do not fit; empty: nothing.
    const std::string& warning() const { return warning_; }

  private:
    const session::ServiceTable::Entry* service_of(const protocol::Event& event) const;
    void undecoded(const std::string& service, std::string_view line, const std::string& why, Effects& out);

    /// A line that was damaged once is not worth a warning.
    static constexpr std::uint64_t kOften = 10;

    const Board& board_;
    ContextOptions options_;
    std::uint64_t undecoded_ = 0;
    std::map<std::string, std::uint64_t> undecoded_of_;  // a service each: a board has few
    std::string warning_;
    LineWatch line_;
};

}  // namespace asip::agent
