// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/mqtt/slow_lookups.hpp"

#include <arpa/inet.h>
#include <dlfcn.h>
#include <netdb.h>

#include <atomic>
#include <thread>

namespace {

std::atomic<std::chrono::milliseconds> delay_of_names{std::chrono::milliseconds(0)};

bool is_address(const char* host) {
    in6_addr scratch{};
    return host == nullptr || inet_pton(AF_INET, host, &scratch) == 1 ||
           inet_pton(AF_INET6, host, &scratch) == 1;
}

}  // namespace

extern "C" int getaddrinfo(const char* host, const char* service, const addrinfo* hints, addrinfo** found) {
    using Function = int(const char*, const char*, const addrinfo*, addrinfo**);
    static auto* const original = reinterpret_cast<Function*>(dlsym(RTLD_NEXT, "getaddrinfo"));
    if (!is_address(host)) std::this_thread::sleep_for(delay_of_names.load());
    return original(host, service, hints, found);
}

namespace asip::test {

SlowLookups::SlowLookups(std::chrono::milliseconds delay) {
    delay_of_names = delay;
}
SlowLookups::~SlowLookups() {
    delay_of_names = std::chrono::milliseconds(0);
}

}  // namespace asip::test
