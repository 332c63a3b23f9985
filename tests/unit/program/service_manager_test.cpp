// SPDX-License-Identifier: Apache-2.0
#include "asip/program/service_manager.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>

#include "tests/support/temp_dir.hpp"

namespace asip::program {
namespace {

class ServiceManager : public testing::Test {
  protected:
    ~ServiceManager() override {
        if (socket_ >= 0) close(socket_);
        unsetenv("NOTIFY_SOCKET");
    }
    /// `path` begins with 0 for a name that is no file.
    void listen(const std::string& path) {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        std::memcpy(address.sun_path, path.data(), path.size());
        socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0);
        const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size());
        ASSERT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), length), 0);
    }
    std::string heard() const {
        char text[256];
        const auto size = recv(socket_, text, sizeof text, 0);
        return size < 0 ? "" : std::string(text, static_cast<std::size_t>(size));
    }

    test::TempDir folder;

  private:
    int socket_ = -1;
};

TEST_F(ServiceManager, SocketOfAFile_IsTold) {
    const std::string path = folder.file("notify");
    listen(path);
    setenv("NOTIFY_SOCKET", path.c_str(), 1);
    EXPECT_TRUE(has_service_manager());
    tell_service_manager("READY=1\nSTATUS=2 boards");
    EXPECT_EQ(heard(), "READY=1\nSTATUS=2 boards");
}

TEST_F(ServiceManager, SocketWithoutAFile_IsTold) {
    const std::string name = folder.file("name");
    listen(std::string(1, '\0') + name);
    setenv("NOTIFY_SOCKET", ("@" + name).c_str(), 1);
    tell_service_manager("READY=1");
    EXPECT_EQ(heard(), "READY=1");
}

TEST_F(ServiceManager, NoneOrAWrongOne_IsNotWaitedFor) {
    EXPECT_FALSE(has_service_manager());
    tell_service_manager("READY=1");
    for (const std::string& path :
         {std::string("relative"), std::string("/no/such/socket"), '/' + std::string(300, 'x')}) {
        setenv("NOTIFY_SOCKET", path.c_str(), 1);
        EXPECT_EQ(has_service_manager(), path[0] == '/');
        tell_service_manager("READY=1");
    }
}

}  // namespace
}  // namespace asip::program
