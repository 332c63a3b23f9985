// SPDX-License-Identifier: Apache-2.0
#include "sim/program/world_publisher.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <set>

#include "asip/model/names.hpp"
#include "asip/program/log.hpp"

namespace asip::sim {
namespace {

namespace log = program::log;
using namespace std::chrono_literals;
using member::Announcements;

constexpr Duration kGoodbye = 1s;
/// While so much waits for the broker, older poses are worth less than the next ones.
constexpr std::size_t kMaxWaiting = 20;

/// The file of the one world.
Expected<const BoardFile*> world_of(const std::vector<BoardFile>& boards) {
    std::set<const world::World*> worlds;
    const BoardFile* found = nullptr;
    for (const auto& board : boards) {
        if (!board.board.world) continue;
        worlds.insert(board.board.world.get());
        if (found == nullptr) found = &board;
    }
    if (found == nullptr)
        return fail("no board has a world; name its file in the board file: \"world\": \"track.json\"");
    if (worlds.size() > 1)
        return fail(
            fmt::format("the boards have {} worlds, and one can be published; start an asip-sim for each",
                        worlds.size()));
    return found;
}

Expected<void> check_names(const std::string& name, const std::vector<BoardFile>& boards,
                           const std::vector<std::string>& rovers) {
    if (const auto why = model::explain_board_name(name); !why.empty()) return fail(why);
    for (const auto& board : boards)
        if (board.board.name == name)
            return fail(fmt::format("a board is called {} too; choose another name for the world", name));
    if (rovers.size() > kMaxPublishedRovers)
        return fail(
            fmt::format("{} rovers; at most {} can be published", rovers.size(), kMaxPublishedRovers));
    for (const auto& rover : rovers) {
        if (rover == kFloorService)
            return fail(
                fmt::format("a rover's board is called {}, as the floor is; give it another name", rover));
        if (!model::valid_name(rover))
            return fail(fmt::format("the rover of board {} would be a service of that name: {}", rover,
                                    model::explain_board_name(rover)));
    }
    return {};
}

}  // namespace

void RoverNames::made(const BoardFile& board) {
    if (!board.board.world) return;
    const auto count = board.board.world->rovers().size();
    const auto& name = board.board.name;
    for (int number = 1; names_.size() < count; ++number) {
        const auto next = number == 1 ? name : fmt::format("{}-{}", name, number);
        if (std::find(names_.begin(), names_.end(), next) == names_.end()) names_.push_back(next);
    }
}

Expected<std::unique_ptr<WorldPublisher>> WorldPublisher::create(boost::asio::io_context& io,
                                                                 const std::string& name,
                                                                 const program::BrokerOptions& broker,
                                                                 const std::vector<BoardFile>& boards,
                                                                 const std::vector<std::string>& rovers) {
    const auto world = world_of(boards);
    if (!world) return fail("--publish-world: " + world.error());
    if (const auto names = check_names(name, boards, rovers); !names)
        return fail("--publish-world: " + names.error());
    auto options = program::mqtt_options(broker, "asip-sim");
    if (!options) return fail(options.error());

    WorldIdentity identity{name, (*world)->world.filename().string(), rovers, {}, {}};
    identity.announcer.started_unix = static_cast<std::uint64_t>(std::time(nullptr));
    identity.announcer.on_shared_topic = !options->has_user();
    identity.agent = {ASIP_VERSION, program::host_name(), options->client_id};
    const bus::Topics topics(broker.topic_root);
    WorldMember member(topics, std::move(identity), (*world)->board.world, options->random);
    return std::unique_ptr<WorldPublisher>(
        new WorldPublisher(io, topics, std::move(*options), std::move(member)));
}

WorldPublisher::WorldPublisher(boost::asio::io_context& io, const bus::Topics& topics, mqtt::Options options,
                               WorldMember member)
    : topics_(topics), has_user_(options.has_user()), member_(std::move(member)), timer_(io) {
    options.will = member_.will();
    client_ = std::make_unique<mqtt::Client>(io, std::move(options), handlers());
    for (const auto& [filter, how] : member_.subscriptions())
        client_->subscribe(filter, how);
    client_->start();
    wait();
}

bool WorldPublisher::keeps_up() const {
    return client_->counters().queued < kMaxWaiting;
}

template <class Call>
void WorldPublisher::with(Call&& call) {
    if (ended_) return;
    Announcements out;
    call(Clock::now(), out);
    if (has_user_) member::take_stray_answers(out.publish, topics_, member_.name());
    for (auto& publication : out.publish)
        client_->publish(std::move(publication.message), publication.priority);
    for (const auto& notice : out.notices) {
        std::vector<log::Field> fields;
        for (const auto& [name, value] : notice.fields)
            fields.emplace_back(name, value);
        log::write(notice.level, notice.text, fields);
    }
    if (!out.fatal) return;
    log::error("the world is not published; the boards run on, --publish-world takes another name",
               {{"why", out.fatal->text.substr(0, out.fatal->text.find(';'))}});
    ended_ = true;
    timer_.cancel();
    client_->stop(kGoodbye, [] {});
}

void WorldPublisher::wait() {
    timer_.expires_at(member_.next_deadline());
    timer_.async_wait([this](boost::system::error_code error) {
        if (error || ended_) return;
        with([this](Time now, auto& out) { member_.tick(now, keeps_up(), out); });
        if (!ended_) wait();
    });
}

mqtt::Client::Handlers WorldPublisher::handlers() {
    mqtt::Client::Handlers result;
    result.on_connected = [this](const mqtt::Connected& connected) {
        log_.connected(connected);
        denied_ = false;
        client_->discard_queued(mqtt::Priority::kAnnouncement);
        client_->discard_queued(mqtt::Priority::kContext);
        with([this](Time now, auto& out) { member_.on_connected(now, out); });
    };
    result.on_subscribed = [this] { with([this](Time now, auto& out) { member_.on_subscribed(now, out); }); };
    result.on_disconnected = [this](const mqtt::ConnectionFailure& why) {
        log::warning("connection lost", {{"why", why.text}});
        member_.on_disconnected();
    };
    result.on_connect_failed = [this](const mqtt::ConnectionFailure& why) {
        log_.connect_failed(why, [this](Duration wait) { client_->retry_in(wait); });
    };
    result.on_subscribe_refused = program::BrokerLog::subscribe_refused;
    result.on_publish_denied = [this](const std::string& topic, const std::string& why) {
        if (!std::exchange(denied_, true))
            log::warning("the broker denies a message; check its access rules",
                         {{"topic", topic}, {"why", why}});
    };
    result.on_message = [this](const mqtt::Message& message) {
        with([&](Time now, auto& out) { member_.on_message(message, now, out); });
    };
    return result;
}

void WorldPublisher::end(std::function<void()> ended) {
    if (ended_) return ended();
    with([this](Time now, auto& out) { member_.goodbye(now, out); });
    ended_ = true;
    timer_.cancel();
    client_->stop(kGoodbye, std::move(ended));
}

}  // namespace asip::sim
