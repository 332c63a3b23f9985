// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mosquitto.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>
#include <sys/stat.h>

#include <fstream>
#include <memory>
#include <sstream>

#include "asip/program/credentials.hpp"
#include "cli/secure/bus_file.hpp"
#include "cli/secure/certificate.hpp"
#include "cli/secure/folder.hpp"
#include "cli/secure/leftovers.hpp"
#include "cli/secure/secrets.hpp"
#include "cli/secure/topic_rules.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

SecuredBus a_bus() {
    SecuredBus bus;
    bus.hosts = {"pi.local", "fe::1"};
    bus.configuration = "/etc/mosquitto/conf.d/asip-secured.conf";
    for (const auto& [name, role] : std::vector<std::pair<std::string, Role>>{
             {"admin", Role::kAdmin}, {"uno1", Role::kBoard}, {"ann", Role::kOperator}})
        bus.users.push_back({name, role, mosquitto_hash("of-" + name, "salt"), "2026-11-21T00:00:00.000Z"});
    return bus;
}

std::string shipped(const std::string& name) {
    std::ifstream file(ASIP_TEST_PACKAGING "/mosquitto/" + name);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

TEST(SecureRoles, EachRole_IsReadBackFromItsName) {
    for (const auto role :
         {Role::kBoard, Role::kOperator, Role::kViewer, Role::kRegistry, Role::kGateway, Role::kAdmin})
        EXPECT_EQ(parse_role(name_of(role)), role) << name_of(role);
    EXPECT_EQ(parse_role("king"), std::nullopt);
    EXPECT_EQ(parse_role(""), std::nullopt);
}

TEST(SecureRoles, NamesThatWouldChangeTheRules_AreRefused) {
    for (const char* name : {"", "a b", "a/b", "+", "#", "$x", "a:b", "a\nuser admin", "servicebus", "reply",
                             "broker", "registry", "export", "in", "out", "error", "set"}) {
        for (const auto role : {Role::kOperator, Role::kBoard, Role::kGateway})
            EXPECT_NE(explain_user_name(name, role), "") << name;
    }
    EXPECT_EQ(explain_user_name("ann", Role::kOperator), "");
    EXPECT_EQ(explain_user_name("uno_1.left", Role::kBoard), "");
    EXPECT_EQ(explain_user_name("registry", Role::kRegistry), "");
}

TEST(SecureRoles, Boards_NeedNoLineOfTheirOwn) {
    const std::vector<RoleOfUser> few{{"ann", Role::kOperator}};
    auto many = few;
    for (int i = 0; i < 1000; ++i)
        many.push_back({"b" + std::to_string(i), Role::kBoard});
    EXPECT_EQ(access_rules("asip", many), access_rules("asip", few));
}

TEST(SecureRoles, OtherTopicRoot_LeavesNoTraceOfTheDefault) {
    const auto rules = access_rules("house/1", {{"ann", Role::kOperator}, {"registry", Role::kRegistry}});
    EXPECT_THAT(rules, HasSubstr("pattern write house/1/%u/out\n"));
    EXPECT_THAT(rules, Not(HasSubstr(" asip/")));
}

TEST(SecureRoles, Person_IsDeniedTheBoardThatIsCalledLikeIt) {
    for (const auto role : {Role::kOperator, Role::kViewer, Role::kGateway}) {
        const auto rules = access_rules("asip", {{"ann", role}});
        EXPECT_THAT(rules, HasSubstr("user ann\ntopic deny asip/servicebus/ann/#\ntopic deny asip/ann/#\n"
                                     "topic deny asip/reply/+/ann/#\n"));
    }
}

TEST(SecureRoles, ViewerAndRegistry_HaveNoLineThatCommands) {
    for (const auto role : {Role::kViewer, Role::kRegistry}) {
        const auto rules = access_rules("asip", {{"bob", role}});
        EXPECT_THAT(rules.substr(rules.find("user bob")), Not(HasSubstr("/in\n")));
        EXPECT_THAT(rules.substr(rules.find("user bob")), Not(HasSubstr("$stop")));
    }
}

TEST(SecureRoles, OperatorOfSomeBoards_HasTheLinesOfAViewerAndThoseOfItsBoards) {
    const auto of = [](Role role, SomeBoards boards) {
        const auto rules = access_rules("asip", {{"bob", role, std::move(boards)}});
        return rules.substr(rules.find("user bob"));
    };
    auto rules = of(Role::kOperator, {{"uno1"}});
    for (const std::string line : {"topic write asip/uno1/+/in\n", "topic write asip/uno1/$stop\n"}) {
        ASSERT_THAT(rules, HasSubstr(line));
        rules.erase(rules.find(line), line.size());
    }
    EXPECT_EQ(rules, of(Role::kViewer, {}));
    EXPECT_EQ(of(Role::kOperator, std::set<std::string>()), of(Role::kViewer, {})) << "its boards are gone";
}

TEST(SecureRoles, Nobody_WritesWhereNoRuleCanTellTheSender) {
    const auto rules = access_rules("asip", {{"ann", Role::kOperator}, {"registry", Role::kRegistry}});
    EXPECT_THAT(rules, Not(HasSubstr("write asip/servicebus\n")));
    EXPECT_THAT(rules, Not(HasSubstr("write asip/reply/#\n")));
}

TEST(SecureRoles, WhatAUserLeft_IsAllOfItAndNothingOfOthers) {
    const std::vector<std::string> retained{"asip/servicebus/uno1/$state",
                                            "asip/servicebus/uno1/$demand/ann/c1",
                                            "asip/servicebus/uno11/$state",
                                            "asip/servicebus/uno2/$demand/uno1/c1",
                                            "asip/uno1/io/out",
                                            "asip/uno11/out",
                                            "asip/reply/ann/uno1/c1",
                                            "asip/reply/uno1/$self/c1",
                                            "asip/servicebus/uno2/$description",
                                            "asip/uno2/$link/ann/c1"};
    const auto left_by = [&retained](const std::string& user) {
        std::vector<std::string> left;
        for (const auto& topic : retained)
            for (const auto& filter : filters_of(bus::Topics(), user)) {
                bool matches = false;
                mosquitto_topic_matches_sub(filter.c_str(), topic.c_str(), &matches);
                if (!matches) continue;
                left.push_back(topic);
                break;
            }
        return left;
    };
    EXPECT_THAT(left_by("uno1"), ::testing::ElementsAre(retained[0], retained[1], retained[3], retained[4],
                                                        retained[6], retained[7]));
    EXPECT_THAT(left_by("ann"), ::testing::ElementsAre(retained[1], retained[6], retained[9]));
    EXPECT_THAT(left_by("bob"), ::testing::IsEmpty());
}

TEST(SecureFiles, Reserve_RaisesTheLimitThatIsThere_AndChangesNothingElse) {
    EXPECT_EQ(with_reserve("a 1\nmemory_limit 1000\nb 2\n"), "a 1\nmemory_limit 67109864\nb 2\n");
    for (const std::string other : {"", "a 1\n", "# memory_limit 5\n", "a\nmemory_limit x\n"})
        EXPECT_EQ(with_reserve(other), other);
}

/// Commands say nowhere whose they are: then it is said that they are there.
TEST(SecureRoles, WhatStandsUnderNobodysName_IsNamedForRolesThatMayHaveLeftIt) {
    const std::vector<Retained> retained{{"asip/uno1/in", "#,R"},
                                         {"asip/servicebus/uno1/$demand/bob/c1", "{}"},
                                         {"asip/uno1/$link/ann/c1", "{}"},
                                         {"asip/registry/forget", "{}"},
                                         {"asip/registry/hall/$stats", "{}"},
                                         {"asip/export/ha/$lease", "{}"},
                                         {"homeassistant/device/uno1/config", "{}"},
                                         {"asip/export/dashboard/lab", "{}"}};
    const auto of = [&](Role role) { return unnamed_of(bus::Topics(), retained, role); };
    EXPECT_EQ(of(Role::kOperator), "2 commands");
    EXPECT_EQ(of(Role::kGateway), "2 commands, 2 exports");
    EXPECT_EQ(of(Role::kHomeAssistant), "2 commands, 2 exports");
    EXPECT_EQ(of(Role::kRegistry), "1 message of a registry that is gone");
    EXPECT_EQ(of(Role::kAdmin), "2 commands, 2 exports, 1 message of a registry that is gone");
    EXPECT_EQ(of(Role::kBoard), "");
    EXPECT_EQ(of(Role::kViewer), "");
}

/// `+` in place of a board would match the levels at which the bus has other things.
TEST(SecureRoles, Commanders_HaveNoLineBesideBoards) {
    for (const auto role : {Role::kOperator, Role::kGateway}) {
        const auto rules = access_rules("r", {{"ann", role}});
        for (const char* level : {"servicebus", "registry", "reply", "export"})
            for (const char* topic : {"/in", "/$stop", "/+/in"})
                EXPECT_THAT(rules, ::testing::HasSubstr("topic deny r/" + std::string(level) + topic + "\n"));
    }
    EXPECT_THAT(access_rules("r", {{"registry", Role::kRegistry}}),
                ::testing::Not(::testing::HasSubstr("/#\n")))
        << "a registry writes on the topics of the table alone";
}

TEST(SecureRoles, ShippedRules_AreThoseOfTheRoles) {
    EXPECT_EQ(shipped("asip-secured.acl"), access_rules("asip", {{"registry", Role::kRegistry},
                                                                 {"gateway", Role::kGateway},
                                                                 {"operator", Role::kOperator},
                                                                 {"viewer", Role::kViewer},
                                                                 {"admin", Role::kAdmin}}));
}

TEST(SecureBusFile, ShippedConfiguration_IsTheOneThatIsMade) {
    EXPECT_EQ(shipped("asip-secured.conf"),
              broker_configuration({.passwords = "/etc/mosquitto/asip.passwords",
                                    .rules = "/etc/mosquitto/asip-secured.acl",
                                    .certificate = "/etc/mosquitto/certs/asip-broker.crt",
                                    .key = "/etc/mosquitto/certs/asip-broker.key",
                                    .store = "",
                                    .pid_file = "",
                                    .port = 8883,
                                    .local_port = 1883}));
}

TEST(SecureBusFile, WrittenAndRead_IsTheSame) {
    auto bus = a_bus();
    bus.users.push_back(bus.users.back());
    bus.users.back().name = "eve";
    bus.users.back().boards = std::set<std::string>{"uno1"};
    bus.users.back().selector = "class=4b";
    const auto read = read_bus(write_bus(bus));
    ASSERT_TRUE(read) << read.error();
    EXPECT_EQ(write_bus(*read), write_bus(bus));
    EXPECT_EQ(password_lines(*read), password_lines(bus));
    EXPECT_EQ(rule_lines(*read), rule_lines(bus));
}

TEST(SecureBusFile, DamagedFile_IsRefusedAndGivesNobodyAccess) {
    auto bus = a_bus();
    bus.users.back().boards = std::set<std::string>{"b1"};
    const auto good = write_bus(bus);
    const auto with = [&good](const std::string& what, const std::string& other) {
        auto text = good;
        text.replace(text.find(what), what.size(), other);
        return read_bus(text);
    };
    EXPECT_TRUE(read_bus(good));
    EXPECT_FALSE(read_bus(""));
    EXPECT_FALSE(read_bus("[]"));
    EXPECT_FALSE(read_bus(good.substr(0, good.size() / 2)));
    EXPECT_FALSE(with("\"version\": 1", "\"version\": 2"));
    EXPECT_FALSE(with("\"operator\"", "\"king\""));
    EXPECT_FALSE(with("\"ann\"", "\"ann\\nuser x\""));
    EXPECT_FALSE(with("\"b1\"", "\"+\""));
    EXPECT_FALSE(with("\"b1\"", "\"reply\""));
    EXPECT_FALSE(with("\"boards\": [", "\"boards\": 1, \"x\": ["));
    EXPECT_FALSE(with("$7$", "plain"));
    EXPECT_FALSE(with("8883", "88830"));
    EXPECT_FALSE(with("\"asip\"", "\"#\""));
}

TEST(SecureBusFile, Credentials_AreReadByThePrograms) {
    const auto bus = a_bus();
    const std::string authority = "-----BEGIN CERTIFICATE-----\nabc\n-----END CERTIFICATE-----\n";
    const auto text = credentials_text(bus, bus.users[1], "secret=", authority);
    const auto read = program::parse_credentials(text, "uno1.credentials");
    ASSERT_TRUE(read) << read.error();
    EXPECT_THAT(read->brokers, ::testing::ElementsAre("mqtts://pi.local:8883", "mqtts://[fe::1]:8883"));
    EXPECT_EQ(read->user, "uno1");
    EXPECT_EQ(read->password, "secret=");
    EXPECT_EQ(read->name, "uno1");
    EXPECT_EQ(read->topic_root, "asip");
    EXPECT_TRUE(read->certificate);
    EXPECT_EQ(program::parse_credentials(credentials_text(bus, bus.users[2], "x", ""), "f")->name, "")
        << "only boards are given a name";
}

TEST(SecureSecrets, Hash_IsWhatMosquittoReads) {
    EXPECT_EQ(mosquitto_hash("pw", "salt12345678"),
              "$7$1$c2FsdDEyMzQ1Njc4$OeLfxvUtNjHPa+qfS9kTpW0ji2juoGD6ereaAFKArdGldWL/"
              "0vCmHj6LHkFbPU2anyKVdFdhu+zJbAIJ8nQ1/g==");
}

TEST(SecureSecrets, Passwords_DifferAndNeedNoQuoting) {
    const auto one = random_password();
    EXPECT_EQ(one.size(), 43U);
    EXPECT_NE(one, random_password());
    EXPECT_EQ(one.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_"),
              std::string::npos);
}

class SecureCertificate : public ::testing::Test {
  protected:
    using Certificate = std::unique_ptr<X509, decltype(&X509_free)>;

    static Certificate read(const std::string& pem) {
        BIO* bio = BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size()));
        Certificate made(PEM_read_bio_X509(bio, nullptr, nullptr, nullptr), &X509_free);
        BIO_free(bio);
        return made;
    }
    CertificateTime now_ = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
    CertificateAndKey authority_ = make_authority(now_).value();
};

