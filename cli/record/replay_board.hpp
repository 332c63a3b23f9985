// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "asip/bus/topics.hpp"
#include "asip/member/announcer.hpp"
#include "asip/member/bystander.hpp"
#include "asip/mqtt/message.hpp"
#include "asip/random.hpp"
#include "cli/record/recording.hpp"

namespace asip::cli {

/// A recorded board as a member of the bus: announced with its description, lease and state, as its agent
/// did, and refusing every command. A board that was recorded without a description publishes its names only:
/// its own, and those of the services that said something. Pure.
class ReplayBoard {
  public:
    struct Identity {
        std::string name;                      ///< on this bus
        std::string source;                    ///< the recording, for people: in the description as its link
        member::AnnouncerOptions announcer{};  ///< `board` is filled in
        model::AgentInfo agent{};
    };
    /// What is known of it before it is played.
    struct Recorded {
        std::optional<model::Description> first;  ///< description; nothing where there is none
        std::set<std::string> services;           ///< that it named or that said something
        void take(const RecordedMessage& message);
    };
    ReplayBoard(const bus::Topics& topics, Identity identity, const Recorded& recorded, Random random);

    const std::string& name() const { return identity_.name; }
    /// What the broker publishes when this program dies; nothing for a board of names only.
    std::optional<mqtt::Message> will() const;
    std::vector<member::Announcer::Subscription> subscriptions() const;

    void on_connected(Time now, member::Announcements& out);
    void on_subscribed(Time now, member::Announcements& out);
    void on_disconnected();
    void on_message(const mqtt::Message& message, Time now, member::Announcements& out);
    void tick(Time now, member::Announcements& out);

    /// Whether the board is announced, and what it said can be published.
    bool ready() const;
    /// What was recorded of it next.
    void play(const RecordedMessage& message, Time now, member::Announcements& out);
    /// `offline`.
    void goodbye(Time now, member::Announcements& out);

  private:
    void describe(model::Description description);
    void publish_names(Time now, member::Announcements& out);

    bus::Topics topics_;
    Identity identity_;
    member::Bystander bystander_;
    std::optional<member::Announcer> announcer_;  // none: names only
    std::set<std::string> services_;              // of a board of names only
    Time named_{};                                // when its names were last published
    std::optional<model::Description> described_;
    bool connected_ = false;
};

/// How a recorded board is reached, in its description; the path is its recording.
inline constexpr std::string_view kReplayLink = "replay";
/// The reason by which a recorded board refuses commands.
inline constexpr std::string_view kRefusedRecorded = "recorded";

}  // namespace asip::cli
