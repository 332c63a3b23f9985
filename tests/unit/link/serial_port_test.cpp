// SPDX-License-Identifier: Apache-2.0
// Serial ports against pseudo-terminals: all of it but the modem lines and the speeds' effect.
#include "asip/link/serial_port.hpp"
#include "asip/link/usb_port.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/support/loop.hpp"
#include "tests/support/temp_dir.hpp"
#include "tests/unit/link/pty.hpp"

namespace asip::link {
namespace {

using Kind = StreamError::Kind;
using test::run_until;

struct Heard {
    std::string bytes;
    std::optional<StreamError> closed;
    ByteStream::Handlers handlers() {
        return {[this](std::string_view more) { bytes += more; },
                [this](const StreamError& e) { closed = e; }};
    }
};

class SerialPortTest : public testing::Test {
  protected:
    boost::asio::io_context io;
    Pty board;
    Heard heard;
};

TEST_F(SerialPortTest, Opened_CarriesAllBytesUnchangedBothWays) {
    auto port = open_serial(io, board.device());
    ASSERT_TRUE(port) << port.error().text;
    (*port)->start(heard.handlers());
    const std::string all = std::string("\x03\x04\r\n\x11\x13\x7f\xff\0", 9) + "@I,d,2,FF\n";
    board.send(all);
    EXPECT_TRUE(run_until(io, [&] { return heard.bytes == all; }));
    (*port)->write(all);
    std::string at_board;
    EXPECT_TRUE(run_until(io, [&] { return (at_board += board.read_some()) == all; }));
    EXPECT_EQ((*port)->describe(), board.device());
}

TEST_F(SerialPortTest, MoreThanTheKernelTakes_IsSentInOrderWithoutBlocking) {
    auto port = open_serial(io, board.device());
    ASSERT_TRUE(port);
    (*port)->start(heard.handlers());
    std::string sent;
    for (int i = 0; i < 20000; ++i)
        sent += std::to_string(i) + "\n";
    (*port)->write(sent.substr(0, 50000));
    EXPECT_GT((*port)->unsent_bytes(), 0u);
    (*port)->write(sent.substr(50000));
    std::string at_board;
    EXPECT_TRUE(run_until(io, [&] { return (at_board += board.read_some()).size() >= sent.size(); }));
    EXPECT_EQ(at_board, sent);
    EXPECT_TRUE(run_until(io, [&] { return (*port)->unsent_bytes() == 0; }));
}

TEST_F(SerialPortTest, Speeds_AreSetByNameWhereThereIsOne) {
    auto port = open_serial(io, board.device());
    ASSERT_TRUE(port);
    EXPECT_EQ((*port)->baud(), 57600);
    EXPECT_EQ(board.speed(), static_cast<speed_t>(B57600));
    EXPECT_TRUE((*port)->set_baud(500000));
    EXPECT_EQ(board.speed(), static_cast<speed_t>(B500000));
    EXPECT_TRUE((*port)->set_baud(1000000));
    EXPECT_EQ(board.speed(), static_cast<speed_t>(B1000000));
    EXPECT_TRUE((*port)->set_baud(250000));
    EXPECT_EQ((*port)->baud(), 250000);
    EXPECT_FALSE((*port)->set_baud(0));
    EXPECT_EQ((*port)->baud(), 250000);
}

TEST_F(SerialPortTest, Opened_DoesNotHangUpOnClose) {
    auto port = open_serial(io, board.device());
    ASSERT_TRUE(port);
    EXPECT_EQ(board.control_flags() & HUPCL, 0u);
    EXPECT_FALSE((*port)->set_dtr(true)) << "a pseudo-terminal has no such line";
}

TEST_F(SerialPortTest, OpenedTwice_TheSecondIsBusyUntilTheFirstCloses) {
    auto first = open_serial(io, board.device());
    ASSERT_TRUE(first);
    auto second = open_serial(io, board.device());
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().kind, Kind::kBusy);
    (*first)->close();
    EXPECT_TRUE(open_serial(io, board.device()));
}

TEST_F(SerialPortTest, Unplugged_IsReportedOnce) {
    auto port = open_serial(io, board.device());
    ASSERT_TRUE(port);
    (*port)->start(heard.handlers());
    board.unplug();
    ASSERT_TRUE(run_until(io, [&] { return heard.closed.has_value(); }));
    EXPECT_EQ(heard.closed->kind, Kind::kClosed);
}

TEST_F(SerialPortTest, DestroyedInItsOwnHandler_IsQuiet) {
    auto port = open_serial(io, board.device());
    ASSERT_TRUE(port);
    auto stream = std::move(*port);
    int calls = 0;
    stream->start({[&](std::string_view) {
                       ++calls;
                       stream.reset();
                   },
                   [&](const StreamError&) { ++calls; }});
    board.send("x");
    ASSERT_TRUE(run_until(io, [&] { return calls == 1; }));
    io.restart();
    io.run();
    EXPECT_EQ(calls, 1);
}

TEST(SerialPortErrors, NotThereOrNotAPort_IsSaid) {
    boost::asio::io_context io;
    test::TempDir folder;
    EXPECT_EQ(open_serial(io, folder.file("ttyUSB9")).error().kind, Kind::kNotThere);
    EXPECT_EQ(open_serial(io, folder.write("file", "x")).error().kind, Kind::kNotASerialPort);
    EXPECT_EQ(open_serial(io, "/dev/null").error().kind, Kind::kNotASerialPort);
    EXPECT_EQ(open_serial(io, folder.path().string()).error().kind, Kind::kNotASerialPort);
}

TEST(SerialPortErrors, NoPermission_NamesTheGroup) {
    boost::asio::io_context io;
    test::TempDir folder;
    const auto file = folder.write("tty", "");
    ASSERT_EQ(chmod(file.c_str(), 0), 0);
    // Root may open anything; for the moment of opening, be another user.
    const bool root = geteuid() == 0;
    const bool dropped = root && seteuid(65534) == 0;
    const auto port = open_serial(io, file);
    ASSERT_TRUE(!root || (dropped && seteuid(0) == 0));
    ASSERT_FALSE(port);
    EXPECT_EQ(port.error().kind, Kind::kNoPermission);
    EXPECT_NE(port.error().text.find("dialout"), std::string::npos);
}

TEST(StablePath, DeviceWithLinks_IsTheFirstLinkByName) {
    test::TempDir folder;
    const auto device = folder.write("ttyACM0", "");
    const auto other = folder.write("ttyACM1", "");
    const auto by_id = folder.path() / "by-id";
    std::filesystem::create_directory(by_id);
    std::filesystem::create_symlink("../ttyACM0", by_id / "usb-b");
    std::filesystem::create_symlink("../ttyACM0", by_id / "usb-a");
    std::filesystem::create_symlink("../gone", by_id / "usb-0");
    EXPECT_EQ(stable_path(device, folder.path()), by_id / "usb-a");
    EXPECT_EQ(stable_path(by_id / "usb-b", folder.path()), by_id / "usb-a");
    EXPECT_EQ(stable_path(other, folder.path()), other);
    EXPECT_EQ(stable_path(device, folder.file("none")), device);
    EXPECT_EQ(stable_path("/no/such", folder.path()), "/no/such");
}

/// A machine whose USB sockets are shown as the kernel and udev show them.
class UsbMachine {
  public:
    std::string dev() const { return folder_.file("dev/serial"); }
    std::string sys() const { return folder_.file("sys"); }

