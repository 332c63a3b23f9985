// SPDX-License-Identifier: Apache-2.0
// A broker that is found: in a network of its own, with the responder Avahi and a real Mosquitto. What runs
// there ends with the first process of its namespace.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/child_process.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Makes the network 10.9.8.0/24 of one machine, on which multicast works, and brings up a broker there.
/// `announce NAME PORT` has Avahi announce one.
constexpr const char* kNetwork = R"(
set -e
ip link set lo up multicast on
ip address add 10.9.8.1/24 dev lo
ip route add 224.0.0.0/4 dev lo
mount -t tmpfs none /etc/avahi/services
mount -t tmpfs none /run
cat >$dir/avahi.conf <<END
[server]
host-name=pi
use-ipv6=no
enable-dbus=no
[publish]
publish-workstation=no
END
wait_for() {
    for _ in $(seq 200); do
        grep -q "$1" "$2" && return
        sleep 0.05
    done
    cat "$2" >&2
    exit 1
}
announce() {
    cat >"/etc/avahi/services/$2.service" <<END
<?xml version="1.0"?><!DOCTYPE service-group SYSTEM "avahi-service.dtd">
<service-group><name>$1</name><service><type>_mqtt._tcp</type><port>$2</port></service></service-group>
END
}
broker() {
    printf 'listener %s %s\nallow_anonymous true\n' "$2" "$1" >"$dir/$2.conf"
    mosquitto -c "$dir/$2.conf" >"$dir/$2.log" 2>&1 &
    wait_for ' running$' "$dir/$2.log"
}
responder() {
    avahi-daemon -f "$dir/avahi.conf" --no-drop-root --no-chroot --no-rlimits --no-proc-title >"$dir/avahi.log" 2>&1 &
    wait_for 'successfully established' "$dir/avahi.log"
}
)";

class BrokerSearchTest : public ::testing::Test {
  protected:
    static Finished in_a_network(const std::string& script) {
        const TempDir folder;
        const auto asipctl = program_to_start(ASIP_PROGRAMS "/asipctl");
        return run({"unshare", "--net", "--mount", "--pid", "--fork", "--mount-proc", "--kill-child", "bash",
                    "-c", "dir=" + folder.path().string() + "; asipctl=" + asipctl + kNetwork + script});
    }
    void SetUp() override {
        const auto possible = in_a_network("exit 0");
        if (possible.status != 0)
            GTEST_SKIP()
                << "no network of our own can be made here (root may), so finding a broker is not tested: "
                << possible.errors;
    }
};

TEST_F(BrokerSearchTest, TheOneThatIsAnnounced_IsUsed_AndNamed) {
    const auto result = in_a_network(R"(
announce 'Broker of the lab' 1899
broker 10.9.8.1 1899
responder
$asipctl list --from-bus -o json
retain() { mosquitto_pub -h 10.9.8.1 -p 1899 -r -t "asip/servicebus/desk/$1" -m "$2"; }
retain '$description' '{"board":"desk","session":"1","seq":1,"lease":60,"firmware":{"protocol":"0.4"},"services":[]}'
retain '$state' online
$asipctl list --from-bus -o name
)");
    EXPECT_EQ(result.status, 0) << result.errors;
    EXPECT_THAT(result.output, HasSubstr("[]"));
    EXPECT_THAT(result.output, HasSubstr("desk\n"));
    EXPECT_THAT(result.errors,
                HasSubstr("using mqtt://10.9.8.1:1899 (Broker of the lab), which is announced"));
}

TEST_F(BrokerSearchTest, WhoSaysWhere_OrHasCredentials_OrWantsNone_SearchesNothing) {
    const auto result = in_a_network(R"(
announce 'Broker of the lab' 1899
broker 10.9.8.1 1899
responder
! $asipctl list --no-mdns
! ASIP_NO_MDNS=true $asipctl list
! $asipctl list --broker 127.0.0.1:1883
! ASIP_BROKER=127.0.0.1 $asipctl list
! ASIP_PASSWORD=secret $asipctl list --user ann
$asipctl model -o name >/dev/null
broker 127.0.0.1 1883
$asipctl list --from-bus -o name
)");
    EXPECT_EQ(result.status, 0) << result.errors;
    EXPECT_THAT(result.errors, Not(HasSubstr("announced")));
    EXPECT_THAT(result.errors, HasSubstr("127.0.0.1:1883"));
}

TEST_F(BrokerSearchTest, OfSeveral_NoneIsGuessed_AndWithoutOneItEndsInTime) {
    const auto result = in_a_network(R"(
time=$(date +%s%N)
$asipctl list || echo "status $?"
echo $((($(date +%s%N) - time) / 1000000)) ms
announce 'One' 1899
announce 'Two' 1900
responder
$asipctl list || echo "status $?"
)");
    EXPECT_EQ(result.status, 0) << result.errors;
    EXPECT_THAT(result.output, HasSubstr("status 3\n"));
    EXPECT_THAT(result.errors, HasSubstr("none is announced on this network"));
    EXPECT_THAT(result.errors,
                HasSubstr("several brokers are announced on this network: mqtt://10.9.8.1:1899 (One), "
                          "mqtt://10.9.8.1:1900 (Two); choose one: --broker"));
    const auto took = std::stoi(result.output.substr(result.output.find('\n') + 1));
    EXPECT_GE(took, 1000);
    EXPECT_LE(took, time_limit(3s).count());
}

}  // namespace
}  // namespace asip::test
