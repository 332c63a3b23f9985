// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "gateway/commands/commands.hpp"
#include "gateway/http/server.hpp"

namespace asip::gateway {
class Gateway;
}

namespace asip::gateway::api {

/// The answers of several boards to those who asked the same, sent once all have come.
struct BoardAnswers {
    std::vector<http::Reply> replies;
    nlohmann::json boards = nlohmann::json::object();
    std::size_t missing = 0;

    void answered(const std::string& board, const bus::Reply& answer);
    void send();
};

/// Stops and resumes of many boards. Each client has one under way at a time; those that it asks for
/// meanwhile are one, the next. A stop waits for no resume, and a resume that waits is refused when a stop
/// comes behind it. Each is one line of the log.
class ManyBoards {
  public:
    static constexpr std::size_t kFew = 16;  ///< so many boards, or fewer, are asked at once
    /// The next does not wait longer, for boards that do not answer.
    static constexpr std::chrono::milliseconds kLongest{500};

    struct Asked {
        bool stop = true;
        bool latch = true;
        std::string why{};
        std::string by{};
        std::string client{};
        std::vector<std::string> boards{};                ///< their answers are waited for
        std::vector<std::string> lost{};                  ///< may hear it once they are back
        nlohmann::json known = nlohmann::json::object();  ///< the answers for other names
    };
    explicit ManyBoards(Gateway& gateway) : gateway_(gateway) {}

    void ask(Asked asked, const http::Reply& reply);
    /// Call ten times a second.
    void tick(Time now);

  private:
    /// What was asked for with the same boards.
    struct Wish {
        std::vector<std::string> boards;
        std::shared_ptr<BoardAnswers> answers;
    };
    struct Run {
        std::string by, client, why;
        bool stop = true;
        std::map<std::string, bool> boards;  ///< whether the stop holds
        std::map<std::string, bool> lost;
        std::vector<Wish> wishes;
        // While it is under way:
        std::size_t open = 0, ok = 0;
        std::vector<std::string> others;  ///< boards that are not "ok", with the reason; the first ones
    };
    struct Client {
        std::shared_ptr<Run> running;
        Time begun{};
        std::optional<Run> stop, resume;  ///< next
    };
    static bool busy(const Client& client, Time now) {
        return client.running && client.running->open > 0 && now < client.begun + kLongest;
    }
    static void add(std::optional<Run>& to, Asked asked, const http::Reply& reply);
    void start(Client& client, Run run);
    void send(const Run& run, const std::string& board, bool latch, Commands::Done done);
    static void answered(Run& run, const std::string& board, const bus::Reply& reply);

    Gateway& gateway_;
    std::map<std::string, Client> clients_;
};

}  // namespace asip::gateway::api
