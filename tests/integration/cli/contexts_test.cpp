// SPDX-License-Identifier: Apache-2.0
// Buses by name, and completion for fish.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/integration/cli/bus_fixture.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class ContextsTest : public BusTest {
  protected:
    Finished with_contexts(const Words& arguments, std::map<std::string, std::string> more = {}) const {
        more["XDG_CONFIG_HOME"] = folder_.path();
        return run(program(arguments), more);
    }

    TempDir folder_;
};

TEST_F(ContextsTest, NamedBus_IsReachedByItsNameAndByDefault) {
    announce("uno1");
    EXPECT_EQ(with_contexts({"context", "add", "here", broker_.address(), "--timeout", "20s"}).status, 0);
    EXPECT_EQ(with_contexts({"context", "add", "away", "127.0.0.1:1"}).status, 0);
    EXPECT_EQ(with_contexts({"--context", "here", "list", "--from-bus", "-o", "name"}).output, "uno1\n");
    EXPECT_EQ(with_contexts({"context", "use", "away"}).status, 0);
    EXPECT_EQ(with_contexts({"list"}).status, 3);
    EXPECT_EQ(with_contexts({"list", "--from-bus", "-o", "name"}, environment()).output, "uno1\n")
        << "the environment names another";
    EXPECT_EQ(with_contexts({"context", "-o", "name"}).output, "away\nhere\n");
    EXPECT_THAT(with_contexts({"context"}).output, HasSubstr("away     127.0.0.1:1"));
    const auto contexts = nlohmann::json::parse(with_contexts({"context", "list", "-o", "json"}).output);
    EXPECT_EQ(contexts[0]["current"], true);
    EXPECT_EQ(with_contexts({"context", "remove", "away"}).status, 0);
    EXPECT_EQ(with_contexts({"context", "-o", "name"}).output, "here\n");
}

TEST_F(ContextsTest, WrongUse_IsRefusedWithWhatToWrite) {
    EXPECT_EQ(with_contexts({"context", "add"}).status, 2);
    EXPECT_THAT(with_contexts({"context", "add", "lab"}).errors,
                HasSubstr("asipctl context add NAME ADDRESS"));
    EXPECT_EQ(with_contexts({"context", "add", "lab", "http://x"}).status, 2);
    EXPECT_EQ(with_contexts({"context", "add", "a b", "lab"}).status, 2);
    const auto unknown = with_contexts({"--context", "lab", "list"});
    EXPECT_EQ(unknown.status, 2);
    EXPECT_THAT(unknown.errors, HasSubstr("there is no context \"lab\""));
    EXPECT_EQ(with_contexts({"context", "use", "lab"}).status, 1);
}

TEST_F(ContextsTest, FishScript_CompletesInFish) {
    if (run({"fish", "-c", "true"}).status != 0) GTEST_SKIP() << "fish is not installed";
    announce("uno1");
    const auto completed = [this](const std::string& line) {
        auto variables = environment();
        variables["HOME"] = folder_.path();
        return run({"fish", "-c",
                    "set -p PATH " ASIP_PROGRAMS "; asipctl completion fish | source; complete -C '" + line +
                        "'"},
                   variables)
            .output;
    };
    EXPECT_EQ(completed("asipctl sub"), "subscribe\n");
    EXPECT_EQ(completed("asipctl list --state o"), "offline\nonline\n");
    EXPECT_THAT(completed("asipctl show u"), StartsWith("uno1\n"));
}

}  // namespace
}  // namespace asip::test
