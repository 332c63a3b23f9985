// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "asip/mqtt/message.hpp"
#include "gateway/export/board_export.hpp"
#include "gateway/export/dialect.hpp"

namespace asip::gateway::exports {

/// What the broker retains of an export, read back: between begin() and take_all(). Pure.
class RetainedScan {
  public:
    static constexpr std::size_t kMaxBytes = std::size_t{256} << 20;

    void begin(std::string mark) {
        mark_ = std::move(mark);
        found_.clear();
        bytes_ = 0;
        complete_ = true;
    }
    bool runs() const { return !mark_.empty(); }
    const std::string& mark() const { return mark_; }
    /// One that was retained; others are passed over.
    void message(const mqtt::Message& message) {
        if (!runs() || !message.retain || message.payload.empty()) return;
        const auto bytes = message.topic.size() + message.payload.size() + 100;
        if (bytes_ + bytes > kMaxBytes) {
            complete_ = false;
            return;
        }
        if (found_.emplace(message.topic, message.payload).second) bytes_ += bytes;
    }
    /// False: there was more than is kept.
    bool complete() const { return complete_; }
    /// Topic -> payload. The scan is over.
    std::map<std::string, std::string> take_all() {
        mark_.clear();
        bytes_ = 0;
        return std::exchange(found_, {});
    }

  private:
    std::string mark_;
    std::map<std::string, std::string> found_;
    std::size_t bytes_ = 0;
    bool complete_ = true;
};

/// An export that retains what it shows: says when what its dialect decides is published. At each connection,
/// and when the other system starts, it reads back what the broker retains and puts right what differs:
/// nothing is left behind by a crash, a rename or an option that was taken away. What others empty meanwhile
/// is retained again. States of an earlier session of a board, which may have been forgotten since, are not
/// known any more.
class Exporter final : public BoardExport {
  public:
    static constexpr Duration kBetweenDocuments = std::chrono::seconds(2);  ///< of one board
    static constexpr std::size_t kSlice = 20;        ///< messages that are acknowledged
    static constexpr std::size_t kBoardsAtOnce = 8;  ///< are looked at in a turn
    static constexpr Duration kBetweenSessions = std::chrono::seconds(20);  ///< their messages
    static constexpr Duration kScanLimit = std::chrono::seconds(10);
    static constexpr Duration kPutBack = std::chrono::milliseconds(500);  ///< behind what others empty
    static constexpr std::size_t kMaxEmptied = 50'000;                    ///< topics; more is read back

    struct Options : BoardExport::Options {
        std::shared_ptr<const Dialect> dialect;
    };
    Exporter(Options options, Random random, Port port);

    const Dialect& dialect() const { return *dialect_; }
    std::string_view by() const override { return dialect().by(); }
    std::string_view title() const override { return dialect().title(); }
    std::vector<std::string> subscriptions() const override;
    std::vector<std::string> own_subscriptions() const override;
    std::optional<mqtt::Message> will() const override;

    // Over the gateway's connection:
    void message(const mqtt::Message& message, Time now) override;
    void value(std::string_view board, std::string_view service, std::string_view json, Time now) override;
    void known(const std::string& board, const std::vector<std::string>& ids, Time now) override;
    void acted(const std::string& board, const std::string& id, property::ButtonAct act) override;

    // Over the export's own:
    void sent(Time now) override;
    void own_subscribed(Time now) override;
    void own_disconnected() override;
    void own_message(const mqtt::Message& message, Time now) override;

    void tick(Time now) override;
    void leave() override;

    std::size_t boards() const { return records_.size(); }

  private:
    struct Record : ShownBoard {
        std::string state;     // as it was published
        std::string document;  // likewise
        std::optional<Time> document_at;
        bool document_due = true;
        bool values_due = false;         // what is known was not looked at since the broker was read
        std::vector<PacedValue> states;  // of each property, then of an error that is retained
        std::map<std::string, std::string> targets;  // topic -> payload

        /// Values may be sent. Without a document on the broker the next gateway would not know whose they
        /// are.
        bool has_document() const { return !document.empty() || !document_due; }
    };
    using Records = std::unordered_map<std::string, Record>;

    /// What was retained, while it is looked through: in turns.
    struct Scanned {
        Dialect::Retained found;
        std::optional<Dialect::Retained::const_iterator> next;  // behind the boards
        std::set<std::string> places;
        std::map<std::string, std::string> sessions;  // of boards, as an exporter published them
        std::set<std::string> wanted;                 // topics
        std::vector<std::string> boards;              // to be looked at
        std::set<std::string> listed;                 // these, and those that were
        std::set<std::string> adopted;                // those of them that were there
    };

    void begin_scan(Time now);
    void finish_scan();
    void look_through(Time now);
    void forget_others(const std::set<std::string>& adopted);
    void adopt(const std::string& name, Time now);
    void show_all(Time now);
    void begin_to_show();
    void show_gateway();
    void show_standing();
    void show_sessions(Time now);
    /// No state that waits for its turn is of an earlier session on the broker.
    bool states_are_of_their_sessions() const;
    std::string lease() const override { return dialect().lease(); }
    void connect() override;
    void become_idle(const std::string& why) override;
    void clear_some();
    void put_back(Time now);
    void pump(Time now) override;
    void update(const std::string& name, Time now);
    void take(Record& record, std::shared_ptr<const ExportedBoard> board);
    void remove(const std::string& name);
    void publish_document(Record& record, Time now);
    void publish_state(Record& record, std::size_t index);
    void publish_target(Record& record, const Property& property, const std::string& payload);
    void offer(Record& record, std::size_t index, std::string text, Time now);
    void all_values(Record& record, Time now);
    void show(Record& record, std::size_t index, const std::optional<nlohmann::json>& value, Time now);
    Record* record_of(const std::string& id);
    void command(const Dialect::Command& command, const std::string& payload);
    void failed(const std::string& board, const std::string& id, const std::string& sentence);
    void retain(std::string topic, std::string payload, int qos = 1);
    std::string mark() const { return dialect().base() + "/$mark/" + scan_.mark(); }
    /// States behind those of the properties: of the last error, and of the firmware.
    std::size_t more_slots() const { return dialect().error_is_retained() ? 2 : 0; }
    std::string state_topic(const Record& record, std::size_t index) const;

    std::shared_ptr<const Dialect> dialect_;
    Random random_;
    Records records_;
    std::set<std::string> later_;    // boards to look at from the next tick on
    std::deque<std::string> clear_;  // topics
    std::set<std::string> emptied_;  // topics, by others
    std::optional<Time> put_back_at_;
    std::set<std::pair<std::string, std::size_t>> pending_;  // states that wait for their turn
    RetainedScan scan_;
    std::optional<Scanned> scanned_;
    std::string gateway_document_;    // as it was published
    std::string standing_;            // likewise
    std::size_t online_ = 0;          // of the records
    std::uint64_t acknowledged_ = 0;  // messages that are, or will be
    bool gateway_due_ = false;        // its document or its state
    bool sessions_due_ = false;
    Time sessions_at_{};
    std::optional<Time> scan_until_, scan_at_;
};

}  // namespace asip::gateway::exports
