// SPDX-License-Identifier: Apache-2.0
#include "gateway/auth/tokens.hpp"

#include <gmock/gmock.h>

#include "gateway/auth/secret.hpp"

namespace asip::gateway {
namespace {

std::string line(const std::string& role, const std::string& name, const std::string& secret,
                 const std::string& more = {}) {
    return role + " " + name + " " + hash_of(secret) + (more.empty() ? "" : " " + more) + "\n";
}

TEST(Tokens, File_EachLineIsAToken) {
    const auto tokens =
        Tokens::parse("# ours\n\n" + line("viewer", "hall", "secret-1") +
                      line("operator+raw", "anna", "secret-2", "boards=uno*,mega services=servo") +
                      line("admin", "root", "secret-3", "until=2026-12-31T00:00:00.000Z"));
    ASSERT_TRUE(tokens) << tokens.error();
    EXPECT_EQ(tokens->find("secret-1")->name, "hall");
    const auto* anna = tokens->find("secret-2");
    ASSERT_NE(anna, nullptr);
    EXPECT_TRUE(anna->may_command());
    EXPECT_TRUE(anna->raw);
    EXPECT_FALSE(anna->may_send_raw()) << "raw lines reach every service";
    EXPECT_FALSE(anna->may_forget());
    EXPECT_TRUE(anna->sees_service("uno7", "servo"));
    EXPECT_FALSE(anna->sees_service("uno7", "distance"));
    EXPECT_FALSE(anna->sees_board("nano"));
    EXPECT_TRUE(tokens->find("secret-3")->may_forget());
    EXPECT_TRUE(tokens->find("secret-3")->until);
}

TEST(Tokens, MayLend_WhereEveryLentBoardIsSeen) {
    for (const auto& [boards, may] : {std::pair("boards=lent-*", true),
                                      {"boards=*", true},
                                      {"boards=uno*,lent-*", true},
                                      {"", true},
                                      {"boards=lent-b*", false},
                                      {"boards=*board", false},
                                      {"boards=lent-board", false},
                                      {"boards=uno*", false},
                                      {"boards=lent-*,uno* services=servo", false}}) {
        const auto tokens = Tokens::parse(line("operator", "anna", "secret", boards));
        ASSERT_TRUE(tokens) << tokens.error();
        EXPECT_EQ(tokens->find("secret")->may_lend(), may) << boards;
    }
}

TEST(Tokens, EmptyPrefixSuffixAndLonger_AreNotTheToken) {
    const std::string secret = "pQ8s7dfK2mXw";
    const auto tokens = Tokens::parse(line("viewer", "hall", secret));
    ASSERT_TRUE(tokens);
    EXPECT_EQ(tokens->find(""), nullptr);
    for (std::size_t i = 1; i < secret.size(); ++i) {
        EXPECT_EQ(tokens->find(secret.substr(0, i)), nullptr) << i;
        EXPECT_EQ(tokens->find(secret.substr(i)), nullptr) << i;
    }
    EXPECT_EQ(tokens->find(secret + "x"), nullptr);
    EXPECT_EQ(tokens->find(secret + std::string(1, '\0')), nullptr);
    EXPECT_EQ(tokens->find(hash_of(secret)), nullptr) << "the hash is not the secret";
    EXPECT_NE(tokens->find(secret), nullptr);
}

TEST(Tokens, WrongLines_AreReportedWithTheirNumber) {
    using testing::HasSubstr;
    EXPECT_THAT(Tokens::parse("viewer hall").error(), HasSubstr("line 1: expected ROLE NAME HASH"));
    EXPECT_THAT(Tokens::parse("\n" + line("viewr", "hall", "x")).error(),
                HasSubstr("line 2: \"viewr\" is not a role"));
    EXPECT_THAT(Tokens::parse(line("viewr", "hall", "x")).error(), HasSubstr("did you mean \"viewer\"?"));
    EXPECT_THAT(Tokens::parse("viewer hall plain-secret").error(), HasSubstr("is not a hash"));
    EXPECT_THAT(Tokens::parse(line("viewer", "a", "x") + line("admin", "a", "y")).error(),
                HasSubstr("a second token is called a"));
    EXPECT_THAT(Tokens::parse(line("viewer", "a", "x", "until=tomorrow")).error(),
                HasSubstr("is not a time"));
    EXPECT_THAT(Tokens::parse(line("viewer", "a", "x", "color=red")).error(), HasSubstr("is none of"));
}

TEST(Tokens, LineOfAToken_ReadsAsWhatItWasMadeFrom) {
    Rights rights;
    rights.role = Role::kKiosk;
    rights.name = "lobby";
    rights.boards = {"uno1"};
    rights.services = {"distance", "servo"};
    rights.frames = {"https://wiki.example"};
    rights.until = text::WallTime(std::chrono::milliseconds(1'800'000'000'000));
    const auto tokens = Tokens::parse(token_line(rights, hash_of("s")));
    ASSERT_TRUE(tokens) << tokens.error();
    rights.token_hash = hash_of("s");
    EXPECT_EQ(*tokens->find("s"), rights);
}

TEST(Secret, Random_IsLongAndDifferentEachTime) {
    const auto a = random_secret(32);
    EXPECT_EQ(a.size(), 43u);
    EXPECT_NE(a, random_secret(32));
    EXPECT_EQ(a.find_first_of("+/="), std::string::npos) << "may stand in an address";
}

TEST(Secret, Hash_IsSha256) {
    EXPECT_EQ(hash_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace asip::gateway
