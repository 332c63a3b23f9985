// SPDX-License-Identifier: Apache-2.0
// One agent process for several boards.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <boost/asio/ip/tcp.hpp>
#include <csignal>
#include <cstring>
#include <filesystem>

#include "tests/integration/agent/fake_port.hpp"
#include "tests/integration/agent/rig.hpp"

namespace asip::test {
namespace {

using testing::HasSubstr;

/// asip-sim with boards of real firmware, their ports at port(NAME).
class Simulator {
  public:
    explicit Simulator(std::vector<std::string> boards) : boards_(std::move(boards)) {
        command_ = {ASIP_PROGRAMS "/asip-sim"};
        for (const std::string& board : boards_)
            command_.push_back(folder_.write(board + ".json", R"({"name":")" + board +
                                                                  R"(","board":"uno","image":")" ASIP_IMAGES
                                                                  R"(/asip_uno_services.elf","link":")" +
                                                                  port(board) + R"("})"));
        command_.emplace_back("--no-socket");
        start();
    }
    void start() {
        process_ = std::make_unique<ChildProcess>(command_);
        for (const std::string& board : boards_)
            if (!process_->wait_for_output(board + " .* port ")) throw std::runtime_error(process_->errors());
    }
    void kill() {
        process_->signal(SIGKILL);
        process_->wait_exit();
        // A link that it left would soon lead to another port, a test's beside this one: the kernel gives the
        // number again.
        for (const std::string& board : boards_)
            std::filesystem::remove(port(board));
    }
    std::string port(const std::string& board) const { return folder_.file(board); }

  private:
    TempDir folder_;
    std::vector<std::string> boards_;
    std::vector<std::string> command_;
    std::unique_ptr<ChildProcess> process_;
};

/// What systemd would be told.
class NotifySocket {
  public:
    NotifySocket() : path_(folder_.file("notify")), socket_(socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        std::strncpy(address.sun_path, path_.c_str(), sizeof address.sun_path - 1);
        if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
            throw std::runtime_error("bind");
    }
    ~NotifySocket() { close(socket_); }

    const std::string& path() const { return path_; }
    bool heard(const std::string& text) {
        return wait_until([&] {
            char bytes[512];
            for (ssize_t size; (size = recv(socket_, bytes, sizeof bytes, 0)) > 0;)
                heard_ += std::string(bytes, static_cast<std::size_t>(size)) + "\n";
            return heard_.find(text) != std::string::npos;
        });
    }
    const std::string& all() const { return heard_; }

  private:
    TempDir folder_;
    std::string path_;
    int socket_;
    std::string heard_;
};

class ManyBoards : public testing::Test {
  protected:
    std::string section(const std::string& board, const std::string& port) {
        return "[board " + board + "]\nserial = " + port + "\n";
    }
    void write(const std::string& sections) {
        file_ = folder_.write("boards.conf", "broker = " + broker_.url() +
                                                 "\nlog-level = debug\nstate-dir = " + folder_.file("state") +
                                                 "\n" + sections);
    }
    ChildProcess& agent() {
        if (!agent_)
            agent_ = std::make_unique<ChildProcess>(
                std::vector<std::string>{ASIP_PROGRAMS "/asip-agent", "--config", file_},
                std::map<std::string, std::string>{{"NOTIFY_SOCKET", systemd_.path()}});
        return *agent_;
    }
    bool is(const std::string& board, const std::string& state) {
        return wait_state(probe_, state, kDeadline, board);
    }
    /// That the board executes a command.
    testing::AssertionResult answers(const std::string& board) {
        const auto reply = probe_.request("asip/" + board + "/io/in", R"({"mode":[13,"output"]})");
        if (reply && reply->find(R"("proof":"fence")") != std::string::npos)
            return testing::AssertionSuccess();
        return testing::AssertionFailure() << board << ": " << reply.value_or("no answer") << "\n"
                                           << agent().errors();
    }

