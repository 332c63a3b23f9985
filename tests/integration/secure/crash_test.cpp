// SPDX-License-Identifier: Apache-2.0
// Killed between any two steps, asipctl secure leaves a bus that the same command completes.
#include <sys/stat.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <functional>

#include "tests/integration/secure/secured_bus.hpp"

namespace asip::test {
namespace {

namespace fs = std::filesystem;

class KilledSecure : public SecuredBus {
  protected:
    static constexpr int kMaxSteps = 200;

    KilledSecure() { add({"board", "uno1"}); }
    void SetUp() override {
        if (std::getenv("ASIP_TEST_PROGRAMS") != nullptr)
            GTEST_SKIP() << "a sanitizer has the calls that this one counts";
        fs::copy(folder(), pristine(), fs::copy_options::recursive);
    }
    std::string pristine() const { return place_.file("pristine"); }

    /// For each step of `words`: the bus as it was, the command killed there, and again. `check` is called
    /// after that, with the broker running.
    void kill_at_each_step(const Words& words, const std::function<void(const Finished& again)>& check,
                           bool from_nothing = false) {
        int step = 1;
        for (;; ++step) {
            SCOPED_TRACE("killed at step " + std::to_string(step));
            ASSERT_LT(step, kMaxSteps);
            broker_.reset();
            fs::remove_all(folder());
            if (!from_nothing) fs::copy(pristine(), folder(), fs::copy_options::recursive);
            const auto whole = Words{ASIP_TEST_ASIPCTL, "secure"} + words + Words{"--dir", folder()};
            const auto killed =
                run(whole, {{"LD_PRELOAD", ASIP_TEST_KILL_AT}, {"ASIP_KILL_AT", std::to_string(step)}});
            expect_closed();
            if (killed.status == 0) break;
            ASSERT_EQ(killed.status, 128 + SIGKILL) << killed.errors;
            const auto again = run(whole);
            expect_closed();
            start_broker();
            check(again);
            if (HasFailure()) return;
        }
        EXPECT_GT(step, 10) << "steps are counted";
    }

    void expect_closed() const {
        if (!fs::exists(folder())) return;
        for (const auto& entry : fs::recursive_directory_iterator(folder())) {
            const auto name = entry.path().filename().string();
            const bool open = name.starts_with("ca.crt") || name.starts_with("broker.crt") ||
                              name.starts_with("mosquitto.conf");
            struct stat status{};
            ASSERT_EQ(::stat(entry.path().c_str(), &status), 0);
            EXPECT_TRUE(open || (status.st_mode & 077) == 0) << entry.path();
        }
    }
    bool comes_in(const std::string& credentials_file, const std::string& user,
                  const std::string& password) const {
        return may_connect({"--cafile", credentials_file, "-u", user, "-P", password});
    }
    bool comes_in(const std::string& user) const {
        const auto options = probe_options(user);
        return comes_in(options.ca, user, options.password);
    }
};

TEST_F(KilledSecure, Init_IsCompleted) {
    kill_at_each_step(
        {"init", "--host", "localhost,127.0.0.1", "--port", std::to_string(port())},
        [&](const Finished& again) {
            EXPECT_EQ(again.status, 0) << again.errors;
            EXPECT_TRUE(comes_in("admin")) << broker_log();
        },
        true);
}

TEST_F(KilledSecure, Addition_IsCompleted) {
    kill_at_each_step({"add", "operator", "ann"}, [&](const Finished& again) {
        EXPECT_EQ(again.status, 0) << again.errors;
        EXPECT_TRUE(may_publish("ann", "asip/uno1/in")) << broker_log();
        EXPECT_TRUE(comes_in("uno1"));
    });
}

TEST_F(KilledSecure, Revocation_IsCompletedAndGivesNothingBack) {
    const auto old = probe_options("uno1");
    const auto copy = place_.write("copy", run({"cat", credentials("uno1")}).output);
    kill_at_each_step({"revoke", "uno1"}, [&](const Finished&) {
        EXPECT_FALSE(comes_in(copy, "uno1", old.password));
        EXPECT_FALSE(fs::exists(credentials("uno1")));
        ASSERT_EQ(secure({"add", "board", "uno1"}).status, 0);
        EXPECT_NE(probe_options("uno1").password, old.password);
    });
}

TEST_F(KilledSecure, RenewalOfAUser_IsCompleted) {
    const auto old = probe_options("uno1");
    kill_at_each_step({"renew", "uno1"}, [&](const Finished& again) {
        EXPECT_EQ(again.status, 0) << again.errors;
        EXPECT_TRUE(comes_in("uno1")) << broker_log();
        EXPECT_FALSE(comes_in(credentials("uno1"), "uno1", old.password));
    });
}

TEST_F(KilledSecure, RenewalOfTheBroker_IsCompletedWithItsAddresses) {
    kill_at_each_step({"renew", "broker", "--host", "localhost,other.example"}, [&](const Finished& again) {
        EXPECT_EQ(again.status, 0) << again.errors;
        EXPECT_TRUE(comes_in("uno1")) << broker_log();
        EXPECT_NE(run({"cat", credentials("uno1")}).output.find("other.example"), std::string::npos);
        EXPECT_NE(run({"openssl", "x509", "-noout", "-text", "-in", file("broker/broker.crt")})
                      .output.find("DNS:other.example"),
                  std::string::npos);
    });
}

}  // namespace
}  // namespace asip::test
