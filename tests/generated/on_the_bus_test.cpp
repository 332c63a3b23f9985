// SPDX-License-Identifier: Apache-2.0
// From a model to a service on the bus: what `asipctl model` made of it, real firmware in a simulated chip
// with the part that was made for it, agent, broker, asipctl and the clients.
#include "cpp/fan_service.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "tests/integration/agent/rig.hpp"

namespace asip::test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing::HasSubstr;
using Words = std::vector<std::string>;

constexpr const char* kControl = ASIP_PROGRAMS "/asipctl";

/// Python code that knows the package.
Finished run_python(const std::string& code, std::map<std::string, std::string> environment) {
    environment["PYTHONPATH"] = ASIP_TEST_SOURCE "/python";
    return run({ASIP_PYTHON, "-W", "error", "-c", code}, environment);
}

/// A board of which nothing was written by hand but the model.
class GeneratedBoard {
  public:
    GeneratedBoard(const std::string& model_file, const std::string& name)
        : model_(model_file),
          name_(name),
          sim_(start()),
          probe(broker_.port()),
          agent_(broker_, folder_.file(name + ".port"), {"--services", models_folder()}) {
        if (!wait_state(probe, "online")) throw std::runtime_error(agent_.process().errors());
    }

    Finished asipctl(Words words) const {
        words.insert(words.begin(), kControl);
        return run(std::move(words), {{"ASIP_BROKER", broker_.url()}, {"HOME", folder_.path().string()}});
    }
    /// Python code that knows the package and `port` of the broker.
    Finished python(const std::string& code) const {
        return run_python("port = " + std::to_string(broker_.port()) + "\n" + code,
                          {{"ASIP_BROKER", broker_.url()}});
    }
    void tell(const std::string& command) { sim_->write_input(command + "\n"); }
    bool shows(const std::string& what) { return sim_->wait_for_output(what).has_value(); }
    std::string url() const { return broker_.url() + "/uno1"; }
    std::string log() { return agent_.process().errors(); }

  private:
    std::string models_folder() const {
        std::filesystem::create_directories(folder_.path() / "models");
        std::filesystem::copy_file(model_, folder_.path() / "models" / (name_ + ".json"),
                                   std::filesystem::copy_options::overwrite_existing);
        return folder_.file("models");
    }

    std::unique_ptr<ChildProcess> start() {
        const auto file = folder_.file(name_ + ".board.json");
        const auto made = run({kControl, "model", "part", model_, "--into", file, "--image",
                               ASIP_IMAGES "/generated_" + name_ + ".elf"});
        if (made.status != 0) throw std::runtime_error(made.errors);
        auto process = std::make_unique<ChildProcess>(Words{ASIP_PROGRAMS "/asip-sim", file, "--no-socket"});
        if (!process->wait_for_output(" port ")) throw std::runtime_error("asip-sim: " + process->errors());
        return process;
    }

    TempDir folder_;
    std::string model_, name_;
    std::unique_ptr<ChildProcess> sim_;
    MosquittoBroker broker_;

  public:
    BusProbe probe;

  private:
    Agent agent_;
};

TEST(GeneratedOnTheBus, Fan_IsListedReadAndCommanded) {
    GeneratedBoard board(ASIP_TEST_SOURCE "/tests/generated/models/fan.json", "fan");
    EXPECT_THAT(board.asipctl({"list", "--from-bus"}).output, HasSubstr("io fan"));
    board.tell("set fan speed0=1500");
    ASSERT_TRUE(board.shows("speed0=1500,speed1=0"));
    const auto read = board.asipctl({"get", "uno1/fan"});
    EXPECT_THAT(read.output, HasSubstr("1500")) << read.errors;
    EXPECT_EQ(board.asipctl({"send", "uno1/fan", "power", "1", "50"}).output, "ok\n");
    EXPECT_TRUE(board.shows("power0=0,power1=50"));
    EXPECT_THAT(board.asipctl({"send", "uno1/fan", "power", "1", "101"}).errors,
                HasSubstr("power: 101 is above 100"));
    EXPECT_THAT(board.asipctl({"send", "uno1/fan", "power", "5", "50"}).errors,
                HasSubstr("INVALID_DEVICE_NUMBER (error 7)"));
    const auto measured = board.probe.request("asip/uno1/fan/in", R"({"measure":null})");
    ASSERT_TRUE(measured);
    EXPECT_EQ(json::parse(*measured)["answer"], json::parse(R"({"speed":[1500,0]})"));
}

