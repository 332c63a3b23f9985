// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "tests/truth/values/history.hpp"
#include "tests/truth/values/views.hpp"
#include "tests/unit/agent/bridge_bench.hpp"

namespace truth::values {

inline constexpr const char* kServo = "servo/0/angle";
inline constexpr const char* kLamp = "io/3";
inline constexpr const char* kDistance = "distance/0";

/// What is so: by the lines that the board executed.
struct Truth {
    std::optional<nlohmann::json> value;  ///< none: since the board's last start nothing set it
    bool proven = false;                  ///< its last command was answered: every view must know it
    std::vector<nlohmann::json> all{};    ///< all that it ever was, in order
    std::size_t seen = 0;                 ///< up to where a view has shown them
};

/// A board with its agent, a broker that keeps what is retained, and the programs that show how it stands.
class World {
  protected:
    World(std::uint64_t seed, bool traced);

    void note(const std::string& text);
    void fail(const std::string& why);
    void pass(std::chrono::milliseconds time);
    void wait_for_board();

    // As programs on the bus do:
    /// Waits for the answer; whether it is ok.
    bool command(const std::string& service, const nlohmann::json& request);
    void label(const nlohmann::json& meanings);
    void read();
    /// The same; the agent answers.
    void ask_agent();

    /// Another gateway, with another process of the export, and another registry.
    void late_joiner();
    void broker_is_lost();
    /// What is to be kept is on the disk at once; what was published goes to the broker, and from there to
    /// the programs.
    void carry();
    void set(const std::string& id, nlohmann::json value);
    void begin_anew();

    /// Asks each view.
    void look();
    /// Whether every list says that the lamp cannot be set, and the gateway says so and sends nothing; or
    /// that it can.
    void judge_clash(bool refused);

    asip::agent::BridgeBench bench_;
    std::map<std::string, Truth> truth_;
    End end_;

  private:
    void take_executed();
    void told(const nlohmann::json& values);
    void judge(const std::string& view, const nlohmann::json& values);
    void judge_exports();
    void judge_registry();
    nlohmann::json records_of_asipctl();
    nlohmann::json listed_by_broker();

    const bool traced_;
    Retained retained_;
    std::optional<Gateway> gateway_;
    std::optional<Registry> registry_;
    Exports exports_;
    bool exports_are_new_ = true;
    std::string reply_;  // of the agent, to what was asked last
    std::size_t taken_ = 0, kept_ = 0;
    unsigned number_ = 0;
};

}  // namespace truth::values
