// SPDX-License-Identifier: Apache-2.0
// asipctl model, as a person uses it: what it writes, what it does not write over, and what it refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "tests/support/child_process.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {
namespace {

using testing::HasSubstr;

class ModelVerb : public testing::Test {
  protected:
    Finished model(std::vector<std::string> words) const {
        words.insert(words.begin(), {ASIP_PROGRAMS "/asipctl", "model"});
        return run(std::move(words), {{"HOME", folder_.path().string()}});
    }
    std::string read(const std::string& name) const {
        std::ifstream file(folder_.file(name));
        return {std::istreambuf_iterator<char>(file), {}};
    }

    TempDir folder_;
    const std::string fan_ = ASIP_TEST_SOURCE "/tests/generated/models/fan.json";
};

TEST_F(ModelVerb, CodeOfAPerson_IsNeverWrittenOver) {
    const auto sketch = folder_.file("Fan");
    ASSERT_EQ(model({"firmware", fan_, "--into", sketch}).status, 0);
    EXPECT_EQ(model({"firmware", fan_, "--into", sketch}).status, 0) << "nothing would change";
    std::ofstream(sketch + "/FanHardware.cpp") << "mine";
    const auto kept = model({"firmware", fan_, "--into", sketch});
    EXPECT_EQ(kept.status, 0) << kept.errors;
    EXPECT_THAT(kept.output, HasSubstr("FanHardware.cpp (kept as it is)"));
    std::ofstream(sketch + "/FanService.h") << "changed";
    const auto refused = model({"firmware", fan_, "--into", sketch});
    EXPECT_EQ(refused.status, 1);
    EXPECT_THAT(refused.errors, HasSubstr("FanService.h is there already; --force"));
    const auto forced = model({"firmware", fan_, "--into", sketch, "--force", "--elements", "1"});
    EXPECT_EQ(forced.status, 0) << forced.errors;
    EXPECT_THAT(forced.output, HasSubstr("FanHardware.cpp (kept as it is)"));
    EXPECT_EQ(read("Fan/FanHardware.cpp"), "mine");
    EXPECT_THAT(read("Fan/FanService.h"), HasSubstr("kElements = 1"));
}

TEST_F(ModelVerb, OneFileThatIsThere_KeepsAllFromBeingWritten) {
    folder_.write("fan_service_test.cpp", "mine");
    const auto refused = model({"cpp", fan_, "--into", folder_.path().string()});
    EXPECT_EQ(refused.status, 1);
    EXPECT_EQ(read("fan_service_test.cpp"), "mine");
    EXPECT_FALSE(std::filesystem::exists(folder_.file("fan_service.hpp")));
}

TEST_F(ModelVerb, Check_NamesFileAndPlace) {
    const auto checked = model({"check", fan_});
    EXPECT_EQ(checked.status, 0) << checked.errors;
    EXPECT_THAT(checked.output, HasSubstr("2 of 2 examples are true"));
    const auto wrong = folder_.write("wrong.json", R"({"name":"fan","version":1,"id":"f","title":"Fans"})");
    EXPECT_THAT(model({"check", wrong}).errors, HasSubstr("wrong.json: /id: \"f\" does not match"));
    const auto untrue = folder_.write(
        "untrue.json",
        R"({"name":"fan","version":1,"id":"F","match":["Fan"],"title":"Fans","commands":{"stop":{"tag":"S"}},
            "examples":[{"json":{"stop":null},"wire":"F,T"},{"json":{"stop":null},"wire":"F,U"}]})");
    const auto failed = model({"check", untrue});
    EXPECT_EQ(failed.status, 1);
    EXPECT_THAT(failed.errors, HasSubstr(R"({"stop":null} is F,S, not F,T)"));
    EXPECT_THAT(failed.errors, HasSubstr("\nasipctl: " + untrue)) << "each fault has a line";
    EXPECT_THAT(failed.output, HasSubstr("0 of 2 examples are true"));
}

