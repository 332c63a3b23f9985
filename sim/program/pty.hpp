// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <poll.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "asip/descriptor.hpp"
#include "asip/expected.hpp"

namespace asip::sim {

/// In place of a serial port. Not blocking.
class Pty {
  public:
    /// At 57600 baud and raw.
    static Expected<Pty> open();
    Pty() = default;

    bool is_open() const { return master_.valid(); }
    /// The side that other programs open: "/dev/pts/3".
    const std::string& path() const { return path_; }

    struct Events {
        bool opened = false;  ///< since the last look, even if another program had closed it only just before
        bool in_use = false;  ///< a program has it open; until then (and after) nothing should be written: it
                              ///< would be kept for the next one that opens it
        bool readable = false;  ///< that program has written something
    };
    Events look();
    /// `in_use` as look() saw it.
    void add_waits(std::vector<pollfd>& waits, bool with_bytes) const;
    /// 0: unknown.
    std::uint32_t baud() const;
    std::string read(std::size_t max_bytes);
    std::size_t write(std::string_view bytes);

  private:
    Descriptor master_;
    Descriptor watch_;  // inotify, for `opened`; none where the system has none
    bool was_in_use_ = false;
    std::string path_;
};

/// A link to a port while the object lives. Replaces only a leftover: a link to the same port, to a gone
/// pseudo-terminal, or to one that was opened after the link was made.
class PortLink {
  public:
    static Expected<PortLink> create(const std::filesystem::path& link, const std::string& target);
    PortLink() = default;
    ~PortLink();
    PortLink(PortLink&& other) noexcept;
    PortLink& operator=(PortLink&& other) noexcept;

  private:
    std::filesystem::path link_;
    std::string target_;
};

}  // namespace asip::sim
