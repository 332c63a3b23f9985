// SPDX-License-Identifier: Apache-2.0
// What is no token, and so is written into no file.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

#include "asip/program/exit_status.hpp"
#include "gateway/application.hpp"
#include "gateway/replaced_file.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::gateway {
namespace {

class MakeToken : public testing::Test {
  protected:
    TokenRequest request(const std::string& role, const std::string& name) const {
        TokenRequest result;
        result.role = role;
        result.name = name;
        result.file = file_;
        return result;
    }
    void expect_refused(const TokenRequest& request) {
        EXPECT_EQ(make_token(request), program::kExitUsage) << request.name;
        EXPECT_FALSE(std::filesystem::exists(file_)) << request.name;
    }

    test::TempDir folder_;
    std::string file_ = folder_.file("tokens");
};

TEST_F(MakeToken, NameThatIsNoneOrReserved_IsRefusedAndWritesNothing) {
    for (const std::string& name :
         {std::string("x y"), std::string(), "a " + std::string(64, '0') + "\nadmin b",
          std::string("loopback"), std::string("anonymous"), std::string("nobody")})
        expect_refused(request("viewer", name));
}

TEST_F(MakeToken, PatternThatNoNameIsLike_IsRefusedAndWritesNothing) {
    for (const std::string pattern : {"uno 1", "uno1 boards=*", "a\nadmin", "k\u00fcche", ""}) {
        auto boards = request("viewer", "hall");
        boards.boards = {"uno*", pattern};
        expect_refused(boards);
        auto services = request("viewer", "hall");
        services.services = {pattern};
        expect_refused(services);
    }
    auto frames = request("kiosk", "hall");
    frames.boards = {"uno1"};
    frames.frames = {"https://a.example boards=*"};
    expect_refused(frames);
}

TEST_F(MakeToken, BlanksAroundNames_AreNoneOfThem) {
    auto hall = request("viewer", "hall");
    hall.boards = {"uno*", " leo1"};
    hall.services = {" servo ", "io"};
    ASSERT_EQ(make_token(hall), program::kExitOk);
    std::ifstream in(file_);
    const std::string text((std::istreambuf_iterator<char>(in)), {});
    EXPECT_THAT(text, testing::HasSubstr(" boards=uno*,leo1 services=servo,io\n"));
}

TEST_F(MakeToken, FileThatTwoReplaceAtOnce_IsAlwaysWhole) {
    const std::string whole(64 << 10, 'x');
    std::vector<std::thread> writers;
    for (int i = 0; i < 4; ++i)
        writers.emplace_back([&] {
            for (int round = 0; round < 50; ++round)
                EXPECT_TRUE(replace_file(file_, whole));
        });
    for (auto& writer : writers)
        writer.join();
    EXPECT_EQ(std::filesystem::file_size(file_), whole.size());
}

}  // namespace
}  // namespace asip::gateway