TEST(GeneratedOnTheBus, PythonPackage_CommandsReadsAndIsToldOfEvents) {
    GeneratedBoard board(ASIP_TEST_SOURCE "/tests/generated/models/fan.json", "fan");
    board.tell("set fan speed0=1500,speed1=5000");
    ASSERT_TRUE(board.shows("speed1=5000"));
    const auto ran = board.python(R"(
import queue
import asip
events = queue.Queue()
with asip.connect(f"127.0.0.1:{port}", timeout=20) as bus:
    fan = bus.board("uno1").fan
    fan.power(0, 100)
    print(fan.measure())
    try:
        fan.power(5, 50)
    except asip.BoardError as error:
        print(error.code, error)
    try:
        fan.power(0, 101)
    except ValueError as error:
        print(error)
    fan.on_value(lambda speed: (fan.power(1, 40), events.put(speed)))
    fan.report(50)
    print(events.get(timeout=20))
    fan.report(0)
with asip.connect() as bus:  # the environment's broker
    bus.board("uno1").fan.power(0, 90)
    try:
        bus.board("nobody", timeout=0.3)
    except LookupError as error:
        print(error)
)");
    EXPECT_EQ(
        ran.output,
        "[1500, 5000]\n"
        "7 uno1/fan power: the board refused it: INVALID_DEVICE_NUMBER (error 7)\n"
        "uno1/fan: power: 101 is above 100\n[1500, 5000]\nthere is no board \"nobody\"; there are uno1\n")
        << ran.errors << board.log();
    EXPECT_EQ(ran.status, 0);
    EXPECT_TRUE(board.shows("power0=90,power1=40"));
}

/// What asip.connect(`arguments`) says.
std::string connects(const std::map<std::string, std::string>& environment,
                     const std::string& arguments = "") {
    return run_python(
               "import asip\n"
               "try:\n"
               "    asip.connect(" +
                   arguments +
                   ").close()\n"
                   "    print('connected')\n"
                   "except (ValueError, ConnectionError) as error:\n"
                   "    print(error)\n",
               environment)
        .output;
}

TEST(PythonPackage, OverTls_OnlyTheBrokerThatTheAuthoritySignedIsTrusted) {
    const MosquittoBroker broker(MosquittoBroker::Options{.users = {{"ann", "secret"}}, .tls = true});
    const auto& certificates = broker.certificates();
    std::map<std::string, std::string> ann{{"ASIP_BROKER", broker.url()},
                                           {"ASIP_USER", "ann"},
                                           {"ASIP_PASSWORD", "secret"},
                                           {"ASIP_CA", certificates.ca}};
    EXPECT_EQ(connects(ann), "connected\n");
    const auto of_code = "\"127.0.0.1:" + std::to_string(broker.port()) +
                         R"(", user="ann", password="secret", ca=")" + certificates.ca + "\"";
    EXPECT_EQ(connects({}, of_code), "connected\n");

    std::ifstream ca(certificates.ca);
    const std::string pem((std::istreambuf_iterator<char>(ca)), {});
    const TempDir folder;
    const auto credentials = folder.write(
        "ann.credentials", "broker = " + broker.url() + "\nuser = ann\npassword = secret\n" + pem);
    EXPECT_EQ(connects({{"ASIP_CREDENTIALS", credentials}}), "connected\n");

    ann["ASIP_CA"] = certificates.other_ca;
    EXPECT_THAT(connects(ann), HasSubstr("certificate verify failed"));
    ann.erase("ASIP_CA");
    EXPECT_THAT(connects(ann), HasSubstr("certificate verify failed")) << "the system's authorities only";
}