TEST_F(SecureCertificate, Broker_IsSignedByTheAuthorityForItsNamesOnly) {
    const auto made = make_broker_certificate(authority_, {"pi.local", "192.168.1.10", "::1"}, now_);
    ASSERT_TRUE(made) << made.error();
    const auto broker = read(made->certificate);
    const auto authority = read(authority_.certificate);
    EXPECT_EQ(X509_verify(broker.get(), X509_get0_pubkey(authority.get())), 1);
    EXPECT_EQ(X509_check_issued(authority.get(), broker.get()), X509_V_OK);
    EXPECT_EQ(X509_check_host(broker.get(), "pi.local", 0, 0, nullptr), 1);
    EXPECT_EQ(X509_check_ip_asc(broker.get(), "192.168.1.10", 0), 1);
    EXPECT_EQ(X509_check_ip_asc(broker.get(), "::1", 0), 1);
    EXPECT_NE(X509_check_host(broker.get(), "other.local", 0, 0, nullptr), 1);
    EXPECT_NE(X509_check_ip_asc(broker.get(), "192.168.1.11", 0), 1);
    EXPECT_EQ(X509_check_ca(broker.get()), 0);
    EXPECT_NE(X509_check_ca(authority.get()), 0);
    EXPECT_NE(X509_check_purpose(broker.get(), X509_PURPOSE_SSL_SERVER, 0), 0);
    EXPECT_EQ(X509_check_purpose(broker.get(), X509_PURPOSE_SSL_CLIENT, 0), 0);
}