    MosquittoBroker broker_;
    BusProbe probe_{broker_.port()};
    NotifySocket systemd_;
    TempDir folder_;
    std::string file_;
    std::unique_ptr<ChildProcess> agent_;
};

TEST_F(ManyBoards, OneBoardKilledAndBack_OthersAnswerMeanwhile) {
    Simulator staying({"left", "right"});
    Simulator dying({"middle"});
    write(section("left", staying.port("left")) + section("right", staying.port("right")) +
          section("middle", dying.port("middle")));
    agent();
    for (const char* board : {"left", "right", "middle"})
        ASSERT_TRUE(is(board, "online")) << agent().errors();
    EXPECT_TRUE(systemd_.heard("STATUS=3 of 3 boards on the bus")) << systemd_.all();
    EXPECT_THAT(systemd_.all(), HasSubstr("READY=1"));
    ASSERT_TRUE(answers("middle"));

    dying.kill();
    ASSERT_TRUE(is("middle", "lost")) << agent().errors();
    EXPECT_TRUE(systemd_.heard("STATUS=2 of 3 boards on the bus")) << systemd_.all();
    EXPECT_TRUE(answers("left"));
    EXPECT_TRUE(answers("right"));
    dying.start();
    ASSERT_TRUE(is("middle", "online")) << agent().errors();
    EXPECT_TRUE(answers("middle"));
    for (const char* board : {"left", "right"})
        EXPECT_EQ(probe_.last("asip/servicebus/" + std::string(board) + "/$state"), "online");

    // Labels of each board are in a file of its own.
    const auto label = probe_.request("asip/left/in", R"({"labels":{"room":"lab"}})");
    ASSERT_TRUE(label);
    EXPECT_TRUE(wait_until([&] {
        return std::filesystem::exists(folder_.path() / "state" / "labels" / "left.json");
    })) << *label;
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "state" / "labels" / "right.json"));

    agent().signal(SIGTERM);
    EXPECT_EQ(agent().wait_exit(time_limit(2s)), 0);
    for (const char* board : {"left", "right", "middle"})
        EXPECT_TRUE(is(board, "offline"));
    EXPECT_TRUE(systemd_.heard("STOPPING=1"));
}

TEST_F(ManyBoards, OneWithoutPortAndOneWithATakenName_EndAloneAndComeBack) {
    FakePort good, taken, other;
    write(section("good", good.path()) + section("taken", taken.path()) + section("bad", "/dev/null"));
    ChildProcess holder({ASIP_PROGRAMS "/asip-agent", "--serial", other.path(), "--broker", broker_.url(),
                         "--name", "taken"});
    ASSERT_TRUE(is("taken", "online")) << holder.errors();
    agent();
    ASSERT_TRUE(is("good", "online")) << agent().errors();
    ASSERT_TRUE(agent().wait_for_errors("waiting for it.*board=bad .*/dev/null is not a serial port"))
        << agent().errors();
    ASSERT_TRUE(agent().wait_for_errors("has ended; starting it again.*board=taken status=6"))
        << agent().errors();
    EXPECT_TRUE(
        systemd_.heard("1 of 3 boards on the bus; ended and to be started again: taken (6); bad waits: "))
        << systemd_.all();
    EXPECT_TRUE(agent().running());
    EXPECT_TRUE(answers("good"));

    holder.signal(SIGTERM);
    ASSERT_TRUE(holder.wait_exit());
    ASSERT_TRUE(is("taken", "offline"));
    ASSERT_TRUE(is("taken", "online")) << "tried again by itself\n" << agent().errors();
    EXPECT_TRUE(answers("taken"));
    EXPECT_TRUE(answers("good"));
}

