// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include "agent/clients/client_framing.hpp"
#include "asip/protocol/request.hpp"
#include "tests/readers/client_judge.hpp"
#include "tests/support/explorer.hpp"

namespace readers {

/// What an agent makes of the bytes of a point-to-point client, and a judge that reads the same bytes.
class ClientBench {
  public:
    using Framing = ClientJudge::Framing;

    struct State {
        asip::agent::ClientFraming framing;
        ClientJudge judge;
        bool operator==(const State&) const = default;
        std::size_t hash() const { return judge.hash(); }
    };

    explicit ClientBench(Framing framing)
        : state_{asip::agent::ClientFraming(static_cast<asip::agent::ClientFraming::Kind>(framing)),
                 ClientJudge(framing)} {}

    void save(State& state) const { state = state_; }
    void put_back(const State& state) { state_ = state; }
    bool line_is_open() const { return state_.judge.line_is_open(); }
    bool ends_at(int symbol) const {
        return symbol < wire::kSilence && state_.judge.may_end_at(static_cast<std::uint8_t>(symbol));
    }

    /// nullptr, or what is wrong.
    const char* step(int symbol) {
        if (symbol != wire::kSilence) {
            const char byte = static_cast<char>(symbol);
            return state_.judge.byte(static_cast<std::uint8_t>(symbol), read({&byte, 1}));
        }
        if (!state_.framing.waits_for_silence()) return state_.judge.second_of_silence({});
        return state_.judge.second_of_silence(outcomes(state_.framing.after_silence()));
    }
    const char* bytes(std::string_view bytes) {
        for (const char byte : bytes)
            if (const char* wrong = step(static_cast<unsigned char>(byte))) return wrong;
        return nullptr;
    }

    /// What the agent makes of these bytes, which come at once; the judge does not hear of them.
    std::vector<Outcome> read(std::string_view bytes) { return outcomes(state_.framing.decode(bytes)); }

  private:
    std::vector<Outcome> outcomes(std::vector<std::string> requests) {
        std::vector<Outcome> all;
        for (auto& request : requests) {
            const bool refused = !asip::protocol::parse_request(request);
            all.push_back({std::move(request), refused});
        }
        for (auto& half : state_.framing.take_halves())
            all.push_back({std::move(half), true});
        return all;
    }

    State state_;
};

}  // namespace readers
