// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "asip/link/boot_loader.hpp"

namespace asip::agent {

/// The version of the image of `sketch` for `chip` in `folder`; 0: there is none. The file `versions` there
/// has it, in lines such as "AsipServices 2".
int loadable_version(const std::filesystem::path& folder, const std::string& sketch, const std::string& chip);

/// Loads firmware into a board by avrdude, beside the agent: one boot loader after the other until one
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
    struct Handlers {
        std::function<void(std::string_view step, int percent)> on_progress;
        std::function<void(const Expected<void>&)> on_done;
    };

    /// Its end ends avrdude, and no handler is called any more.
    Loader(boost::asio::io_context& io, Order order, Handlers handlers);
    ~Loader();
    Loader(const Loader&) = delete;
    Loader& operator=(const Loader&) = delete;

  private:
    class Impl;
    std::shared_ptr<Impl> impl_;
};

}  // namespace asip::agent
