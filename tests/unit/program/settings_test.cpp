// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <map>

#include "asip/program/exit_status.hpp"
#include "asip/program/options.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::program {
namespace {

using Arguments = std::vector<std::string>;
using Variables = std::map<std::string, std::string>;
using testing::ElementsAre;
using testing::HasSubstr;

/// A program with all shared options and one of its own.
struct Program {
    CLI::App app{"A program"};
    Settings settings{app, "asip-test"};
    BrokerOptions broker;
    LogOptions log;
    std::string serial = "none";
    int count = 1;
    std::string errors;
    std::string output;

    Program() {
        settings.add_broker_options(broker);
        settings.add_log_options(log);
        settings.setting(app.add_option("--serial", serial, "Port"));
        settings.setting(app.add_option("--max-count", count, "Count")->check(CLI::Range(0, 100)));
    }

    std::optional<int> parse(const Arguments& arguments, const Variables& variables = {}) {
        testing::internal::CaptureStderr();
        testing::internal::CaptureStdout();
        const auto status = settings.parse(arguments, [&](const std::string& name) {
            const auto found = variables.find(name);
            return found == variables.end() ? std::nullopt : std::optional(found->second);
        });
        errors = testing::internal::GetCapturedStderr();
        output = testing::internal::GetCapturedStdout();
        return status;
    }
};

class SettingsFile : public testing::Test {
  protected:
    test::TempDir folder;
    std::string file(const std::string& content) { return folder.write("asip.conf", content); }
};

TEST(Settings, NothingGiven_DefaultsHold) {
    Program program;
    EXPECT_EQ(program.parse({}), std::nullopt);
    EXPECT_THAT(program.broker.brokers, ElementsAre("127.0.0.1:1883"));
    EXPECT_EQ(program.broker.topic_root, "asip");
    EXPECT_EQ(program.serial, "none");
    EXPECT_FALSE(program.broker.insecure);
}

TEST_F(SettingsFile, GivenEverywhere_FlagBeatsEnvironmentBeatsFileBeatsDefault) {
    const auto path = file("serial = file\nmax-count = 2\nuser = file\n");
    Program program;
    const Variables variables{{"ASIP_SERIAL", "environment"}, {"ASIP_MAX_COUNT", "3"}};
    EXPECT_EQ(program.parse({"--config", path, "--serial", "flag"}, variables), std::nullopt)
        << program.errors;
    EXPECT_EQ(program.serial, "flag");
    EXPECT_EQ(program.count, 3);
    EXPECT_EQ(program.broker.user, "file");
    EXPECT_EQ(program.broker.topic_root, "asip");
}

TEST_F(SettingsFile, NamedByTheEnvironment_IsRead) {
    Program program;
    EXPECT_EQ(program.parse({}, {{"ASIP_CONFIG", file("serial=x")}}), std::nullopt);
    EXPECT_EQ(program.serial, "x");
}

TEST_F(SettingsFile, Sections_OnlyOursCounts) {
    Program program;
    const auto path = file(
        "# a comment\n  user = \"Ada L\"  \r\n\n[asip-other]\nunheard = of\nserial = "
        "other\n[asip-test]\nserial = ours\n");
    EXPECT_EQ(program.parse({"--config=" + path}), std::nullopt) << program.errors;
    EXPECT_EQ(program.serial, "ours");
    EXPECT_EQ(program.broker.user, "Ada L");
}

TEST_F(SettingsFile, UnknownName_IsAnErrorWithLineAndSuggestion) {
    Program program;
    EXPECT_EQ(program.parse({"--config", file("user = a\nserail = b\n")}), kExitUsage);
    EXPECT_THAT(program.errors, HasSubstr(":2"));
    EXPECT_THAT(program.errors, HasSubstr("did you mean \"serial\"?"));
}

TEST_F(SettingsFile, BadLineOrValueOrMissingFile_IsAnErrorThatNamesIt) {
    for (const char* content : {"serial\n", "[asip-test\n", "max-count = many\n", "max-count = 101\n"}) {
        Program program;
        EXPECT_EQ(program.parse({"--config", file(content)}), kExitUsage) << content;
        EXPECT_THAT(program.errors, HasSubstr("asip.conf:1"));
    }
    Program program;
    EXPECT_EQ(program.parse({"--config", "/no/such/file"}), kExitUsage);
    EXPECT_THAT(program.errors, HasSubstr("/no/such/file"));
    EXPECT_EQ(program.parse({"--config", "/tmp"}), kExitUsage) << "a folder";
    EXPECT_EQ(program.parse({"--config", "/dev/zero"}), kExitUsage) << "without an end";
}

TEST_F(SettingsFile, SeveralBrokers_AsListOrAsLines) {
    for (const char* content : {"broker = a,b:1884\n", "broker = a\nbroker = b:1884\n"}) {
        Program program;
        EXPECT_EQ(program.parse({"--config", file(content)}), std::nullopt) << program.errors;
        EXPECT_THAT(program.broker.brokers, ElementsAre("a", "b:1884")) << content;
    }
}

TEST(Settings, BrokersOnTheCommandLine_ReplaceThoseOfTheEnvironment) {
    Program program;
    EXPECT_EQ(program.parse({"--broker", "x", "--broker", "y,z"}, {{"ASIP_BROKER", "a,b"}}), std::nullopt);
    EXPECT_THAT(program.broker.brokers, ElementsAre("x", "y", "z"));
}

TEST(Settings, FlagInTheEnvironment_IsSet) {
    Program program;
    EXPECT_EQ(program.parse({}, {{"ASIP_INSECURE", "true"}}), std::nullopt) << program.errors;
    EXPECT_TRUE(program.broker.insecure);
    Program off;
    EXPECT_EQ(off.parse({}, {{"ASIP_INSECURE", "false"}}), std::nullopt) << off.errors;
    EXPECT_FALSE(off.broker.insecure);
}

TEST(Settings, BadValueInTheEnvironment_NamesTheVariable) {
    Program program;
    EXPECT_EQ(program.parse({}, {{"ASIP_LOG_LEVEL", "loud"}}), kExitUsage);
    EXPECT_THAT(program.errors, HasSubstr("ASIP_LOG_LEVEL"));
    EXPECT_THAT(program.errors, HasSubstr("warning"));
}

TEST(Settings, Help_ShowsVariablesAndNoSecrets) {
    Program program;
    EXPECT_EQ(program.parse({"--help"}, {{"ASIP_PASSWORD", "s3cret"}}), kExitOk);
    EXPECT_THAT(program.output, HasSubstr("ASIP_BROKER"));
    EXPECT_THAT(program.output, HasSubstr("ASIP_SERIAL"));
    EXPECT_THAT(program.output, testing::Not(HasSubstr("s3cret")));
    EXPECT_EQ(program.broker.password, "s3cret");
}

TEST_F(SettingsFile, ThatIsNoOption_IsSetByFileAndEnvironmentOnly) {
    const auto parse = [](Program& program, const Arguments& arguments, const Variables& variables = {}) {
        program.settings.arrange({"serial"}, {"max-count"});
        return program.parse(arguments, variables);
    };
    for (const Arguments& arguments :
         {Arguments{"--max-count", "7"}, Arguments{"--serial", "x", "--max-count=7"}}) {
        Program refused;
        EXPECT_EQ(parse(refused, arguments), kExitUsage);
        EXPECT_THAT(refused.errors, HasSubstr("--max-count is no option: write max-count = VALUE"));
        EXPECT_THAT(refused.errors, HasSubstr("ASIP_MAX_COUNT"));
    }
    Program of_file, of_environment, positional;
    EXPECT_EQ(parse(of_file, {"--config", file("max-count = 7\n")}), std::nullopt);
    EXPECT_EQ(of_file.count, 7);
    EXPECT_EQ(parse(of_environment, {}, {{"ASIP_MAX_COUNT", "8"}}), std::nullopt);
    EXPECT_EQ(of_environment.count, 8);
    EXPECT_EQ(parse(positional, {"--", "--max-count"}), kExitUsage);
    EXPECT_THAT(positional.errors, testing::Not(HasSubstr("is no option"))) << "it is no option behind --";
}

TEST(Settings, HelpOfManySettings_ShowsThoseThatPeopleSet) {
    Program some;
    some.settings.arrange({"serial", "broker"}, {"max-count"});
    EXPECT_EQ(some.parse({"--help"}), kExitOk);
    EXPECT_THAT(some.output, HasSubstr("--serial"));
    EXPECT_THAT(some.output, HasSubstr("--help-all"));
    EXPECT_THAT(some.output, testing::Not(HasSubstr("--topic-root")));
    EXPECT_THAT(some.output, testing::Not(HasSubstr("max-count")));
    Program all;
    all.settings.arrange({"serial", "broker"}, {"max-count"});
    EXPECT_EQ(all.parse({"--help-all"}), kExitOk);
    EXPECT_THAT(all.output, HasSubstr("--topic-root"));
    EXPECT_THAT(all.output, HasSubstr("\n  max-count"));
    EXPECT_THAT(all.output, testing::Not(HasSubstr("--max-count")));
}

TEST(Settings, Version_IsPrinted) {
    Program program;
    EXPECT_EQ(program.parse({"--version"}), kExitOk);
    EXPECT_EQ(program.output, "asip-test " ASIP_VERSION "\n");
}

TEST(Settings, UnknownOption_IsUsageAndTheNearestIsNamed) {
    Program program;
    EXPECT_EQ(program.parse({"--seriall", "/dev/ttyACM0"}), kExitUsage);
    EXPECT_THAT(program.errors,
                HasSubstr("asip-test: there is no option \"--seriall\" (did you mean \"--serial\"?)"));
    Program other;
    EXPECT_EQ(other.parse({"--bogus"}), kExitUsage);
    EXPECT_THAT(other.errors, HasSubstr("--bogus"));
}

TEST(MqttOptions, BrokerOptions_AreTranslated) {
    BrokerOptions options;
    options.brokers = {"a:1", "mqtts://b"};
    options.user = "ada";
    options.password = "pw";
    options.mqtt_version = "3.1.1";
    const auto made = mqtt_options(options, "asip-test");
    ASSERT_TRUE(made) << made.error();
    EXPECT_THAT(made->brokers,
                ElementsAre(mqtt::BrokerAddress{"a", 1, false}, mqtt::BrokerAddress{"b", 8883, true}));
    EXPECT_EQ(made->version, mqtt::Version::kV311);
    EXPECT_THAT(made->client_id, testing::StartsWith("asip-test-"));
    EXPECT_NE(made->client_id, mqtt_options(options, "asip-test")->client_id);
}

TEST(MqttOptions, PasswordFile_GivesItsFirstLine) {
    test::TempDir folder;
    BrokerOptions options;
    options.user = "ada";
    options.password_file = folder.write("pw", "s3cret\r\nmore\n");
    EXPECT_EQ(mqtt_options(options, "p")->password, "s3cret");
    options.password_file = folder.file("missing");
    EXPECT_FALSE(mqtt_options(options, "p"));
}

TEST(MqttOptions, CertificatesGiven_MeanTls) {
    test::TempDir folder;
    BrokerOptions options;
    options.ca = folder.write("ca", "x");
    EXPECT_TRUE(mqtt_options(options, "p")->brokers.at(0).tls);
    options.ca = folder.file("missing");
    EXPECT_FALSE(mqtt_options(options, "p"));
    options.ca.clear();
    options.cert = folder.write("cert", "x");
    EXPECT_FALSE(mqtt_options(options, "p")) << "a certificate without its key";
}

TEST(MqttOptions, BadBrokerOrRootOrLonelyPassword_IsRefused) {
    BrokerOptions options;
    options.brokers = {"http://x"};
    EXPECT_FALSE(mqtt_options(options, "p"));
    options = {};
    options.topic_root = "a/#";
    EXPECT_FALSE(mqtt_options(options, "p"));
    options = {};
    options.password = "x";
    EXPECT_FALSE(mqtt_options(options, "p"));
}

constexpr const char* kCredentials =
    "# of uno1\nrole = board\nbroker = mqtts://pi:8883, mqtts://192.168.1.10:8883\nuser = uno1\n"
    "password = secret=x\ntopic-root = house\nname = uno1\n"
    "-----BEGIN CERTIFICATE-----\nuser = nobody\n-----END CERTIFICATE-----\n";

TEST_F(SettingsFile, Credentials_GiveBrokerUserPasswordAuthorityAndRoot) {
    Program program;
    const auto path = folder.write("uno1.credentials", kCredentials);
    EXPECT_EQ(program.parse({"--credentials", path}), std::nullopt) << program.errors;
    EXPECT_THAT(program.broker.brokers, ElementsAre("mqtts://pi:8883", "mqtts://192.168.1.10:8883"));
    EXPECT_EQ(program.broker.user, "uno1");
    EXPECT_EQ(program.broker.password, "secret=x");
    EXPECT_EQ(program.broker.ca, path);
    EXPECT_EQ(program.broker.topic_root, "house");
}

TEST_F(SettingsFile, Credentials_ReplaceEnvironmentAndFileAndTheCommandLineReplacesThem) {
    Program program;
    const auto path = folder.write("uno1.credentials", kCredentials);
    const auto config = file("user = other\npassword-file = /other\ncredentials = " + path + "\n");
    EXPECT_EQ(program.parse({"--config", config, "--broker", "mqtts://elsewhere"},
                            {{"ASIP_PASSWORD", "wrong"}, {"ASIP_CA", "/wrong"}}),
              std::nullopt)
        << program.errors;
    EXPECT_THAT(program.broker.brokers, ElementsAre("mqtts://elsewhere"));
    EXPECT_EQ(program.broker.user, "uno1");
    EXPECT_EQ(program.broker.password, "secret=x");
    EXPECT_EQ(program.broker.password_file, "");
    EXPECT_EQ(program.broker.ca, path);
}

TEST_F(SettingsFile, CredentialsThatAreDamaged_AreRefusedWithTheirPlace) {
    const auto refused = [this](const std::string& text) {
        Program program;
        const auto path = folder.write("damaged", text);
        EXPECT_EQ(program.parse({"--credentials=" + path}), kExitUsage) << text;
        EXPECT_EQ(program.broker.user, "") << "nothing is half taken";
        return program.errors;
    };
    const std::string whole = kCredentials;
    EXPECT_THAT(refused(whole.substr(0, whole.size() - 30)), HasSubstr("copied whole"));
    EXPECT_THAT(refused("broker = a\nuser = b\n"), HasSubstr("password = ... is missing"));
    EXPECT_THAT(refused("broker = a\npassword = b\n"), HasSubstr("user = ... is missing"));
    EXPECT_THAT(refused("user = a\npassword = b\n"), HasSubstr("broker = ... is missing"));
    EXPECT_THAT(refused("usr = b\n"),
                HasSubstr("damaged:1: credentials have no \"usr\" (did you mean \"user\"?)"));
    EXPECT_THAT(refused("user\n"), HasSubstr("damaged:1: expected NAME = VALUE"));
    Program program;
    EXPECT_EQ(program.parse({"--credentials", folder.file("nothing")}), kExitUsage);
    EXPECT_THAT(program.errors, HasSubstr("cannot read the credentials"));
}

/// As asip-registry: takes registry.credentials of a folder.
struct Service {
    CLI::App app{"A service"};
    Settings settings{app, "asip-registry"};
    BrokerOptions broker;
    Service() {
        settings.add_broker_options(broker);
        settings.add_credentials_dir(broker);
    }
};

class CredentialsDir : public testing::Test {
  protected:
    CredentialsDir() {
        folder.write("registry.credentials",
                     "broker = mqtts://hall:8883\nuser = registry\npassword = secret\n");
    }
    /// The user that the service is, with these options and variables.
    std::string user(const Arguments& arguments, Variables variables = {}) {
        Service service;
        variables.emplace("ASIP_CREDENTIALS_DIR", folder.path().string());
        testing::internal::CaptureStderr();
        const auto status = service.settings.parse(arguments, [&](const std::string& name) {
            const auto found = variables.find(name);
            return found == variables.end() ? std::nullopt : std::optional(found->second);
        });
        testing::internal::GetCapturedStderr();
        return status ? "none" : service.broker.user;
    }
    test::TempDir folder;
};

TEST_F(CredentialsDir, NothingElseGiven_OwnFileIsTaken) {
    EXPECT_EQ(user({}), "registry");
    EXPECT_EQ(user({"--broker", "127.0.0.1:1883"}), "")
        << "a broker was given, even if it is the default one";
}

TEST_F(CredentialsDir, BrokerUserOrCertificateGiven_GoBefore) {
    EXPECT_EQ(user({"--broker", "other.example"}), "");
    EXPECT_EQ(user({}, {{"ASIP_BROKER", "other.example"}}), "");
    EXPECT_EQ(user({}, {{"ASIP_USER", "ann"}}), "ann");
    EXPECT_EQ(user({"--user", "ann"}), "ann");
    EXPECT_EQ(user({}, {{"ASIP_CERT", "/x.crt"}}), "");
    const auto own = folder.write("own", "broker = mqtts://hall:8883\nuser = own\npassword = secret\n");
    EXPECT_EQ(user({"--credentials", own}), "own");
}

TEST_F(CredentialsDir, NoFileThere_NothingIsTaken) {
    EXPECT_EQ(user({"--credentials-dir", folder.file("absent")}), "");
    EXPECT_EQ(credentials_in_dir({}, "registry"), "");
}

TEST_F(CredentialsDir, DamagedFile_IsAnErrorAndNotPassedOver) {
    folder.write("registry.credentials", "nonsense");
    EXPECT_EQ(user({}), "none");
}

}  // namespace
}  // namespace asip::program
