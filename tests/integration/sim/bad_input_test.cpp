// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>

#include "sim_program.hpp"

namespace asip::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// What asip-sim says of it, in one line; it has to end with status 2.
std::string refusal(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {ASIP_SIM, "--no-socket"});
    const auto done = run(arguments);
    EXPECT_EQ(done.status, 2);
    EXPECT_EQ(std::count(done.errors.begin(), done.errors.end(), '\n'), 1) << done.errors;
    return done.errors;
}

TEST(BadInput, BoardFileThatIsNotThere) {
    EXPECT_EQ(refusal({"/nowhere/uno.json"}),
              "asip-sim: /nowhere/uno.json: cannot read the board file: No such file or directory\n");
}

TEST(BadInput, MissingImage_NamesBoardFileAndImage) {
    const TempDir folder;
    const auto file = folder.write("uno.json", R"({"image": "gone.elf"})");
    EXPECT_EQ(refusal({file}), "asip-sim: " + file + ": " + folder.file("gone.elf") +
                                   ": cannot read the firmware image: No such file or directory\n");
}

TEST(BadInput, LinkThatIsSomethingElse_IsNotReplaced) {
    const TempDir folder;
    const auto precious = folder.write("precious", "keep me");
    EXPECT_THAT(refusal({board_file(folder, "uno.json"), "--link", precious}), HasSubstr("exists already"));
    EXPECT_EQ(std::filesystem::file_size(precious), 7u);
}

TEST(BadInput, TwoBoardsWithOneName) {
    const TempDir folder;
    const auto file = board_file(folder, "uno.json");
    EXPECT_THAT(refusal({file, file}), HasSubstr("another board is called uno too"));
}

TEST(BadInput, TcpPortInUse_Refused) {
    const TempDir folder;
    const auto file = board_file(folder, "uno.json");
    SimProgram sim(folder, {file, "--tcp", "0"});
    EXPECT_THAT(refusal({file, "--tcp", std::to_string(sim.tcp_port())}),
                HasSubstr("cannot listen on 127.0.0.1:"));
}

TEST(BadInput, WrongOptions_StatusTwo) {
    EXPECT_EQ(run({ASIP_SIM}).status, 2);
    EXPECT_EQ(run({ASIP_SIM, "--no-such-option"}).status, 2);
    EXPECT_EQ(run({ASIP_SIM, "a.json", "--slice", "1"}).status, 2);
    EXPECT_EQ(run({ASIP_SIM, "ctl"}).status, 2);
}

TEST(Options, FromEnvironmentAndFile_AreChecked) {
    const TempDir folder;
    const auto slice = run({"env", "ASIP_SLICE=1", ASIP_SIM, "a.json"});
    EXPECT_EQ(slice.status, 2);
    EXPECT_THAT(slice.errors, HasSubstr("ASIP_SLICE"));
    const auto config = folder.write("asip.conf", "thread = 2\n");
    const auto file = run({ASIP_SIM, "a.json", "--config", config});
    EXPECT_EQ(file.status, 2);
    EXPECT_THAT(file.errors,
                HasSubstr("asip.conf:1: there is no option \"thread\" (did you mean \"threads\"?)"));
}

TEST(Help, ShowsExamplesAndExitStatuses) {
    const auto help = run({ASIP_SIM, "--help"});
    EXPECT_EQ(help.status, 0);
    EXPECT_THAT(help.output, HasSubstr("asip-sim uno.json mega.json --json"));
    EXPECT_THAT(help.output, HasSubstr("ASIP_THREADS"));
    EXPECT_THAT(help.output, HasSubstr("Exit status"));
    EXPECT_EQ(run({ASIP_SIM, "--version"}).status, 0);
    EXPECT_EQ(run({ASIP_SIM, "ctl", "--help"}).status, 0);
}

}  // namespace
}  // namespace asip::test
