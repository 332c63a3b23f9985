#include "cli/commands/completion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace asip::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class CompletionTest : public ::testing::Test {
  protected:
    /// Completes the last of `words`.
    std::vector<std::string> last(const std::vector<std::string>& words) {
        return complete(words, words.size() - 1, commands_, names_);
    }

    std::vector<CommandShape> commands_{
        {"list", {"--watch", "-w", "--state", "-o", "--output"}, {"--state", "-o", "--output"}},
        {"send", {"--raw", "--no-wait"}, {"--raw"}},
        {"show", {}, {}},
        {"pin", {}, {}}};
    int asked_ = 0;
    NameSources names_{
        [this] {
            ++asked_;
            return std::vector<std::string>{"uno2", "uno1", "nano"};
        },
        [](const std::string& board) {
            return board == "uno1" ? std::vector<std::string>{"servo", "io"} : std::vector<std::string>{};
        },
        [](const std::string& board, const std::string& service) {
            return board == "uno1" && service == "servo" ? std::vector<std::string>{"write", "remap"}
                                                         : std::vector<std::string>{};
        }};
};

TEST_F(CompletionTest, FirstWord_IsASubcommand) {
    EXPECT_THAT(last({"s"}), ElementsAre("send", "show"));
    EXPECT_THAT(last({""}), ElementsAre("list", "pin", "send", "show"));
    EXPECT_THAT(last({"x"}), IsEmpty());
    EXPECT_EQ(asked_, 0) << "the bus is asked only for names";
}

TEST_F(CompletionTest, Options_AndTheirValues) {
    EXPECT_THAT(last({"list", "--s"}), ElementsAre("--state"));
    EXPECT_THAT(last({"list", "--state", "o"}), ElementsAre("offline", "online"));
    EXPECT_THAT(last({"list", "-o", "json"}), ElementsAre("json", "jsonl"));
    EXPECT_THAT(last({"list", "-o", "json", ""}), ElementsAre("boards", "services"));
}

TEST_F(CompletionTest, BoardsServicesAndCommands_AreLive) {
    EXPECT_THAT(last({"show", "u"}), ElementsAre("uno1", "uno1/", "uno2", "uno2/"));
    EXPECT_THAT(last({"send", "u"}), ElementsAre("uno1/", "uno2/"));
    EXPECT_THAT(last({"send", "uno1/"}), ElementsAre("uno1/io", "uno1/servo"));
    EXPECT_THAT(last({"send", "--no-wait", "uno1/servo", "w"}), ElementsAre("write"));
    EXPECT_THAT(last({"send", "uno1/servo", "write", ""}), IsEmpty());
    EXPECT_THAT(last({"pin", "n"}), ElementsAre("nano"));
    EXPECT_THAT(last({"pin", "nano", "13", "h"}), ElementsAre("high"));
}

TEST_F(CompletionTest, CursorBeyondTheWords_CompletesAnEmptyOne) {
    EXPECT_THAT(complete({"pin"}, 1, commands_, names_), ElementsAre("nano", "uno1", "uno2"));
    EXPECT_THAT(complete({}, 0, commands_, names_), ElementsAre("list", "pin", "send", "show"));
    EXPECT_THAT(complete({}, 3, commands_, names_), IsEmpty());
}

TEST(CompletionScript, EachShell_HasItsOwn) {
    EXPECT_THAT(completion_script("bash"), HasSubstr("complete -o default -F _asipctl asipctl"));
    EXPECT_THAT(completion_script("zsh"), HasSubstr("#compdef asipctl"));
}

}  // namespace
}  // namespace asip::cli