    /// The device file.
    std::string plug(const std::string& name, const std::string& socket, const std::string& serial,
                     const std::string& by_id) {
        namespace fs = std::filesystem;
        const fs::path usb = folder_.path() / "sys/devices/usb1" / ("1-" + socket);
        const auto interface = usb / ("1-" + socket + ":1.0") / name;
        fs::create_directories(interface);
        write(usb / "idVendor", "1a86\n");
        write(usb / "idProduct", "7523\n");
        if (!serial.empty()) write(usb / "serial", serial + "\n");
        const auto tty = folder_.path() / "sys/class/tty" / name;
        fs::create_directories(tty);
        fs::create_symlink(interface, tty / "device");
        const auto device = folder_.path() / "dev" / name;
        for (const auto* folder : {"by-id", "by-path"})
            fs::create_directories(folder_.path() / "dev/serial" / folder);
        write(device, "");
        fs::remove(folder_.path() / "dev/serial/by-id" / by_id);
        fs::create_symlink(device, folder_.path() / "dev/serial/by-id" / by_id);
        fs::create_symlink(device, path_of(socket));
        return device;
    }
    std::string path_of(const std::string& socket) const {
        return folder_.file("dev/serial/by-path/pci-0000:00:14.0-usb-0:" + socket + ":1.0-port0");
    }

  private:
    static void write(const std::filesystem::path& file, const std::string& text) {
        std::ofstream(file) << text;
    }
    test::TempDir folder_;
};

TEST(StablePath, ClonesWithoutASerialNumber_AreTheirUsbPorts) {
    UsbMachine machine;
    const auto first = machine.plug("ttyUSB0", "3", "", "usb-1a86_USB_Serial-if00-port0");
    const auto second = machine.plug("ttyUSB1", "1.4", "0001", "usb-1a86_USB_Serial-if00-port0");
    for (int twice = 0; twice < 2; ++twice) {
        EXPECT_EQ(stable_path(first, machine.dev(), machine.sys()), machine.path_of("3"));
        EXPECT_EQ(stable_path(second, machine.dev(), machine.sys()), machine.path_of("1.4"));
    }
    EXPECT_EQ(stable_path(machine.path_of("3"), machine.dev(), machine.sys()), machine.path_of("3"));
    EXPECT_EQ(
        stable_path(machine.dev() + "/by-id/usb-1a86_USB_Serial-if00-port0", machine.dev(), machine.sys()),
        machine.path_of("1.4"));
}

TEST(StablePath, BoardWithASerialNumber_IsThatOnWhicheverPort) {
    UsbMachine machine;
    const auto device = machine.plug("ttyACM0", "3", "7583030313135161E0A1", "usb-Uno-if00");
    EXPECT_EQ(stable_path(device, machine.dev(), machine.sys()), machine.dev() + "/by-id/usb-Uno-if00");
    const auto usb = usb_port_of(device, machine.sys());
    EXPECT_EQ(usb.vendor + ":" + usb.product, "1a86:7523");
    EXPECT_EQ(usb.port, "3");
    EXPECT_EQ(usb_port_of("/dev/null").vendor, "");
}

}  // namespace
}  // namespace asip::link
