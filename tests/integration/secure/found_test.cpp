// SPDX-License-Identifier: Apache-2.0
// What asipctl secure finds in its folder: files that are lost or do not fit, links, loose modes, other
// masks.
#include <sys/stat.h>

#include <filesystem>

#include "tests/integration/secure/secured_bus.hpp"

namespace asip::test {
namespace {

namespace fs = std::filesystem;

using FoundBus = SecuredBus;

TEST_F(FoundBus, CertificateOfAnotherKey_IsMadeAnewByInit) {
    add({"board", "uno1"});
    ASSERT_EQ(run({"openssl", "ecparam", "-name", "prime256v1", "-genkey", "-noout", "-out",
                   file("broker/broker.key")})
                  .status,
              0);
    const auto made = secure({"init"});
    EXPECT_EQ(made.status, 0) << made.errors;
    EXPECT_NE(made.output.find("it belongs to another key"), std::string::npos) << made.output;
    start_broker();
    EXPECT_TRUE(may_publish("uno1", "asip/uno1/out")) << broker_log();
}

TEST_F(FoundBus, LostCertificateOfTheAuthority_IsMadeForItsKeySoThatFilesGivenOutStayGood) {
    add({"board", "uno1"});
    const auto key = run({"cat", file("ca.key")}).output;
    fs::remove(file("ca.crt"));
    EXPECT_EQ(secure({"init"}).status, 0);
    EXPECT_EQ(run({"cat", file("ca.key")}).output, key) << "a private key is never made anew";
    start_broker();
    EXPECT_TRUE(may_publish("uno1", "asip/uno1/out")) << broker_log();
}

TEST_F(FoundBus, LostKeyOfTheAuthority_IsNotReplaced) {
    fs::remove(file("ca.key"));
    const auto refused = secure({"init"});
    EXPECT_EQ(refused.status, 1);
    EXPECT_NE(refused.errors.find("put it back"), std::string::npos) << refused.errors;
    fs::remove(file("ca.crt"));
    EXPECT_EQ(secure({"init"}).status, 1) << "with both, every file given out would be void";
}

TEST_F(FoundBus, SecretsThatOthersCanRead_AreClosed) {
    add({"operator", "ann"});
    for (const char* name :
         {"ca.key", "broker/broker.key", "broker/passwords", "broker/rules.acl", "bus.json"})
        ASSERT_EQ(::chmod(file(name).c_str(), 0644), 0);
    ASSERT_EQ(::chmod(file("credentials").c_str(), 0755), 0);
    ASSERT_EQ(secure({"init"}).status, 0);
    const auto mode = [&](const char* name) {
        struct stat status{};
        EXPECT_EQ(::stat(file(name).c_str(), &status), 0) << name;
        return status.st_mode & 0777;
    };
    for (const char* name :
         {"ca.key", "broker/broker.key", "broker/passwords", "broker/rules.acl", "bus.json"})
        EXPECT_EQ(mode(name), 0600U) << name;
    EXPECT_EQ(mode("credentials"), 0700U);
}

TEST_F(FoundBus, FolderInWhichOthersMayWrite_IsRefused) {
    ASSERT_EQ(::chmod(folder().c_str(), 0777), 0);
    const auto refused = secure({"add", "board", "uno1"});
    EXPECT_EQ(refused.status, 1);
    EXPECT_NE(refused.errors.find("chmod go-w"), std::string::npos) << refused.errors;
}

TEST_F(FoundBus, FolderThatIsALinkElsewhere_IsNotFollowed) {
    TempDir elsewhere;
    fs::remove_all(file("credentials"));
    fs::create_directory_symlink(elsewhere.path(), file("credentials"));
    EXPECT_EQ(secure({"add", "board", "uno1"}).status, 1);
    EXPECT_TRUE(fs::is_empty(elsewhere.path()));
}

TEST_F(FoundBus, LinksInPlaceOfFiles_AreReplacedAndNotWrittenThrough) {
    const auto outside = place_.write("outside", "untouched");
    for (const char* name :
         {"credentials/uno1.credentials.new", "broker/passwords", "broker/passwords.new"}) {
        fs::remove(file(name));
        fs::create_symlink(outside, file(name));
    }
    ASSERT_EQ(secure({"add", "board", "uno1"}).status, 0);
    EXPECT_EQ(run({"cat", outside}).output, "untouched");
    EXPECT_FALSE(fs::is_symlink(file("broker/passwords")));
    start_broker();
    EXPECT_TRUE(may_publish("uno1", "asip/uno1/out"));
}

TEST_F(FoundBus, CommandForTheBroker_CanBeRunAsItIsPrinted) {
    const auto init = [&](const std::string& path, const std::string& folder) {
        return run({"/usr/bin/env", "PATH=" + path, ASIP_TEST_ASIPCTL, "secure", "init", "--host",
                    "localhost", "--port", std::to_string(port()), "--dir", place_.file(folder)})
            .output;
    };
    const auto command = "/mosquitto -c " + place_.file("a") + "/mosquitto.conf";
    EXPECT_NE(init("/usr/bin:/bin", "a").find("/usr/sbin" + command), std::string::npos)
        << "as it is for users who are not root";
    EXPECT_EQ(init("/bin:/usr/sbin", "b").find("/usr/sbin/mosquitto"), std::string::npos);
    start_broker();
    const auto beside = init("/usr/bin", "c");
    EXPECT_NE(beside.find("port " + std::to_string(port()) + " of this machine is in use"), std::string::npos)
        << beside;
    EXPECT_EQ(secure({"init"}).output.find("in use"), std::string::npos) << "its own broker";
}

TEST_F(FoundBus, MaskOfTheShell_ChangesNothing) {
    for (const char* mask : {"000", "077", "777"}) {
        const auto where = place_.file(std::string("masked") + mask);
        const auto made =
            run({"sh", "-c",
                 std::string("umask ") + mask +
                     "; exec '" ASIP_TEST_ASIPCTL "' secure init --host localhost --dir '" + where + "'"});
        ASSERT_EQ(made.status, 0) << made.errors;
        struct stat status{};
        ASSERT_EQ(::stat((where + "/ca.key").c_str(), &status), 0);
        EXPECT_EQ(status.st_mode & 0777, 0600U) << mask;
        ASSERT_EQ(::stat((where + "/mosquitto.conf").c_str(), &status), 0);
        EXPECT_EQ(status.st_mode & 0777, 0644U) << mask;
        ASSERT_EQ(::stat((where + "/broker").c_str(), &status), 0);
        EXPECT_EQ(status.st_mode & 0777, 0700U) << mask;
    }
}

TEST_F(FoundBus, NamesThatAreNone_AreRefusedAndChangeNothing) {
    const auto before =
        run({"sh", "-c", "cd '" + folder() + "' && find . -type f | sort | xargs sha256sum"}).output;
    for (const char* name :
         {"../x", "a\nuser admin", "a:b", "#", "+", "$x", "in", "out", "error", "reply", "", "a b"})
        EXPECT_NE(secure({"add", "board", name}).status, 0) << name;
    for (const char* name : {"a/b", "../../x", "/etc/x", "a+b", "a#", "a\tb", "a b", "\u00e4nn", "\u0430nn",
                             "%u", "a'b", "$(id)", "reply", "broker"})
        EXPECT_EQ(secure({"add", "operator", name}).status, 2) << name;
    EXPECT_NE(secure({"init", "--host", "a,DNS:evil"}).status, 0);
    EXPECT_EQ(run({ASIP_TEST_ASIPCTL, "secure", "init", "--dir", place_.file("a\nb")}).status, 2);
    EXPECT_EQ(
        run({ASIP_TEST_ASIPCTL, "secure", "init", "--dir", place_.file("c"), "--topic-root", "a%u"}).status,
        2);
    EXPECT_EQ(run({"sh", "-c", "cd '" + folder() + "' && find . -type f | sort | xargs sha256sum"}).output,
              before);
}

}  // namespace
}  // namespace asip::test
