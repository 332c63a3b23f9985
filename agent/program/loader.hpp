// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "asip/link/boot_loader.hpp"

namespace asip::agent {

/// Loads firmware into a board, by avrdude, which runs beside the agent: each boot loader in turn until one
/// answers.
class Loader {
  public:
    struct Order {
        std::string port;
        std::string avrdude;  ///< looked up in PATH
        std::string folder;   ///< of the images: FIRMWARE-uno.hex, FIRMWARE-mega.hex
        std::string firmware;
        std::vector<link::BootLoader> loaders;
    };
    /// Called on the event loop.
    struct Handlers {
        std::function<void(std::string_view step, int percent)> on_progress;
        std::function<void(const Expected<void>&)> on_done;
    };

    /// `io` must outlive it. Where it is destroyed before its end, avrdude is ended, and no handler is called
    /// any more.
    Loader(boost::asio::io_context& io, Order order, Handlers handlers);
    ~Loader();
    Loader(const Loader&) = delete;
    Loader& operator=(const Loader&) = delete;

  private:
    class Impl;
    std::shared_ptr<Impl> impl_;
};

}  // namespace asip::agent