TEST_F(ManyBoards, PortInUse_TheReasonIsOnTheBusUntilItIsFree) {
    FakePort port;
    const int other = open(port.path().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    ASSERT_EQ(flock(other, LOCK_EX | LOCK_NB), 0);
    write(section("desk", port.path()));
    agent();
    const auto described = [this](const std::string& text) {
        return wait_until([&] {
            return probe_.last("asip/servicebus/desk/$description").value_or("").find(text) !=
                   std::string::npos;
        });
    };
    ASSERT_TRUE(is("desk", "lost")) << agent().errors();
    EXPECT_TRUE(described(port.path() + " is in use by another program"));
    EXPECT_TRUE(described(R"("reason":"released")"));
    EXPECT_TRUE(systemd_.heard("is in use by another program")) << systemd_.all();
    const auto refused = probe_.request("asip/desk/io/in", R"({"mode":[13,"output"]})");
    EXPECT_THAT(refused.value_or("no answer"), HasSubstr("board-not-there"));
    close(other);
    ASSERT_TRUE(is("desk", "online")) << agent().errors();
    EXPECT_TRUE(answers("desk"));
    EXPECT_THAT(*probe_.last("asip/servicebus/desk/$description"), testing::Not(HasSubstr("in use")));
}

TEST_F(ManyBoards, Sighup_TakesWhatChangedAndLeavesTheOthersAlone) {
    FakePort staying, leaving, coming;
    write(section("staying", staying.path()) + section("leaving", leaving.path()));
    agent();
    ASSERT_TRUE(is("staying", "online")) << agent().errors();
    ASSERT_TRUE(is("leaving", "online")) << agent().errors();

    write(section("staying", staying.path()) + section("staying", coming.path()));
    agent().signal(SIGHUP);
    ASSERT_TRUE(agent().wait_for_errors("going on as before.*boards.conf:6: the name staying"))
        << agent().errors();
    EXPECT_EQ(probe_.last("asip/servicebus/leaving/$state"), "online");

    probe_.clear();
    const auto with_password = section("coming", coming.path()) +
                               "user = desk\npassword-file = " + folder_.write("password", "first\n") + "\n";
    write(with_password + section("staying", staying.path()));
    agent().signal(SIGHUP);
    ASSERT_TRUE(is("leaving", "offline")) << agent().errors();
    ASSERT_TRUE(is("coming", "online")) << agent().errors();
    EXPECT_TRUE(answers("coming"));
    EXPECT_TRUE(answers("staying"));
    const auto log = agent().errors();
    const std::string identified = "board identified  board=staying";
    EXPECT_EQ(log.find(identified), log.rfind(identified)) << "it was not started again\n" << log;
    EXPECT_TRUE(systemd_.heard("RELOADING=1"));

    probe_.clear();
    folder_.write("password", "second\n");
    write(with_password + section("staying", staying.path()) + "label = room=lab\n");
    agent().signal(SIGHUP);
    ASSERT_TRUE(agent().wait_for_errors("file read again.*changed=2")) << agent().errors();
    ASSERT_TRUE(probe_.wait_for([](const mqtt::Message& message) {
        return message.topic == "asip/servicebus/staying/$description" &&
               message.payload.find(R"("room":"lab")") != std::string::npos;
    })) << agent().errors();
    for (const char* board : {"staying", "coming"}) {
        ASSERT_TRUE(is(board, "online")) << agent().errors();
        EXPECT_TRUE(answers(board));
    }
}

TEST_F(ManyBoards, PortOfOneBoardReleased_OthersKeepTheirs) {
    FakePort released, kept;
    write(section("released", released.path()) + section("kept", kept.path()));
    agent();
    ASSERT_TRUE(is("released", "online")) << agent().errors();
    ASSERT_TRUE(is("kept", "online")) << agent().errors();
    const auto reply = probe_.request("asip/released/in", R"({"port":"release","seconds":60,"by":"test"})");
    ASSERT_TRUE(reply);
    EXPECT_THAT(*reply, HasSubstr(R"("status":"ok")"));
    ASSERT_TRUE(is("released", "updating")) << agent().errors();
    EXPECT_TRUE(answers("kept"));
    EXPECT_EQ(probe_.last("asip/servicebus/kept/$state"), "online");
}

}  // namespace
}  // namespace asip::test