TEST_F(ModelVerb, BadArguments_AreRefused) {
    EXPECT_EQ(model({"bake", fan_}).status, 2);
    EXPECT_EQ(model({"firmware", fan_, "--elements", "0"}).status, 2);
    EXPECT_EQ(model({"firmware", fan_, "--elements", "101"}).status, 2);
    EXPECT_THAT(model({"firmware", fan_, "--into", folder_.file("my fan")}).errors,
                HasSubstr("cannot be the name of a sketch"));
    EXPECT_THAT(model({"check", folder_.file("none.json")}).errors, HasSubstr("none.json: No such file"));
    EXPECT_EQ(model({"part", ASIP_TEST_SOURCE "/services/lcd.json", "--into", folder_.file("x.json")}).status,
              1);
    EXPECT_FALSE(std::filesystem::exists(folder_.file("x.json")));
    EXPECT_THAT(model({"docs", fan_, "--into", "/proc/fan.md"}).errors, HasSubstr("/proc/fan.md"));
}

TEST_F(ModelVerb, SketchOfServices_HasEachAndItsPins) {
    const auto made =
        model({"sketch", "ds18b20=2", "onewire=2", "servo=9,a0", "--into", folder_.file("Garden")});
    EXPECT_EQ(made.status, 0) << made.errors;
    EXPECT_EQ(read("Garden/Garden.ino"), R"(// A board with these services beside its pins:
//   ds18b20: the data pin of all (2)
//   onewire: the data pin (2)
//   servo: a pin for each servo (9, A0)
#include <Asip.h>
#include <AsipFastSerial.h>
#include <AsipOneWire.h>
#include <AsipServos.h>
#include <AsipThermometers.h>

asip::OneWireBus wire2(2);
asip::ThermometersOf<8> thermometers(wire2);
asip::OneWire oneWire(wire2);
asip::Servos servos(9, A0);

void setup() {
    asip::board.add(thermometers);
    asip::board.add(oneWire);
    asip::board.add(servos);
    asip::board.begin(ASIP_NAME("Garden"));
}

void loop() { asip::board.run(); }
)");
}

TEST_F(ModelVerb, SketchOfServices_ErrorsSayWhatIsRight) {
    const auto error = [&](std::vector<std::string> services) {
        services.insert(services.begin(), "sketch");
        services.insert(services.end(), {"--into", folder_.file("Bad")});
        const auto made = model(services);
        EXPECT_EQ(made.status, 2) << made.output;
        return made.errors;
    };
    EXPECT_THAT(error({"servoo=9"}),
                HasSubstr(R"(no service is called "servoo" (did you mean "servo"?); known are)"));
    EXPECT_THAT(error({"ds18b2=2"}), HasSubstr(R"(did you mean "ds18b20"?)"));
    EXPECT_THAT(error({"servo"}), HasSubstr("servo takes a pin for each servo, as servo=9,10"));
    EXPECT_THAT(error({"motors=7,8"}), HasSubstr("motors takes three pins for each motor"));
    EXPECT_THAT(error({"weather=4"}), HasSubstr("weather takes no pins: its chip is on I2C"));
    EXPECT_THAT(error({"servo=9,D7"}), HasSubstr(R"(servo: "D7" is no pin; write 7 or A0)"));
    EXPECT_THAT(error({"servo=9,"}), HasSubstr(R"(servo: "" is no pin)"));
    EXPECT_THAT(error({"servo=9", "tone=9"}), HasSubstr("pin 9 is given twice"));
    EXPECT_THAT(error({"dht22=4", "dht11=5"}), HasSubstr("dht22 and dht11 cannot be on one board"));
    EXPECT_THAT(error({"pixels=6", "pressure"}), HasSubstr("both have the letter P"));
    EXPECT_THAT(error({}), HasSubstr("with which services?"));
    EXPECT_FALSE(std::filesystem::exists(folder_.file("Bad")));
}

// What is compiled is all that there is.
TEST_F(ModelVerb, SketchOfServices_EachOfTheTableIsCompiled) {
    const auto errors = model({"sketch", "?"}).errors;
    auto names = errors.substr(errors.find("known are ") + 10);
    std::replace(names.begin(), names.end(), ',', ' ');
    std::istringstream list(names);
    for (std::string name; list >> name;) {
        EXPECT_THAT(" " GENERATED_SERVICES, HasSubstr(" " + name));
    }
}

TEST_F(ModelVerb, Docs_ArePrintedOrWritten) {
    const auto printed = model({"docs", fan_});
    EXPECT_THAT(printed.output, HasSubstr("# fan\n"));
    EXPECT_EQ(model({"docs", fan_, "--into", folder_.file("fan.md")}).status, 0);
    EXPECT_EQ(read("fan.md"), printed.output);
}

}  // namespace
}  // namespace asip::test
