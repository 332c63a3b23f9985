// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tests/cluster/board.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/temp_dir.hpp"

namespace cluster {

/// The real firmware in a simulated Uno with a strip of pixels at its pin, on a serial port. A token is the
/// color of a pixel, which the strip reads from the waveform: the same color twice, with no other in between,
/// is seen once.
class FirmwareBoard : public Board {
  public:
    /// Throws std::runtime_error when the simulator does not start.
    FirmwareBoard(boost::asio::io_context& io, const std::string& name, OnExecuted on_executed);
    ~FirmwareBoard() override;

    std::vector<std::string> link() const override;
    /// A line of the board's pixel service.
    std::string request(std::size_t token) const override;
    void cut() override;
    void plug() override;

  private:
    void observe(std::string_view line);

    boost::asio::io_context& io_;
    OnExecuted on_executed_;
    asip::test::TempDir folder_;
    std::vector<std::uint32_t> colors_;  // as the strip last showed them; of the simulator's thread
    std::unique_ptr<asip::test::ChildProcess> simulator_;
};

}  // namespace cluster