TEST_F(SecureCertificate, Ends_InTenAndTwentyYears) {
    const auto made = make_broker_certificate(authority_, {"pi.local"}, now_);
    ASSERT_TRUE(made);
    EXPECT_EQ(end_of(made->certificate), now_ + std::chrono::years(10));
    EXPECT_EQ(end_of(authority_.certificate), now_ + std::chrono::years(20));
    EXPECT_FALSE(end_of("nonsense"));
    EXPECT_LT(X509_cmp_current_time(X509_get0_notBefore(read(made->certificate).get())), 0);
}

TEST_F(SecureCertificate, MadeAfter2038_EndsInTenAndTwentyYears) {
    using namespace std::chrono;
    const CertificateTime now = sys_days(2039y / 3 / 1) + 12h + 34min + 56s;
    const auto authority = make_authority(now);
    ASSERT_TRUE(authority);
    const auto made = make_broker_certificate(*authority, {"pi.local"}, now);
    ASSERT_TRUE(made) << made.error();
    EXPECT_EQ(end_of(made->certificate), now + years(10));
    EXPECT_EQ(end_of(authority->certificate), now + years(20));
}

TEST_F(SecureCertificate, TwoAuthorities_ShareNothing) {
    const auto other = make_authority(now_);
    ASSERT_TRUE(other);
    EXPECT_NE(other->key, authority_.key);
    const auto made = make_broker_certificate(*other, {"pi.local"}, now_);
    ASSERT_TRUE(made);
    EXPECT_NE(
        X509_verify(read(made->certificate).get(), X509_get0_pubkey(read(authority_.certificate).get())), 1);
    EXPECT_FALSE(make_broker_certificate({authority_.certificate, "no key"}, {"pi.local"}, now_));
}

