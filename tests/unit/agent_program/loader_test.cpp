// SPDX-License-Identifier: Apache-2.0
// Loading firmware: programs of the shell play avrdude, which tests/box has for real.
#include "agent/program/loader.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <csignal>
#include <optional>

#include "asip/text/file_text.hpp"
#include "tests/support/loop.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::agent {
namespace {

using testing::Contains;
using testing::HasSubstr;

class LoaderTest : public testing::Test {
  protected:
    std::string program(const std::string& script) {
        const auto file = folder_.write("avrdude", "#!/bin/sh\n" + script + "\n");
        ::chmod(file.c_str(), 0755);
        return file;
    }
    Loader::Order order(const std::string& avrdude) {
        folder_.write("AsipServices-uno.hex", ":00000001FF\n");
        folder_.write("AsipServices-mega.hex", ":00000001FF\n");
        return {"/dev/ttyUSB0", avrdude, folder_.path().string(), "AsipServices",
                *link::boot_loaders("", "", "")};
    }
    std::string read(const std::string& name) const {
        return text::file_text(folder_.file(name)).value_or("");
    }
    /// What became of it.
    Expected<void> load(Loader::Order wanted) {
        std::optional<Expected<void>> result;
        Loader loader(io_, std::move(wanted),
                      {[this](std::string_view step, int percent) {
                           steps_.push_back(std::string(step) + " " + std::to_string(percent));
                       },
                       [&](const Expected<void>& done) { result = done; }});
        test::run_until(io_, [&result] { return result.has_value(); });
        return result.value_or(fail("no end"));
    }

    boost::asio::io_context io_;
    test::TempDir folder_;
    std::vector<std::string> steps_;
};

TEST_F(LoaderTest, Success_HasItsStepsAndIsTheFirstBootLoader) {
    const auto done = load(order(program("echo \"$@\" >>" + folder_.file("calls") +
                                         "; printf 'Writing | #####' >&2; printf '\\nReading | ##' >&2")));
    EXPECT_TRUE(done) << done.error();
    EXPECT_THAT(steps_, Contains("connecting 0"));
    EXPECT_THAT(steps_, Contains("verifying 4"));
    const auto calls = read("calls");
    EXPECT_THAT(calls, HasSubstr("-c arduino -P /dev/ttyUSB0 -b 115200"));
    EXPECT_THAT(calls, HasSubstr("AsipServices-uno.hex:i"));
}

TEST_F(LoaderTest, BootLoaderThatDoesNotAnswer_TheNextIsTried) {
    const auto done =
        load(order(program("case \"$*\" in *m2560*) exit 0;; esac; echo 'not in sync' >&2; exit 1")));
    EXPECT_TRUE(done) << done.error();
}

TEST_F(LoaderTest, NothingAnswers_IsSaidInWords) {
    const auto done = load(order(program("echo 'programmer is not responding' >&2; exit 1")));
    ASSERT_FALSE(done);
    EXPECT_THAT(done.error(), HasSubstr("no boot loader answers"));
}

TEST_F(LoaderTest, WhatIsMissing_IsNamed) {
    EXPECT_THAT(load(order("no-such-avrdude")).error(), HasSubstr("sudo apt install avrdude"));
    auto other = order(program("exit 0"));
    other.firmware = "Other";
    EXPECT_THAT(load(other).error(), HasSubstr("Other-uno.hex"));
}

TEST_F(LoaderTest, BoardIsUnplugged_AvrdudeIsEndedAtOnce_AndNoOtherBootLoaderTried) {
    auto wanted = order(program("echo call >>" + folder_.file("calls") + "; rm " + folder_.file("port") +
                                "; exec sleep 100"));
    wanted.port = folder_.write("port", "");
    const auto done = load(wanted);
    ASSERT_FALSE(done);
    EXPECT_THAT(done.error(), HasSubstr("was unplugged"));
    EXPECT_EQ(read("calls"), "call\n");
}

TEST_F(LoaderTest, VersionThatMayBeLoaded_IsThatOfAnImageForThisChip) {
    const auto version = [this](const std::string& sketch, const std::string& chip = "ATmega328P") {
        return loadable_version(folder_.path(), sketch, chip);
    };
    folder_.write("Mine-uno.hex", "");
    EXPECT_EQ(version("Mine"), 0) << "without a list";
    folder_.write("versions", "AsipServices 3\nAsipClimate 103\n../Mine 5\nMine 4\nbroken");
    folder_.write("AsipClimate-uno.hex", "");
    EXPECT_EQ(version("AsipClimate"), 103);
    EXPECT_EQ(version("AsipClimate", "ATmega2560"), 0);
    EXPECT_EQ(version("AsipClimate", "ATmega168"), 0);
    EXPECT_EQ(version("AsipClimate", "ESP32"), 0);
    EXPECT_EQ(version("AsipServices"), 0) << "it is listed, and not there";
    EXPECT_EQ(version("Mine"), 4);
    EXPECT_EQ(version("broken"), 0);
    EXPECT_EQ(version(""), 0);
}

TEST_F(LoaderTest, AgentEndsMeanwhile_AvrdudeEndsWithIt) {
    {
        Loader loader(io_, order(program("echo $$ >" + folder_.file("pid") + "; exec sleep 600")), {});
        test::run_until(io_, [this] { return !read("pid").empty(); });
    }
    EXPECT_NE(::kill(std::stoi(read("pid")), 0), 0);
}

}  // namespace
}  // namespace asip::agent