TEST(PythonPackage, BrokerAndCredentials_AreThoseOfTheEnvironment) {
    const MosquittoBroker broker(MosquittoBroker::Options{.users = {{"ann", "secret"}}});
    const TempDir folder;
    const auto secret = folder.write("password", "secret\n");
    const auto credentials =
        folder.write("ann.credentials", "# for ann\nbroker = 127.0.0.1:1, " + broker.url() +
                                            "\nuser = ann\npassword = secret\nrole = operator\n");
    EXPECT_EQ(connects({{"ASIP_BROKER", broker.url()}, {"ASIP_USER", "ann"}, {"ASIP_PASSWORD", "secret"}}),
              "connected\n");
    EXPECT_EQ(
        connects({{"ASIP_BROKER", broker.address()}, {"ASIP_USER", "ann"}, {"ASIP_PASSWORD_FILE", secret}}),
        "connected\n");
    EXPECT_EQ(connects({{"ASIP_CREDENTIALS", credentials}, {"ASIP_BROKER", "127.0.0.1:1"}}), "connected\n");
    EXPECT_THAT(connects({{"ASIP_BROKER", broker.url()}, {"ASIP_USER", "ann"}, {"ASIP_PASSWORD", "wrong"}}),
                HasSubstr("the broker refuses us: "));
    EXPECT_THAT(
        connects({{"ASIP_CREDENTIALS", credentials}}, "\"127.0.0.1:" + std::to_string(broker.port()) + "\""),
        HasSubstr("the broker refuses us: "))
        << "a password goes to no other broker";
    EXPECT_THAT(connects({{"ASIP_BROKER", "127.0.0.1:1"}}), HasSubstr("no broker within 5 s: 127.0.0.1:1: "));
    EXPECT_THAT(connects({{"ASIP_BROKER", "http://pi.local"}}), HasSubstr("only mqtt:// and mqtts://"));
    EXPECT_THAT(connects({{"ASIP_BROKER", "pi.local:0x50"}}), HasSubstr("broker \"pi.local:0x50\": "));
}

TEST(GeneratedOnTheBus, CppClient_CommandsReadsAndIsToldOfEvents) {
    GeneratedBoard board(ASIP_TEST_SOURCE "/tests/generated/models/fan.json", "fan");
    board.tell("set fan speed0=1500");
    ASSERT_TRUE(board.shows("speed0=1500"));
    auto opened = client::BlockingBoard::open(board.url());
    ASSERT_TRUE(opened) << to_string(opened.error());
    FanService fan(*opened);
    const auto powered = fan.power(0, 30);
    EXPECT_TRUE(powered) << to_string(powered.error());
    EXPECT_TRUE(board.shows("power0=30"));
    const auto measured = fan.measure();
    ASSERT_TRUE(measured) << to_string(measured.error());
    EXPECT_THAT(measured->values, testing::ElementsAre(1500, 0));
    const auto refused = fan.power(5, 30);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, 7);
    EXPECT_EQ(fan.power(0, 101).error().text, "power: 101 is above 100");
    ASSERT_TRUE(fan.watch());
    ASSERT_TRUE(fan.report(50));
    const auto event = fan.next_event(kDeadline);
    ASSERT_TRUE(event) << to_string(event.error());
    EXPECT_THAT(std::get<FanService::SpeedEvent>(*event).values, testing::ElementsAre(1500, 0));
}

TEST(GeneratedOnTheBus, StandardModel_ReportsWhatItsExampleShows) {
    GeneratedBoard board(ASIP_TEST_SOURCE "/services/distance.json", "distance");
    board.tell("set distance distance0=42,distance1=118");
    ASSERT_TRUE(board.shows("distance0=42,distance1=118"));
    const auto measured = board.probe.request("asip/uno1/distance/in", R"({"measure":null})");
    ASSERT_TRUE(measured);
    EXPECT_EQ(json::parse(*measured)["answer"], json::parse(R"({"distance":[42,118]})"));
    EXPECT_EQ(board.asipctl({"send", "uno1/distance", "report", "20"}).status, 0);
    EXPECT_TRUE(board.probe.wait_for("asip/uno1/distance/out", R"({"distance":[42,118]})"));
}

}  // namespace
}  // namespace asip::test
