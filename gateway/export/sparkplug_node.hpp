// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "gateway/export/board_export.hpp"
#include "gateway/export/sparkplug.hpp"

namespace asip::gateway::exports {

/// The edge node of Sparkplug B: says when what Sparkplug decides is published, and numbers it. Hosts ask for
/// births, so only which gateway it is is retained. A connection's number (bdSeq) is the term of the lease.
class SparkplugNode final : public BoardExport {
  public:
    static constexpr Duration kBetweenBirths = std::chrono::seconds(1);  ///< that hosts ask for

    struct Options : BoardExport::Options {
        Sparkplug::Options dialect;
    };
    struct Counters {
        std::uint64_t births = 0;   ///< of the node
        std::uint64_t bad = 0;      ///< payloads that cannot be read
        std::uint64_t unknown = 0;  ///< metrics that are not there
    };

    SparkplugNode(Options options, Random random, Port port);

    std::string_view by() const override { return "sparkplug"; }
    std::string_view title() const override { return "Sparkplug"; }
    std::vector<std::string> subscriptions() const override;
    std::vector<std::string> own_subscriptions() const override;
    std::optional<mqtt::Message> will() const override;
    void message(const mqtt::Message& message, Time now) override;
    void value(std::string_view board, std::string_view service, std::string_view json, Time now) override;
    void known(const std::string& board, const std::vector<std::string>& ids, Time now) override;
    void own_connected() override;
    void own_subscribed(Time now) override;
    void own_disconnected() override;
    void own_message(const mqtt::Message& message, Time now) override;
    void tick(Time now) override;
    void sent(Time now) override;
    void leave() override;

    const Counters& counters() const { return counters_; }

  private:
    struct Slot {
        Sparkplug::Slot metric;
        std::size_t property = 0;
        std::uint64_t alias = 0;  // since the last birth
    };
    /// How a property stands.
    struct State {
        PacedValue value;        // JSON
        std::string fault;       // of the last command; empty: it was executed
        bool fault_due = false;  // that it changed is to be said
        std::optional<Time> fault_at;
    };
    struct Record : ShownBoard {
        bool born = false;
        std::vector<State> states;
        std::vector<Slot> slots;
    };

    void births(Time now);
    void end_session(bool said);
    std::string lease() const override { return dialect_.lease(); }
    void connect() override;
    void become_idle(const std::string& why) override;
    void clear();
    void host_said(const mqtt::Message& message, Time now);
    void node_command(const mqtt::Message& message, Time now);
    void board_command(const std::string& name, const mqtt::Message& message);
    void command(const std::string& name, std::size_t index, const std::vector<Sparkplug::Wanted>& wanted);
    void answered(const std::string& name, const std::string& property, const std::string& fault);
    std::optional<sparkplug::Payload> read(const mqtt::Message& message);
    void pump(Time now) override;
    void update(const std::string& name, Time now);
    void take(Record& record, std::shared_ptr<const ExportedBoard> board);
    void birth(Record& record, Time now);
    std::size_t birth_bytes(const ExportedBoard& board) const;
    void death(Record& record);
    void publish_data(Record& record, const std::vector<std::size_t>& properties);
    void all_values(Record& record, Time now);
    Record* living(const std::string& board);
    bool take_value(Record& record, std::size_t index, const std::optional<nlohmann::json>& value, Time now);
    void show(Record& record, const std::vector<std::size_t>& changed, Time now);
    sparkplug::Metric metric(const Record& record, const Slot& slot, std::uint64_t time_ms) const;
    void say(const std::string& topic, sparkplug::Payload payload);
    mqtt::Message death_of(unsigned bd_seq) const;
    std::uint64_t time_ms() const { return static_cast<std::uint64_t>(port_.wall_ms()); }
    void log_seldom(std::uint64_t count, const std::string& sentence);

    Sparkplug::Options names_;
    Sparkplug dialect_;
    unsigned bd_seq_ = 0;       // of this connection
    unsigned next_bd_seq_ = 0;  // of the next: in its will
    unsigned seq_ = 0;          // of the next message
    std::uint64_t next_alias_ = 1;
    bool host_online_ = false;
    double host_time_ = 0;
    std::unordered_map<std::string, Record> records_;
    std::set<std::pair<std::string, std::size_t>> pending_;  // values that wait for their turn
    std::optional<Time> born_at_, births_due_;
    Counters counters_;
};

}  // namespace asip::gateway::exports