TEST(SecureHosts, NameOrAddress_IsValidAndNothingElse) {
    for (const char* host : {"pi", "pi.local", "192.168.1.10", "fd00::7", "a-b_c"})
        EXPECT_TRUE(valid_host(host)) << host;
    for (const char* host :
         {"", "a b", "pi:8883", "a,DNS:b", "*.local", "mqtts://pi", "-x", ".x", "fe80::1%eth0"})
        EXPECT_FALSE(valid_host(host)) << host;
}

TEST(SecureFolderTest, Secrets_AreReadableByTheirOwnerAlone) {
    const test::TempDir place;
    const auto folder = SecureFolder::create(place.path() / "bus");
    ASSERT_TRUE(folder) << folder.error().text;
    const auto mode = [](const std::filesystem::path& path) {
        struct stat status{};
        EXPECT_EQ(::stat(path.c_str(), &status), 0) << path;
        return status.st_mode & 0777;
    };
    const auto old = ::umask(0);
    EXPECT_EQ(folder->write(folder->key(), "secret", SecureFolder::Readers::kOwner), true);
    EXPECT_EQ(folder->write(folder->authority(), "public", SecureFolder::Readers::kAll), true);
    ASSERT_TRUE(folder->save(a_bus()));
    ::umask(old);
    EXPECT_EQ(mode(folder->key()), 0600U);
    EXPECT_EQ(mode(folder->authority()), 0644U);
    EXPECT_EQ(mode(folder->path() / "bus.json"), 0600U);
    EXPECT_EQ(mode(folder->store()), 0700U);
    EXPECT_EQ(mode(folder->credentials("x").parent_path()), 0700U);
    EXPECT_EQ(folder->write(folder->key(), "secret", SecureFolder::Readers::kOwner), false) << "unchanged";
}

TEST(SecureFolderTest, WithoutInit_SaysWhatToRun) {
    const test::TempDir place;
    const auto folder = SecureFolder::open(place.path() / "nothing");
    ASSERT_FALSE(folder);
    EXPECT_THAT(folder.error().text, HasSubstr("asipctl secure init"));
    EXPECT_FALSE(std::filesystem::exists(place.path() / "nothing"));
}

}  // namespace
}  // namespace asip::cli
